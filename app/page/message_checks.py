"""Checks of what a message from a browser contains; nothing in it is trusted unchecked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from granchain_core import BadInput

Item = TypeVar("Item")


def whole(what: str, value: object, low: int, high: int) -> int:
    """Return `value` if it is a whole number in a range; raise `BadInput` otherwise, for `True` and `False` too."""
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number or not low <= value <= high or value != int(value):  # type: ignore[operator,call-overload]
        raise BadInput(f"The {what} {str(value)[:40]!r} is not a whole number from {low} to {high}.")
    return int(value)  # type: ignore[call-overload]


def listed(what: str, items: Sequence[Item], place: object) -> Item:
    """Return the item at a place of a list on the page; raise `BadInput` if the list no longer has it."""
    if not isinstance(place, int) or isinstance(place, bool) or not 0 <= place < len(items):
        raise BadInput(f"That {what} is not on the page any more; choose another.")
    return items[place]
