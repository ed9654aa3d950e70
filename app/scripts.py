"""The dashboard's JavaScript: modules that import each other, served at addresses that mirror the folders.

Panel takes a component's module as text, and text cannot import its neighbours, so this text only fetches the real
module. Panel's handler for component resources serves it, under `granchain serve` and `panel serve` alike; it serves
the files listed here and no others.

Python asks for a module by its name alone, so no two files may have the same name. The modules are listed and hashed
when this module is imported: after you edit a script, restart the server.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

_HERE = Path(__file__).resolve().parent


def files_by_name(pattern: str, folder: Path = _HERE) -> dict[str, Path]:
    """Return the matching files below a folder, by name. Raises `ValueError` if two have the same name."""
    paths: dict[str, Path] = {}
    for path in sorted(folder.rglob(pattern)):
        if path.name in paths:
            raise ValueError(f"{path} and {paths[path.name]} have the same name; modules and styles are found by name.")
        paths[path.name] = path
    return paths


#: Every module by its name.
FILES = files_by_name("*.js")
#: Modules written into the page itself, in this order: they listen before any other module is loaded.
INLINE_SCRIPTS = ("shared.js", "address.js", "connection.js")


class Scripts:
    """Lists the files that Panel's handler may serve."""

    __javascript_modules__ = tuple(FILES.values())


#: The same class under a name that changes when any file does, so that browsers never mix new modules with cached ones.
_NAME = "Scripts_" + hashlib.sha256(b"".join(path.read_bytes() for path in FILES.values())).hexdigest()[:12]
globals()[_NAME] = Scripts


def address(name: str) -> str:
    """Return the address of a module, relative to the page."""
    return f"components/{__name__}/{_NAME}/__javascript_modules__/{FILES[name].relative_to(_HERE).as_posix()}"


_BY_ADDRESS = {address(name): path for name, path in FILES.items()}


def modules() -> list[str]:
    """Return the addresses of all fetched modules. The page lists them, so that a browser need not discover them."""
    return [address(name) for name in FILES if name not in INLINE_SCRIPTS]


def file_at(path: str) -> Path | None:
    """Return the file at an address without its "components/"; None if it is not one of our modules.

    Panel's handler finds the same file by searching all of them, which takes 5 ms each time.
    """
    return _BY_ADDRESS.get(f"components/{path}")


def module(name: str) -> str:
    """Return the text of a component's `_esm`, which exports the `render` of the module of this name."""
    return (f'const {{ render }} = await import(new URL("{address(name)}", document.baseURI).href);\n'
            "export { render };\n")
