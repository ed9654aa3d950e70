"""The generated parts of docs/paper.md: the table and the gallery, each between two marks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from granchain_core.paper import FIGURES, Statement
from tools.generated import with_part

PAGE = Path(__file__).resolve().parents[2] / "docs" / "paper.md"
FOLDER = PAGE.parent / "paper"
_HEAD = ("| figure | the paper states | we get | do they differ? | command |", "|---|---|---|---|---|")


def table(rows: Sequence[Statement]) -> str:
    """Return the table in Markdown."""
    lines = [f"| {', '.join(one.figures)} | {one.paper} | {one.ours} | {one.differs} | `{one.command}` |" for one in rows]
    return "\n".join([*_HEAD, *lines])


def gallery() -> str:
    """Return the gallery, with a picture of each figure; figure 3 shows 3a and 3b."""
    return "\n\n".join(f"### Figure {one.number}\n\n![{one.title}](paper/figure-{one.number}.png)"
                       for one in FIGURES.values() if one.number not in ("3a", "3b"))


def with_parts(text: str, rows: Sequence[Statement]) -> str:
    """Return the page with its table and its gallery updated."""
    for name, part in (("table", table(rows)), ("gallery", gallery())):
        text = with_part(text, name, "python -m tools.paper", part)
    return text
