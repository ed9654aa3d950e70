"""The Branches page: periodic orbits over the drive frequency, stable and unstable, with their special points."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

from ...parts.figures.streamed_figure import StreamedFigure, page_and_small
from ...parts.toolkit.component import text
from ...plots.branches import SPECIAL, branches
from ...plots.theme import Theme
from ...scripts import module

#: Longest period that the page offers, in drive periods.
LONGEST_BRANCH_PERIOD = 8


@cache
def empty_figures(theme: Theme) -> dict[str, Any]:
    """Return the figure without branches, for the page and, small, for its tab."""
    return page_and_small(lambda compact: branches([], theme, compact=compact))


class Branches(StreamedFigure):
    """The overlay; the growing branch is sent in messages."""

    _esm = module("branches.js")
    _stylesheets = [text("controls.css"), text("branches.css")]  # noqa: RUF012
    empty_figures = staticmethod(empty_figures)

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state={"longest_period": LONGEST_BRANCH_PERIOD, "special": list(SPECIAL)}, **params)
