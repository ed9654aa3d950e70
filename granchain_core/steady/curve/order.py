"""The order in which the points of a curve are computed."""

from __future__ import annotations

from collections.abc import Sequence

from ...inputs.checks import unknown_name

#: Ways to start the points of a curve: each from rest, or each from the state of the one before, upwards or downwards.
CURVE_STARTS = ("rest", "up", "down")


def coarse_first(count: int) -> list[int]:
    """Indices 0..count−1 so that the curve's shape is there early: ends, middle, quarters, …"""
    step = 1 << max(0, (count - 1).bit_length())
    order: list[int] = []
    seen = set()
    while step >= 1:
        for i in range(0, count, step):
            if i not in seen:
                seen.add(i)
                order.append(i)
        step //= 2
    return order


def used_and_missing(known: Sequence[float], frequencies: Sequence[float], start: str) -> tuple[list[int], list[int]]:
    """Places of the known points that a curve can use, and of the frequencies that are missing, in order of computing.

    From rest every known point is used. Where the state is carried along, only those up to the first that is missing.
    Raises `BadInput` for an unknown start.
    """
    if start not in CURVE_STARTS:
        raise unknown_name("start", start, CURVE_STARTS)
    count = range(len(frequencies))
    order = (coarse_first(len(frequencies)) if start == "rest"
             else sorted(count, key=lambda i: frequencies[i], reverse=start == "down"))
    there: dict[float, list[int]] = {}
    for place, frequency in enumerate(known):
        there.setdefault(frequency, []).append(place)
    used: list[int] = []
    missing: list[int] = []
    for i in order:
        found = there.get(frequencies[i])
        if found and (start == "rest" or not missing):
            used.append(found.pop())
        else:
            missing.append(i)
    return used, missing
