"""The page "The paper": a choice of figures, the chosen one, its caption and its rows of the table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bokeh.embed import json_item

from granchain_core.paper import FIGURES, PaperFigure, Result, statements

from ...parts.component import Component, text
from ...pictures.paper import paper_figure, size_of
from ...pictures.theme import THEMES, Theme
from ...scripts import module


class Paper(Component):
    """The page over the pictures; captions and rows come in `state`, the figure as a message."""

    _esm = module("paper.js")
    _stylesheets = [text("controls.css"), text("paper.css")]  # noqa: RUF012

    def __init__(self, received: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(received, state={"figures": [
            {"number": one.number, "title": one.title} for one in FIGURES.values()]}, **params)
        self._theme = THEMES["light"]
        self._drawn: tuple[PaperFigure, Result] | None = None

    def choose(self, figure: PaperFigure) -> None:
        """Show what is said of a figure, and nothing drawn."""
        self._drawn = None
        self.send(type="clear")
        self.update_state(chosen=figure.number, title=figure.title, caption=figure.caption, rows=rows_of(figure.number))

    def draw(self, figure: PaperFigure, result: Result) -> None:
        """Show the figure itself."""
        self._drawn = figure, result
        width, height = size_of(result)
        self.send(type="figure", figure=json_item(paper_figure(result, self._theme)), shape=width / height,
                  words=f"Figure {figure.number}: {figure.title}")

    def apply_theme(self, theme: Theme) -> None:
        """Draw the figure anew in another theme."""
        if theme != self._theme:
            self._theme = theme
            if self._drawn is not None:
                self.draw(*self._drawn)


def rows_of(number: str) -> list[dict[str, str]]:
    """The rows of the table that concern a figure."""
    return [{"paper": one.paper, "ours": one.ours, "differs": one.differs, "command": one.command}
            for one in statements() if number in one.figures]
