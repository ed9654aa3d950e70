"""Compressed scripts and styles, each compressed once: a page needs 1 MB instead of 3.4 MB.

In a lecture hall, a hundred laptops fetch these files over one wireless network. Tornado would compress every file
again for each of them.
"""

from __future__ import annotations

import functools
import gzip
import re
from pathlib import Path
from typing import Any

from tornado.web import StaticFileHandler

from ...scripts import FILES, file_at

#: File types that compression makes smaller; pictures and fonts are already compressed.
_COMPRESSED_SUFFIXES = frozenset({".js", ".mjs", ".css", ".svg", ".json", ".map", ".html", ".txt"})
#: The modules of the page.
_MODULES = frozenset(map(str, FILES.values()))
#: Time for which a browser keeps a file that never changes [s].
_UNCHANGED_TIME = 365 * 86400
#: Smallest file that is compressed: the size of one packet [bytes].
_SMALLEST_COMPRESSED = 1400


@functools.lru_cache(maxsize=512)
def compressed(path: str, modified: int, size: int) -> bytes | None:
    """Return the compressed file; None if that saves nothing. `modified` and `size` identify the file's version."""
    if size < _SMALLEST_COMPRESSED or Path(path).suffix not in _COMPRESSED_SUFFIXES:
        return None
    content = Path(path).read_bytes()
    packed = gzip.compress(content, compresslevel=6, mtime=0)
    return packed if len(packed) < len(content) else None


def accepts_gzip(wanted: str) -> bool:
    """Return whether the header `Accept-Encoding` names gzip with a weight other than 0 (RFC 9110, section 12.5.3).

    `*` alone does not count as gzip: a client that names no coding gets the file uncompressed.
    """
    for entry in wanted.lower().split(","):
        coding, _, weight = entry.replace(" ", "").partition(";")
        if coding == "gzip":
            return re.fullmatch(r"q=0(\.0*)?", weight) is None
    return False


class CompressedFiles(StaticFileHandler):
    """A mixin for file handlers: a browser that accepts gzip and requests a whole file gets it compressed."""

    def parse_url_path(self, url_path: str) -> str:
        """Return the file at an address: one of our modules, or the file that the handler finds.

        Addresses are not cached, because strangers may request any number of them.
        """
        ours = file_at(url_path)
        return super().parse_url_path(url_path) if ours is None else str(ours)

    def _packed(self) -> bytes | None:
        wanted = self.request.headers.get("Accept-Encoding", "")
        if not accepts_gzip(wanted) or "Range" in self.request.headers or self.absolute_path is None:
            return None
        status = Path(self.absolute_path).stat()
        return compressed(self.absolute_path, status.st_mtime_ns, status.st_size)

    async def get(self, path: str, include_body: bool = True) -> None:
        """Replace the content of this answer only; Tornado computes the file's version with the class's own method."""
        self.get_content = self._content  # type: ignore[method-assign, assignment]
        await super().get(path, include_body)

    def _content(self, path: str, start: int | None = None, end: int | None = None) -> Any:
        packed = self._packed()
        return type(self).get_content(path, start, end) if packed is None else packed

    def get_content_size(self) -> int:
        """Return the number of bytes of the answer."""
        packed = self._packed()
        return super().get_content_size() if packed is None else len(packed)

    def set_extra_headers(self, path: str) -> None:
        """Set headers: the encoding, its dependence on the request, and that our modules never change.

        A browser may keep the modules, because the addresses of all modules change if one of them changes.
        """
        super().set_extra_headers(path)
        if path in _MODULES:
            self.set_header("Cache-Control", f"max-age={_UNCHANGED_TIME}, immutable")
        self.set_header("Vary", "Accept-Encoding")
        if self._packed() is not None:
            self.set_header("Content-Encoding", "gzip")

    def compute_etag(self) -> str | None:
        """Return the tag of the answer; a compressed file has different bytes and so needs a different tag."""
        tag = super().compute_etag()
        return tag if tag is None or self._packed() is None else f'{tag[:-1]}-gzip"'
