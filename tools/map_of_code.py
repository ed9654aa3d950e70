"""The map of the code in docs/design.md: the contents of each folder, from the docstring of its `__init__.py`.

The order of the rows and their last column, the folders that a folder imports, are written by hand. The generator keeps
them, and `tests/architecture/test_design_map.py` compares them with the imports.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]
_MAP = _ROOT / "docs" / "design.md"
_TOPS = ("granchain_start", "granchain", "granchain_core", "app")
_PAGES = "app/pages"
_ROW = re.compile(r"^\| `([\w/]+)` \| [^|]+ \| ([^|]+) \|$", re.MULTILINE)


def table_of_folders() -> str:
    """Return the rows of all folders with code except those of pages; a new folder is put after its parent folder."""
    uses = {folder: used for folder, used in _ROW.findall(_MAP.read_text(encoding="utf-8")) if _is_on_map(folder)}
    there = [folder for folder in _folders() if _is_on_map(folder)]
    order = [folder for folder in uses if folder in there]
    for folder in there:
        if folder not in order:
            parent = folder.rpartition("/")[0]
            order.insert(1 + max((i for i, one in enumerate(order) if f"{one}/".startswith(f"{parent}/")), default=len(order)), folder)
    rows = [_row(folder, uses.get(folder, "–")) for folder in order]
    return "\n".join(["| folder | what is in it | uses |", "|---|---|---|", *rows])


def table_of_pages() -> str:
    """Return the rows of the folders in `app/pages`."""
    rows = [_row(folder, "–") for folder in _folders() if folder.startswith(f"{_PAGES}/")]
    return "\n".join(["| page | what is in it | uses |", "|---|---|---|", *rows])


def _folders() -> list[str]:
    return sorted(path.parent.relative_to(_ROOT).as_posix() for top in _TOPS for path in (_ROOT / top).rglob("__init__.py"))


def _is_on_map(folder: str) -> bool:
    return not folder.startswith(f"{_PAGES}/")


def _row(folder: str, uses: str) -> str:
    """Return a row; its text is the docstring's first paragraph, with links to the pages of docs that it names."""
    text = (_ROOT / folder / "__init__.py").read_text(encoding="utf-8")
    words = " ".join((ast.get_docstring(ast.parse(text)) or "").partition("\n\n")[0].split()).removesuffix(".")
    linked = re.sub(r"docs/([\w-]+[.]md)", r"[\1](\1)", words)
    return f"| `{folder}` | {linked} | {uses} |"
