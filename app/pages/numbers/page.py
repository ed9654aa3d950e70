"""The Numbers tab of one session: a summary of every settled picture, and tables while the tab is visible."""

from __future__ import annotations

from granchain_core import Settled

from ...parts.toolkit.component import Component
from ...session.host import PageHost
from ...session.page import Actions, Page
from .words import beads, forces_over_time, summary


class NumbersPage(Page):
    """The page, which computes the tables and the summary. It has no view; the tabs' script draws its tab."""

    def __init__(self, host: PageHost, view: Component) -> None:
        self._host = host
        self._view = view
        self._visible = False
        self.actions: Actions = {}

    def picture_ready(self, settled: Settled) -> None:
        """Describe the new motion."""
        if settled.final:
            run = settled.run
            tables = {"forces": forces_over_time(run), "beads": beads(run)} if self._visible else {}
            self._view.send(type="numbers", summary=summary(run), **tables)

    def visibility_changed(self, visible: bool) -> None:
        """Compute the tables only while the page is visible."""
        self._visible = visible
        settled = self._host.session.settled
        if visible and settled is not None:
            self.picture_ready(settled)
