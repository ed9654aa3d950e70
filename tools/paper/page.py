"""The generated parts of docs/paper.md, each between two marks: the table, its rows that differ, the gallery."""

from __future__ import annotations

import textwrap
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


def not_reproduced(rows: Sequence[Statement]) -> str:
    """Return the list of the statements that do not hold, from the rows with “Yes”."""
    differ = [one for one in rows if one.differs.startswith("Yes")]
    items = [f"{number}. *Figure {', '.join(one.figures)}.* {one.paper} *Here:* " + one.differs.removeprefix("Yes. ")
             for number, one in enumerate(differ, 1)]
    return "\n".join("\n".join(textwrap.wrap(item, 120, subsequent_indent="   ", break_long_words=False,
                                             break_on_hyphens=False)) for item in items)


def gallery() -> str:
    """Return the gallery, with a picture of each figure; figure 3 shows 3a and 3b."""
    return "\n\n".join(f"### Figure {one.number}\n\n![{one.title}](paper/figure-{one.number}.png)"
                       for one in FIGURES.values() if one.number not in ("3a", "3b"))


def with_parts(text: str, rows: Sequence[Statement]) -> str:
    """Return the page with its generated parts updated."""
    for name, part in (("not reproduced", not_reproduced(rows)), ("table", table(rows)), ("gallery", gallery())):
        text = with_part(text, name, "python -m tools.paper", part)
    return text
