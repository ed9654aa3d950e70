"""The base of a part of the page in which figures of app/pictures stand."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import param

from ..pictures.theme import THEMES, Theme
from .component import Component


class Drawn(Component):
    """A part with figures: without points at first, sent when they are first needed and again for another theme.

    `figures` are Bokeh's JSON by name. They are no part of `state`, which is sent as a whole with each of its changes.
    The browser fills in what comes as messages.
    """

    figures = param.Dict(default={})

    empty_figures: ClassVar[staticmethod[[Theme], dict[str, Any]]]
    """Makes the figures without their points; every part of this kind has its own."""

    __abstract = True

    def __init__(self, received: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(received, **params)
        self.theme = THEMES["light"]

    def dress(self, theme: Theme) -> None:
        """Draw the figures anew in another theme."""
        if theme != self.theme:
            self.theme = theme
            if self.figures:
                self.figures = self.empty_figures(theme)

    def need_figures(self) -> None:
        """Something is about to be drawn."""
        if not self.figures:
            self.figures = self.empty_figures(self.theme)
