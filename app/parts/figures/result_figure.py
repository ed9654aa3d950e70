"""Base class of components whose figure is sent as a whole, in one message with all its points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from bokeh.models import LayoutDOM

from ...plots.json_item import figure_item
from ...plots.theme import THEMES, Theme
from ..toolkit.component import Component


@dataclass(frozen=True)
class _Drawn:
    """A figure: how it is drawn, its text for screen readers, and width over height (0 for the ratio of its place)."""

    draw: Callable[[Theme], LayoutDOM]
    words: str
    shape: float


class ResultFigure(Component):
    """A component whose figures are sent as a whole, with all points, when there is a result and for each new theme.

    Each figure has a place on the page, with the same name as in its `ResultFigure` of result_figure.js. A figure that
    grows, or is filled in the browser, is a `StreamedFigure` instead.
    """

    __abstract = True

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, **params)
        self._theme = THEMES["light"]
        self._drawn: dict[str, _Drawn] = {}

    def show_figure(self, draw: Callable[[Theme], LayoutDOM], words: str, shape: float = 0.0, place: str = "") -> None:
        """Show a figure, replacing any earlier one in its place."""
        self._drawn[place] = _Drawn(draw, words, shape)
        self._send_figure(place)

    def clear_figure(self, place: str = "") -> None:
        """Remove the figure."""
        self._drawn.pop(place, None)
        self.send(type="clear", place=place)

    def apply_theme(self, theme: Theme) -> None:
        """Redraw all figures in another theme."""
        if theme != self._theme:
            self._theme = theme
            for place in self._drawn:
                self._send_figure(place)

    def _send_figure(self, place: str) -> None:
        drawn = self._drawn[place]
        figure = figure_item(drawn.draw(self._theme))
        self.send(type="figure", place=place, figure=figure, words=drawn.words, shape=drawn.shape)
