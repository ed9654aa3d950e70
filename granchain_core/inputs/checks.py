"""Checks of input values. Each returns the value in the form in which it is used, or raises `BadInput`."""

from __future__ import annotations

import difflib
import math
import numbers
import operator
from collections.abc import Iterable
from typing import Any

from ..errors import BadInput


def unknown_name(kind: str, name: object, known: Iterable[str]) -> BadInput:
    """Return the error for an unknown name, which suggests the nearest known one."""
    names = sorted(known)
    near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.0)
    hint = f"; the nearest is {near[0]!r}" if near else ""
    return BadInput(f"Unknown {kind} {str(name)[:60]!r}{hint}; known: {', '.join(names)}.")


def check_range(what: str, value: float, low: float, high: float) -> None:
    """Raise `BadInput` if `value` is out of range; the message starts with `what` and gives the nearest valid value."""
    if not low <= value <= high:
        raise BadInput(f"{what} {value} is outside {low} to {high}; the nearest valid value is "
                       f"{min(max(value, low), high)}.")


def whole_number(what: str, value: object, low: int, high: float) -> int:
    """Return `value`, e.g. a NumPy integer, as an int; `BadInput` if it is not a whole number or out of range."""
    try:
        number = operator.index(value)  # type: ignore[arg-type]  # values without an index are refused
    except TypeError:
        number = None
    if number is None or isinstance(value, bool):
        near = isinstance(value, numbers.Real) and not isinstance(value, bool) and math.isfinite(value)
        nearest = min(max(round(value), low), high) if near else low  # type: ignore[call-overload]  # a real number
        raise BadInput(f"{what} {str(value)[:40]!r} must be a whole number from {low} to {high}; the nearest valid "
                       f"value is {nearest}.")
    check_range(what, number, low, high)
    return number


def seconds_allowed(budget: object) -> float:
    """Return a budget of computing time [s], possibly infinite, as a float; `BadInput` unless it is a number from 0."""
    if not isinstance(budget, numbers.Real) or isinstance(budget, bool) or not float(budget) >= 0.0:
        raise BadInput(f"budget = {str(budget)[:40]} must be a number of seconds, 0 or more; 86400 is a day.")
    return float(budget)


def series_in(what: str, values: object) -> list[Any]:
    """Return a list, an array or any other series as a list; `BadInput` for a single number and for a text."""
    try:
        if isinstance(values, (str, bytes)):
            raise TypeError
        return list(values)  # type: ignore[call-overload]  # anything but a series is refused
    except TypeError:
        raise BadInput(f"{what} must be a list or an array, not {str(values)[:40]!r}; "
                       f"[{str(values)[:40]}] is a list of one.") from None


def numbers_in(what: str, values: object) -> list[float]:
    """Return a series as floats; `BadInput` for words too."""
    try:
        return [float(value) for value in series_in(what, values)]
    except (TypeError, ValueError, OverflowError) as problem:
        if isinstance(problem, BadInput):
            raise
        raise BadInput(f"{what} must be numbers, not {str(values)[:40]!r}.") from None


def axis_in(what: str, given: object) -> tuple[str, Any]:
    """Return a pair of a name and its values; `BadInput` for anything else, for example a name alone."""
    if not isinstance(given, (tuple, list)) or len(given) != 2 or not isinstance(given[0], str):
        raise BadInput(f'{what} must be a name and its values, as in ("f", [300.0, 310.0]), not {str(given)[:40]!r}.')
    return given[0], given[1]
