"""The dashboard's JavaScript: modules that import each other, served at addresses that mirror the folders.

Panel takes the module of a component as text, and a text cannot import its neighbours. So that text is one line that
fetches the real module. Panel's handler for resources of components serves it, under `granchain serve` and under
`panel serve` alike; it serves the files listed here and no others.

Python asks for a module by its name alone, which two files may not have. The modules are listed and hashed when this
module is imported: after an edit of a script the server has to be started again.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

_HERE = Path(__file__).resolve().parent


def files_by_name(pattern: str, folder: Path = _HERE) -> dict[str, Path]:
    """The files below a folder that match, by name. Raises `ValueError` for two of one name."""
    paths: dict[str, Path] = {}
    for path in sorted(folder.rglob(pattern)):
        if path.name in paths:
            raise ValueError(f"{path} and {paths[path.name]} have one name; modules and styles are found by name.")
        paths[path.name] = path
    return paths


#: Every module by its name.
FILES = files_by_name("*.js")
#: Those that are written into the page itself, in this order: they listen before any module is there.
INLINE_SCRIPTS = ("shared.js", "address.js", "connection.js")


class Scripts:
    """Lists the files that Panel's handler may serve."""

    __javascript_modules__ = tuple(FILES.values())


#: The same class under a name that changes with any file, so that a browser never mixes new modules with cached ones.
_NAME = "Scripts_" + hashlib.sha256(b"".join(path.read_bytes() for path in FILES.values())).hexdigest()[:12]
globals()[_NAME] = Scripts


def address(name: str) -> str:
    """Where a module is served, relative to the page."""
    return f"components/{__name__}/{_NAME}/__javascript_modules__/{FILES[name].relative_to(_HERE).as_posix()}"


_BY_ADDRESS = {address(name): path for name, path in FILES.items()}


def modules() -> list[str]:
    """The addresses of all modules that are fetched. The page lists them: a browser need not find them one by one."""
    return [address(name) for name in FILES if name not in INLINE_SCRIPTS]


def file_at(path: str) -> Path | None:
    """The file at an address after "components/"; None if it is not one of our modules.

    Panel's handler finds the same file by searching all of them, which takes 5 ms each time.
    """
    return _BY_ADDRESS.get(f"components/{path}")


def module(name: str) -> str:
    """For a component's `_esm`: the `render` of the module of this name."""
    return (f'const {{ render }} = await import(new URL("{address(name)}", document.baseURI).href);\n'
            "export { render };\n")
