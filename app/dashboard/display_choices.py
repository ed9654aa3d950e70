"""The visitor's display choices: theme, scale of the pictures, and which curves are drawn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..curve.controller import CurveController
from ..curve.curve_bar import CHOICES
from ..plots.theme import THEMES, Theme
from ..session.message_checks import check_bool, check_choice
from ..session.page import Actions
from ..session.session import Session
from .layout import Views


class DisplayChoices:
    """Actions that change the display; only the choice of a curve starts a computation."""

    def __init__(self, session: Session, views: Views, curves: CurveController,
                 theme_changed: Callable[[Theme], None], redraw: Callable[[], None]) -> None:
        self._session = session
        self._views = views
        self._curves = curves
        self._theme_changed = theme_changed
        self._redraw = redraw
        self.actions: Actions = {
            "theme": lambda m: self.set_theme(m.get("value")), "scale": self._scale,
            "curve": self._curve, "curve-stop": lambda _: curves.stop(),
        }

    def set_theme(self, name: object) -> None:
        """Apply the colours and line widths of a theme."""
        theme = THEMES[check_choice("theme", name, THEMES)]
        self._views.apply_theme(theme)
        self._theme_changed(theme)

    def _scale(self, message: dict[str, Any]) -> None:
        self._session.set_scale(message.get("value"))
        self._views.scales.forget()
        self._views.header.show_session(self._session)
        self._redraw()

    def _curve(self, message: dict[str, Any]) -> None:
        name = check_choice("curve", message.get("name"), (name for name, *_ in CHOICES))
        self._curves.switch(name, check_bool(f"curve {name}", message.get("value")), self._session.scene)
        self._session.curves = self._curves.selection(self._session.scene)
        self._views.header.show_session(self._session)
