"""The dashboard's JavaScript: modules that import each other, served at addresses that mirror the folders.

Panel takes the module of a component as text, and a text cannot import its neighbours. So that text is one line that
fetches the real module. Panel's handler for resources of components serves it, under `granchain serve` and under
`panel serve` alike; it serves the files listed here and no others.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

_HERE = Path(__file__).resolve().parent
#: Every module by its name; names are unique.
FILES = {path.name: path for path in sorted(_HERE.rglob("*.js"))}
#: Those that are written into the page itself: they listen before any module is there.
IN_PAGE = ("page.js", "connection.js")


class Scripts:
    """What Panel's handler looks up to see which files may be served."""

    __javascript_modules__ = tuple(FILES.values())


#: The same class under a name that changes with any file, so that a browser never mixes new modules with cached ones.
_NAME = "Scripts_" + hashlib.sha256(b"".join(path.read_bytes() for path in FILES.values())).hexdigest()[:12]
globals()[_NAME] = Scripts


def address(name: str) -> str:
    """Where a module is served, relative to the page."""
    return f"components/{__name__}/{_NAME}/__javascript_modules__/{FILES[name].relative_to(_HERE).as_posix()}"


_BY_ADDRESS = {address(name): path for name, path in FILES.items()}


def modules() -> list[str]:
    """The addresses of all that are fetched, for the page to name: else a browser learns of each from an import."""
    return [address(name) for name in FILES if name not in IN_PAGE]


def file_at(path: str) -> Path | None:
    """The file of an address after "components/", None where it is no module of ours.

    Panel's handler finds the same file by going through all of them: 5 ms for each.
    """
    return _BY_ADDRESS.get(f"components/{path}")


def module(name: str) -> str:
    """For a component's `_esm`: the `render` of the module of this name."""
    return (f'const {{ render }} = await import(new URL("{address(name)}", document.baseURI).href);\n'
            "export { render };\n")
