"""Base class of components with figures of app/plots that are filled in the browser."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import param
from bokeh.models import LayoutDOM

from ...plots.json_item import figure_item
from ...plots.theme import THEMES, Theme
from ..toolkit.component import Component


def page_and_small(draw: Callable[[bool], LayoutDOM]) -> dict[str, Any]:
    """Return Bokeh's JSON of a figure for a page and, compact, for its tab; `draw` is told whether it is compact."""
    return {"page": figure_item(draw(False)), "small": figure_item(draw(True))}


class StreamedFigure(Component):
    """A component with figures. They are sent without data when first needed, and again when the theme changes.

    `figures` is Bokeh's JSON by name, kept out of `state` because each change of `state` sends all of it. Data arrive
    as messages, and the browser puts them into the figures: each is a `BokehFigure` (bokeh_figure.js), loaded when its
    page is opened, and when `figures` arrives or changes while the page is open.
    """

    figures = param.Dict(default={})

    empty_figures: ClassVar[staticmethod[[Theme], dict[str, Any]]]
    """Makes the figures without points; every subclass defines its own."""

    __abstract = True

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, **params)
        self.theme = THEMES["light"]

    def apply_theme(self, theme: Theme) -> None:
        """Redraw the figures in another theme."""
        if theme != self.theme:
            self.theme = theme
            if self.figures:
                self.figures = self.empty_figures(theme)

    def need_figures(self) -> None:
        """Send the figures if they have not been sent yet; called before the first data."""
        if not self.figures:
            self.figures = self.empty_figures(self.theme)
