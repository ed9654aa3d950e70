"""1:n, as the paper counts it: strong pushes of the driver per drive period, and peaks or valleys of the curve.

Source: Zhang et al. 2016, sections 2 and 3: a 1:n resonance has one strong push in n periods, at a local peak of the
largest transmitted force; an anti-resonance is a local valley with one weak pulse in every period.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import gcd

import numpy as np

from ..result import Run

#: A push is strong if its largest force is above this part of the largest push.
STRONG = 0.7
#: A push ends where the force falls below this part of the largest push.
ENDED = 0.05
#: A frequency belongs to a peak (valley) if its force is less than this part of the way from it to the next valley.
_NEAR = 0.35
#: A peak or valley of the curve stands out if it differs from both neighbouring extrema by this part of the larger.
_STANDS_OUT = 0.1


def pushes(run: Run) -> tuple[int, int] | None:
    """Strong pushes of the driver and drive periods in lowest terms, (1, 3) for a 1:3 motion; None if not periodic."""
    if run.regime.period is None:
        return None
    force = run.input_force[:-1]
    largest = float(force.max())
    if largest <= 0.0:
        return None
    quiet = np.flatnonzero(force < ENDED * largest)
    if len(quiet) == 0:
        return None
    force = np.roll(force, -quiet[0])  # the orbit is closed, so begin where nothing is pushed
    pushed = np.concatenate([[False], force >= ENDED * largest, [False]])
    begins, ends = np.flatnonzero(pushed[1:] & ~pushed[:-1]), np.flatnonzero(~pushed[1:] & pushed[:-1])
    strong = sum(float(force[a:b].max()) >= STRONG * largest for a, b in zip(begins, ends, strict=True))
    periods = round((len(run.time) - 1) / run.samples)
    common = gcd(strong, periods)
    return strong // common, periods // common


def nature(frequency: Sequence[float] | np.ndarray, force: Sequence[float] | np.ndarray, at: float) -> str:
    """"resonance", "anti-resonance" or "" for the frequency `at` on a curve of largest output force, ascending."""
    f, F = np.asarray(frequency, dtype=float), np.asarray(force, dtype=float)
    if len(f) < 5 or not f[0] <= at <= f[-1]:
        return ""
    turns = extrema(F)
    here = float(np.interp(at, f, F))
    before = [i for i in turns if f[i] <= at]
    after = [i for i in turns if f[i] > at]
    if not before or not after:
        return ""
    left, right = F[before[-1]], F[after[0]]
    if right == left:
        return ""
    way = (here - min(left, right)) / abs(right - left)  # 0 in the valley, 1 on the peak
    peak, valley = (before[-1], after[0]) if left > right else (after[0], before[-1])
    ends = (0, len(f) - 1)  # a curve's end is no extremum: nobody knows how it goes on
    if way > 1.0 - _NEAR:
        return "resonance" if peak not in ends else ""
    return "anti-resonance" if way < _NEAR and valley not in ends else ""


def extrema(force: np.ndarray) -> list[int]:
    """Indices of ends, peaks and valleys of a curve, alternating, leaving out those that do not stand out."""
    turns = [0]
    for i in range(1, len(force)):
        rising = force[i] > force[turns[-1]]
        if len(turns) > 1 and rising == (force[turns[-1]] > force[turns[-2]]):
            turns[-1] = i
        elif abs(force[i] - force[turns[-1]]) >= _STANDS_OUT * max(force[i], force[turns[-1]]):
            turns.append(i)
    return turns
