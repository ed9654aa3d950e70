"""The Probe page of one session: the chosen bead, and whether the page is visible."""

from __future__ import annotations

from typing import Any

from granchain_core import Settled

from ...session.host import PageHost
from ...session.message_checks import check_integer
from ...session.page import Actions, Page
from .view import Probe


class ProbePage(Page):
    """The page, which follows the settled picture while it is visible and costs nothing at other times."""

    def __init__(self, host: PageHost, view: Probe) -> None:
        self._host = host
        self._view = view
        self._bead = 1
        self._visible = False
        self.actions: Actions = {"probe-bead": self._choose}

    def picture_ready(self, settled: Settled) -> None:
        """Draw the bead of the new motion."""
        self._draw(settled)

    def visibility_changed(self, visible: bool) -> None:
        """Draw the present motion when the page becomes visible."""
        self._visible = visible
        self._draw(self._host.session.settled)

    def _choose(self, message: dict[str, Any]) -> None:
        self._bead = check_integer("bead", message.get("bead"), 1, self._host.session.scene.N)
        self._draw(self._host.session.settled)

    def _draw(self, settled: Settled | None) -> None:
        if self._visible and settled is not None:
            self._bead = min(self._bead, settled.run.scene.N)
            self._view.fill(settled.run, self._bead)
