"""The page "The paper": a list of figures, the chosen one, its caption and its rows of the table."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from granchain_core.paper import FIGURES, PaperFigure, Result, statements

from ...parts.figures.result_figure import ResultFigure
from ...parts.toolkit.component import text
from ...plots.paper import paper_figure, size_of
from ...scripts import module


class Paper(ResultFigure):
    """The overlay; captions and rows are in `state`, and the figure is sent as a message."""

    _esm = module("paper.js")
    _stylesheets = [text("controls.css"), text("result_page.css"), text("paper.css")]  # noqa: RUF012

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state={"figures": [
            {"number": figure.number, "title": figure.title} for figure in FIGURES.values()]}, **params)

    def choose(self, figure: PaperFigure) -> None:
        """Show the text of a figure without its drawing."""
        self.clear_figure()
        self.update_state(chosen=figure.number, title=figure.title, caption=figure.caption, rows=rows_of(figure.number))

    def draw(self, figure: PaperFigure, result: Result) -> None:
        """Show the figure itself."""
        width, height = size_of(result)
        self.show_figure(partial(paper_figure, result), f"Figure {figure.number}: {figure.title}", width / height)


def rows_of(number: str) -> list[dict[str, str]]:
    """Return the rows of the table that concern a figure."""
    return [{"paper": statement.paper, "ours": statement.ours, "differs": statement.differs,
             "command": statement.command} for statement in statements() if number in statement.figures]
