"""The Probe page of one visitor: which bead, and whether somebody looks."""

from __future__ import annotations

from typing import Any

from panel.io import unlocked

from granchain_core import Settled

from ...session.hooks import Actions, Page
from ...session.host import Host
from ...session.message_checks import whole
from .view import Probe


class ProbePage(Page):
    """It follows the settled picture while it is on the screen, so that it costs nothing otherwise."""

    def __init__(self, host: Host, view: Probe) -> None:
        self._host = host
        self._view = view
        self._bead = 1
        self._watched = False
        self.actions: Actions = {"probe-bead": self._choose, "probe-watched": self._watch}

    def picture_ready(self, picture: Settled) -> None:
        """Draw the bead of the new motion."""
        self._draw(picture)

    def _choose(self, message: dict[str, Any]) -> None:
        self._bead = whole("bead", message.get("bead"), 1, self._host.session.scene.N)
        self._draw(self._host.session.picture)

    def _watch(self, message: dict[str, Any]) -> None:
        self._watched = bool(message.get("value"))
        self._draw(self._host.session.picture)

    def _draw(self, picture: Settled | None) -> None:
        if self._watched and picture is not None:
            self._bead = min(self._bead, picture.run.scene.N)
            with unlocked():
                self._view.fill(picture.run, self._bead)
