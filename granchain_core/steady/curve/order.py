"""The order in which the points of a curve are computed."""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Iterator, Sequence

from ...inputs.checks import unknown_name

#: The knobs by which one point of a curve differs from its neighbours: values by name.
Knobs = dict[str, float]

#: Ways to start the points of a curve: each from rest, or each from the state of the one before, upwards or downwards.
CURVE_STARTS = ("rest", "up", "down")
#: One in this many points, those of the lowest frequencies, comes first. With `sec2` on two threads, the last of 298
#: points then ends 3 % after the mean; with 8 or 32 it ends 5 % after it, and with none 8 %.
_LOWEST = 16


def coarse_first(count: int) -> list[int]:
    """Indices 0..count−1 in an order that shows the curve's shape early: ends, middle, quarters, …"""
    step = 1 << max(0, (count - 1).bit_length())
    order = [0, count - 1] if count > 1 else list(range(count))
    ordered = set(order)
    while step >= 1:
        for i in range(0, count, step):
            if i not in ordered:
                ordered.add(i)
                order.append(i)
        step //= 2
    return order


def used_and_missing(known: Sequence[float], frequencies: Sequence[float], start: str) -> tuple[list[int], list[int]]:
    """Indices of the known points that a curve can use, and of the missing frequencies, in order of computation.

    From rest, every known point is used. Where the state is carried along, only those before the first missing
    frequency are. Raises `BadInput` for an unknown start.
    """
    if start not in CURVE_STARTS:
        raise unknown_name("start", start, CURVE_STARTS)
    ascending = sorted(range(len(frequencies)), key=lambda i: frequencies[i], reverse=start == "down")
    order = [ascending[i] for i in coarse_first(len(frequencies))] if start == "rest" else ascending
    places: dict[float, list[int]] = {}
    for place, frequency in enumerate(known):
        places.setdefault(frequency, []).append(place)
    used: list[int] = []
    missing: list[int] = []
    for i in order:
        same = places.get(frequencies[i])
        if same and (start == "rest" or not missing):
            used.append(same.pop())
        else:
            missing.append(i)
    return used, missing


class LongestFirst:
    """Points of a curve from rest, in the order in which threads draw them: those that may take long come early.

    A long point that is drawn last keeps one thread busy when the others have nothing left to do. The lowest
    frequencies come first, since their periods have the most steps. The others follow in the order given, coarse first.
    The last half of these lies between computed points: those whose neighbours took longest come first, since all
    points near a bifurcation settle slowly.
    """

    def __init__(self, points: list[Knobs]) -> None:
        ascending = sorted(range(len(points)), key=lambda i: points[i]["f"])
        lowest = ascending[: len(points) // _LOWEST]
        self._lowest = [points[i] for i in lowest]
        others = [points[i] for i in sorted(ascending[len(lowest):])]
        half = (len(others) + 1) // 2
        self._coarse, self._between = others[:half], others[half:]
        self._time: dict[float, float] = {}

    def __iter__(self) -> Iterator[Knobs]:
        yield from self._lowest
        yield from self._coarse
        frequencies = sorted(knobs["f"] for knobs in (*self._lowest, *self._coarse))

        def of_neighbours(knobs: Knobs) -> float:
            place = bisect(frequencies, knobs["f"])
            return max(self._time.get(f, math.inf) for f in frequencies[max(0, place - 1) : place + 1])

        yield from sorted(self._between, key=of_neighbours, reverse=True)

    def finished(self, frequency: float, periods: int) -> None:
        """Note the time that a point took. A point still running when the last half begins counts as the longest."""
        self._time[frequency] = periods / frequency
