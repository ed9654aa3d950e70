"""What the dashboard tells each of its pages, and asks of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from granchain_core import Settled

from .activities import Activity


class Page:
    """One page of one visitor. Every hook is called in the document's turn, and does nothing here.

    `actions` are the messages from the browser that the page answers, by their "do"; names are unique in the dashboard.
    """

    actions: dict[str, Callable[[dict[str, Any]], None]]

    @property
    def activity(self) -> Activity | None:
        """Name, state and detail for the list of what is computed now; None where the page has no line in it."""
        return None

    def moved(self) -> None:
        """Another picture is asked for."""

    def changed(self) -> None:
        """The knobs have changed, or another scene was opened."""

    def arrived(self, picture: Settled) -> None:
        """A settled picture has come, perhaps not the last for these knobs (`picture.final`)."""

    def close(self) -> None:
        """The visitor left."""
