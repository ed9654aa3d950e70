"""The table at the top of each recipe docs/add-….md: every numbered step with its new and edited files."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

_DOCS = Path(__file__).resolve().parents[1] / "docs"
_STEP = re.compile(r"^## (\d+\. .+)$", re.MULTILINE)
_BLOCK = re.compile(r"^```(\w*)\n.*?^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"`([\w./-]+\.\w+)`")


def tables() -> list[tuple[str, str, Callable[[], str]]]:
    """Return, for every recipe, its page, the table's name in the page's marks, and the function that writes it."""
    return [(f"docs/{path.name}", "steps", partial(table_of_steps, path)) for path in sorted(_DOCS.glob("add-*.md"))]


def table_of_steps(page: Path) -> str:
    """Return the table of a recipe's numbered steps, with the files that each writes and edits.

    A step without a block describes its edits in words.
    """
    _, *parts = _STEP.split(page.read_text(encoding="utf-8"))
    rows = []
    for title, text in zip(parts[::2], parts[1::2], strict=True):
        new, edited = _files(text.partition("\n## ")[0])
        rows.append(f"| {title} | {_listed(new)} | {_listed(edited) if new or edited else 'see the step'} |")
    return "\n".join(["| step | new files | edited files |", "|---|---|---|", *rows])


def _files(text: str) -> tuple[list[str], list[str]]:
    """Return a step's new and edited files. The paragraph before a block names the block's file last."""
    new: list[str] = []
    edited: list[str] = []
    for block in _BLOCK.finditer(text):
        before = [part for part in text[: block.start()].split("\n\n") if part.strip()]
        if block[1] == "console" or not before or not (named := _FILE.findall(before[-1])):
            continue
        (new if before[-1].lstrip().startswith("New file") else edited).append(named[-1])
    return list(dict.fromkeys(new)), [name for name in dict.fromkeys(edited) if name not in new]


def _listed(files: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in files) or "–"
