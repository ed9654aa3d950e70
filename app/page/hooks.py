"""The hooks through which the dashboard informs each page, and what it asks of a page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from granchain_core import Settled

from .activities import Activity


class Page:
    """One page of one visitor. Hooks are called in the document's turn; by default they do nothing.

    `actions` maps the "do" of a browser message to its handler; every name may be used only once in the dashboard.
    """

    actions: dict[str, Callable[[dict[str, Any]], None]]

    @property
    def activity(self) -> Activity | None:
        """Name, state and detail for the list of what is computed now; None where the page has no line in it."""
        return None

    def moved(self) -> None:
        """A new picture was requested: what belongs to the old one is out of date."""

    def changed(self) -> None:
        """The knobs have changed, or another scene was opened."""

    def arrived(self, picture: Settled) -> None:
        """A settled picture is ready; a better one for these knobs may follow unless `picture.final`."""

    def close(self) -> None:
        """The visitor left."""
