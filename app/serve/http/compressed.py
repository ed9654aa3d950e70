"""Compressed scripts and styles, each compressed once: 1 MB for a page instead of 3.4 MB.

In a lecture hall a hundred laptops fetch them over one wireless network. Tornado would compress them anew for each.
"""

from __future__ import annotations

import functools
import gzip
import re
from pathlib import Path
from typing import Any

from tornado.web import StaticFileHandler

from ...scripts import FILES, file_at

#: Kinds of files that are smaller when compressed; pictures and fonts are not.
_COMPRESSED_SUFFIXES = frozenset({".js", ".mjs", ".css", ".svg", ".json", ".map", ".html", ".txt"})
#: The modules of the page.
_MODULES = frozenset(map(str, FILES.values()))
#: For how long a browser keeps what does not change [s].
_UNCHANGED_TIME = 365 * 86400
#: Smallest file that is compressed: the size of one packet [bytes].
_SMALLEST_COMPRESSED = 1400


@functools.lru_cache(maxsize=512)
def compressed(path: str, modified: int, size: int) -> bytes | None:
    """The compressed file, None if that saves nothing; `modified` and `size` tell a changed file from the old one."""
    if size < _SMALLEST_COMPRESSED or Path(path).suffix not in _COMPRESSED_SUFFIXES:
        return None
    whole = Path(path).read_bytes()
    packed = gzip.compress(whole, compresslevel=6, mtime=0)
    return packed if len(packed) < len(whole) else None


def accepts_gzip(wanted: str) -> bool:
    """Whether the header `Accept-Encoding` names gzip with another weight than 0 (RFC 9110, section 12.5.3).

    `*` alone is not taken for gzip: a client that names nothing gets the file as it is.
    """
    for one in wanted.lower().split(","):
        coding, _, weight = one.replace(" ", "").partition(";")
        if coding == "gzip":
            return re.fullmatch(r"q=0(\.0*)?", weight) is None
    return False


class CompressedFiles(StaticFileHandler):
    """Mixed into a handler of files: compresses a file for a browser that accepts that and asks for all of it."""

    def parse_url_path(self, url_path: str) -> str:
        """The file of an address: one of our modules, or what the handler itself finds.

        Nothing is remembered here: strangers may ask for any number of addresses.
        """
        ours = file_at(url_path)
        return super().parse_url_path(url_path) if ours is None else str(ours)

    def _packed(self) -> bytes | None:
        wanted = self.request.headers.get("Accept-Encoding", "")
        if not accepts_gzip(wanted) or "Range" in self.request.headers or self.absolute_path is None:
            return None
        found = Path(self.absolute_path).stat()
        return compressed(self.absolute_path, found.st_mtime_ns, found.st_size)

    async def get(self, path: str, include_body: bool = True) -> None:
        """Replace the content for this answer alone; Tornado takes the file's version from the class's own method."""
        self.get_content = self._content  # type: ignore[method-assign, assignment]
        await super().get(path, include_body)

    def _content(self, path: str, start: int | None = None, end: int | None = None) -> Any:
        packed = self._packed()
        return type(self).get_content(path, start, end) if packed is None else packed

    def get_content_size(self) -> int:
        """Number of bytes that are sent."""
        packed = self._packed()
        return super().get_content_size() if packed is None else len(packed)

    def set_extra_headers(self, path: str) -> None:
        """State the encoding, that it depends on the request, and that our modules never change.

        If any module changes, the addresses of all change, so a page that is opened again requests none of them.
        """
        super().set_extra_headers(path)
        if path in _MODULES:
            self.set_header("Cache-Control", f"max-age={_UNCHANGED_TIME}, immutable")
        self.set_header("Vary", "Accept-Encoding")
        if self._packed() is not None:
            self.set_header("Content-Encoding", "gzip")

    def compute_etag(self) -> str | None:
        """The compressed file has a tag of its own, because its bytes differ."""
        tag = super().compute_etag()
        return tag if tag is None or self._packed() is None else f'{tag[:-1]}-gzip"'
