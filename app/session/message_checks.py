"""Checks of browser messages, whose contents are never trusted."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeGuard, TypeVar

from granchain_core import BadInput
from granchain_core.inputs.checks import unknown_name

Item = TypeVar("Item")


def is_number(value: object) -> TypeGuard[int | float]:
    """Return whether the value is a number; `True` and `False` are not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def quoted(value: object) -> str:
    """Return the beginning of a value from a message, in quotes, for use in a sentence."""
    return repr(str(value)[:40])


def check_integer(what: str, value: object, low: int, high: int) -> int:
    """Return `value` if it is a whole number in the range; otherwise, and for `True` and `False`, raise `BadInput`."""
    if not is_number(value) or not low <= value <= high or value != int(value):
        raise BadInput(f"The {what} {quoted(value)} is not a whole number from {low} to {high}.")
    return int(value)


def check_bool(what: str, value: object) -> bool:
    """Return `value` if it is `True` or `False`; otherwise raise `BadInput`."""
    if not isinstance(value, bool):
        raise BadInput(f"The value {quoted(value)} of {what} is neither true nor false.")
    return value


def check_choice(what: str, value: object, known: Iterable[str]) -> str:
    """Return `value` if it is a known name; otherwise raise `BadInput`, which names the nearest."""
    names = tuple(known)
    if not isinstance(value, str) or value not in names:
        raise unknown_name(what, str(value)[:40], names)
    return value


def check_index(what: str, items: Sequence[Item], index: object) -> Item:
    """Return the item at this index of a list on the page; raise `BadInput` if the list has no such item."""
    if not is_number(index) or not isinstance(index, int) or not 0 <= index < len(items):
        raise BadInput(f"That {what} is no longer on the page; choose another.")
    return items[index]
