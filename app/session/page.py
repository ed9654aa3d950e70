"""The base class of pages: the hooks through which the dashboard notifies them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from granchain_core import Settled
from granchain_core.experiment import Difference

from ..plots.theme import Theme
from .activities import Activity

Actions = Mapping[str, Callable[[dict[str, Any]], None]]


class Page:
    """One page of one session. Hooks are called with the document locked; by default they do nothing.

    Hooks and actions run in the event loop, which all sessions share. Each may therefore take at most about ten
    milliseconds; longer work is a `Task`.

    `actions` maps the "do" of a browser message to its handler. A name may be used only once in the dashboard. The
    actions whose names end with `-stop` together end all work of the page, and the page then says "stopped".
    """

    actions: Actions

    @property
    def activity(self) -> Activity | None:
        """Name, state and detail for the list of running computations; None if the page is not in the list."""
        return None

    def picture_requested(self) -> None:
        """Called when a new picture is requested, so that results of the old picture are out of date."""

    def scene_changed(self) -> None:
        """Called when the knobs have changed or another scene was opened."""

    def address_applied(self) -> None:
        """Called when the session was set from an address, after a step back or forward."""

    def picture_ready(self, settled: Settled) -> None:
        """Called when a settled picture was offered to the browser; it may still wait until the browser is ready.

        Unless `settled.final`, a better picture for these knobs may follow.
        """

    def curve_ready(self) -> None:
        """Called when the resonance curve from rest is complete: `PageHost.complete_curve` returns it."""

    def curve_compared(self, difference: Difference | None) -> None:
        """Called when a measured curve was compared with the complete curve from rest; None when a new curve starts."""

    def theme_changed(self, theme: Theme) -> None:
        """Called when the page has another theme; the figures of a view follow automatically."""

    def visibility_changed(self, visible: bool) -> None:
        """Called when the page or its tab becomes visible or hidden; it is hidden at first."""


def all_actions(owners: Mapping[str, Actions]) -> Actions:
    """Return the actions of all owners in one table. Raises `TypeError` if two owners use the same name."""
    owner_of: dict[str, str] = {}
    for owner, actions in owners.items():
        for name in actions:
            if name in owner_of:
                raise TypeError(f"{owner_of[name]} and {owner} both have an action {name!r}; rename one of them.")
            owner_of[name] = owner
    return {name: action for actions in owners.values() for name, action in actions.items()}
