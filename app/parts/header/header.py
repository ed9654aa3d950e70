"""The bar at the top: scene, time controls, mode, share, export, help and theme."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ...scripts import module
from ...session.export import EXPORTS
from ...session.scene_facts import presets
from ...session.session import Session
from ...session.share import SPEEDS, VIEW_VALUES
from ..toolkit.component import Component, text

_MODES = {
    "settled": "The steady state for these knobs, replayed",
    "live": "The run continues while you move the knobs",
}
_STARTS = {"rest": "start: from rest", "previous": "start: previous state"}
#: Replaces “from rest” while the motion on the screen began in another state, given by a story, a map or a branch.
_STARTED_ELSEWHERE = "start: a given state"


class Header(Component):
    """Buttons and lists of choices, each of which sends one message to the server."""

    _esm = module("header.js")
    _stylesheets = [text("controls.css"), text("header.css"), text("gallery.css")]  # noqa: RUF012

    def __init__(self, receive: Callable[[dict[str, Any]], None] | None = None, **params: Any) -> None:
        super().__init__(receive, state={
            "modes": [(mode, _MODES[mode]) for mode in VIEW_VALUES["mode"]],
            "starts": [(start, _STARTS[start]) for start in VIEW_VALUES["start"]],
            "started_elsewhere": _STARTED_ELSEWHERE,
            "files": list(EXPORTS.items()),
            "speeds": sorted(SPEEDS), "view_fields": list(VIEW_VALUES),
        }, **params)
        self._picture_start = "rest"

    def show_picture_start(self, start: str, session: Session) -> None:
        """Show where the picture on the screen started, as `Settled.start` names it."""
        if start != self._picture_start:
            self._picture_start = start
            self.show_session(session)

    def show_session(self, session: Session) -> None:
        """Show the session's choices, and the start of the picture on the screen."""
        self.update_state(
            scenes=presets(), scene=session.scene.name, mode=session.mode, start=session.start, theme=session.theme,
            picture_start=self._picture_start, driven=session.scene.is_driven, speed=session.speed,
            playing=session.playing, query=session.link)
