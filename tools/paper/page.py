"""The parts of docs/paper.md that are made: the table and the gallery, each between two marks."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from granchain_core.paper import FIGURES, Statement

PAGE = Path(__file__).resolve().parents[2] / "docs" / "paper.md"
FOLDER = PAGE.parent / "paper"
_HEAD = ("| figure | the paper states | we get | do they differ? | command |", "|---|---|---|---|---|")


def table(rows: Sequence[Statement]) -> str:
    """The table in Markdown."""
    lines = [f"| {', '.join(one.figures)} | {one.paper} | {one.ours} | {one.differs} | `{one.command}` |" for one in rows]
    return "\n".join([*_HEAD, *lines])


def gallery() -> str:
    """A picture for each figure; 3 shows 3a and 3b."""
    return "\n\n".join(f"### Figure {one.number}\n\n![{one.title}](paper/figure-{one.number}.png)"
                       for one in FIGURES.values() if one.number not in ("3a", "3b"))


def with_parts(text: str, rows: Sequence[Statement]) -> str:
    """The page with its table and its gallery as they are now."""
    for name, part in (("table", table(rows)), ("gallery", gallery())):
        begin, end = f"<!-- {name}: python -m tools.paper -->", f"<!-- end of {name} -->"
        text, count = re.subn(re.escape(begin) + r".*?" + re.escape(end), lambda _: f"{begin}\n\n{part}\n\n{end}",  # noqa: B023
                              text, flags=re.DOTALL)
        if count != 1:
            raise ValueError(f"docs/paper.md has the mark {begin} {count} times")
    return text
