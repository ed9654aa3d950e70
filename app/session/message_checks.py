"""Checks of browser messages, whose contents are never trusted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeGuard, TypeVar

from granchain_core import BadInput

Item = TypeVar("Item")


def is_number(value: object) -> TypeGuard[int | float]:
    """Whether it is a number; `True` and `False` are none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def quoted(value: object) -> str:
    """What a message contained, to be named in a sentence: its beginning in quotes."""
    return repr(str(value)[:40])


def whole(what: str, value: object, low: int, high: int) -> int:
    """Return `value` if it is a whole number in a range; raise `BadInput` otherwise, for `True` and `False` too."""
    if not is_number(value) or not low <= value <= high or value != int(value):
        raise BadInput(f"The {what} {quoted(value)} is not a whole number from {low} to {high}.")
    return int(value)


def listed(what: str, items: Sequence[Item], index: object) -> Item:
    """Return the item at a place of a list on the page; raise `BadInput` if the list no longer has it."""
    if not is_number(index) or not isinstance(index, int) or not 0 <= index < len(items):
        raise BadInput(f"That {what} is no longer on the page; choose another.")
    return items[index]
