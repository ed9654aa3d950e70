"""1:n resonances as the paper counts them: strong pushes per drive period, and peaks and valleys of the curve.

Source: Zhang et al. 2016, sections 2 and 3. A 1:n resonance has one strong push in n periods, at a local peak of the
largest transmitted force. An anti-resonance is a local valley with one push in every period, all about equally strong.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from math import gcd

import numpy as np

from ...results.run import Run

# How far each threshold may move was measured on the curves from rest of `sec2` (60 to 3000 Hz in steps of 10) and
# `rig` (20 to 160 Hz in steps of 1): the names of their peaks and valleys, and the words for the state at every point.
#: [response] A push is strong if its largest force is above this fraction of the largest push. All peaks and valleys of
#: `sec2` keep their names from 0.65 to 0.95, those of `rig` from 0.3 to 0.95; at 0.6 the 1:5 peak of `sec2` becomes
#: 2:5. The words for states of `sec2` change for 3 % of the states at 0.6 and for 6 % at 0.8.
STRONG_FRACTION = 0.7
#: [response] A push ends where the force falls below this fraction of the largest push. No name or word of a curve
#: changes from 0.001 to 0.15. The beginning of a push decides whether an orbit's pulse returns in step: of 102 orbits
#: of `rig`, one changes its name at 0.04, two at 0.06 and 11 at 0.08; of 261 of `sec2`, none does up to 0.2.
END_FRACTION = 0.05
#: [response] A peak or valley counts if it differs from both neighbouring extrema by this fraction of the larger. So a
#: valley is at least 20 % below both neighbouring peaks. `sec2` has the same extrema from 0.1 to 0.25; `rig`, where
#: motions differ from point to point, has two more at 0.18 and two fewer at 0.25.
PROMINENCE = 0.2
#: [response] A state is on a peak if its force is below the peak by at most this fraction of the height above the next
#: valley. This moves only the border between peak and flank: for at most 3 % of the states from 0.15 to 0.25, and for
#: 7 % from 0.1 to 0.3.
_PEAK_FRACTION = 0.2
#: [response] A state is in a valley if its force is above the valley by less than this fraction of the height of the
#: next peak above it. States in between are on a flank. From 0.05 to 0.15, the words change for at most 1 % of the
#: states of `sec2`, and for 3 % of those of `rig`.
_VALLEY_FRACTION = 0.1
#: [response] A state is not on the curve if its force differs from the curve's at its frequency by more than this
#: fraction. States from rest are on it for any value from 0.001 up. Of 590 states of `sec2` in sweeps up and down, 544
#: are within 0.001 and 570 within 0.03; from 0.08 to 0.15 only three change sides.
_CURVE_DIFFERENCE = 0.1
#: [response] Little is transmitted if less than this fraction of the largest input force arrives at the wall. Beyond
#: the last peak of a curve, that is the stop band. The stop band of `sec2` begins at 1960 Hz for 0.14 to 0.25, at
#: 2020 Hz for 0.12 and at 2750 Hz for 0.1; `rig` has no stop band in its range.
STOP_BAND_FRACTION = 0.15


@dataclass(frozen=True)
class Place:
    """The place of a state on the curve from rest.

    `kind` is "peak", "valley", "flank", "stop band" or "" (none of these, or the state is not on the curve). For a peak
    or a flank, `peak` is the peak's frequency [Hz] and `period` its period in drive periods, None if not periodic.
    """

    kind: str
    peak: float = 0.0
    period: int | None = None


def pushes(run: Run) -> tuple[int, int] | None:
    """Strong pushes of the driver and drive periods in lowest terms, (1, 3) for a 1:3 motion; None if not periodic."""
    if run.regime.period is None:
        return None
    force = run.input_force[:-1]
    largest = float(force.max())
    if largest <= 0.0:
        return None
    quiet = np.flatnonzero(force < END_FRACTION * largest)
    if len(quiet) == 0:
        return None
    force = np.roll(force, -quiet[0])  # the orbit is closed, so start at a sample without a push
    pushed = np.concatenate([[False], force >= END_FRACTION * largest, [False]])
    begins, ends = np.flatnonzero(pushed[1:] & ~pushed[:-1]), np.flatnonzero(~pushed[1:] & pushed[:-1])
    strong = sum(float(force[a:b].max()) >= STRONG_FRACTION * largest for a, b in zip(begins, ends, strict=True))
    periods = round((len(run.time) - 1) / run.samples)
    common = gcd(strong, periods)
    return strong // common, periods // common


def place_of(frequency: Sequence[float] | np.ndarray, force: Sequence[float] | np.ndarray,
             periods: Sequence[int | None], at: float, output: float, transmission: float) -> Place:
    """Find the place of a state with largest output force `output` at frequency `at` on a curve in ascending frequency.

    `periods` are those of the curve's points, None where not periodic; `transmission` is the state's largest output
    force over its largest input force.
    """
    f, F = np.asarray(frequency, dtype=float), np.asarray(force, dtype=float)
    if len(f) < 5 or not f[0] <= at <= f[-1]:
        return Place("")
    here = float(np.interp(at, f, F))
    if abs(here - output) > _CURVE_DIFFERENCE * max(here, output):
        return Place("")
    turns, peaks, valleys = _shape(tuple(F.tolist()))
    if transmission < STOP_BAND_FRACTION and peaks and all(f[i] < at for i in peaks):
        return Place("stop band")
    before, after = [i for i in turns if f[i] <= at], [i for i in turns if f[i] > at]
    if not before or not after or F[before[-1]] == F[after[0]]:
        return Place("")
    low, high = sorted((before[-1], after[0]), key=lambda i: F[i])
    part = (output - F[low]) / (F[high] - F[low])
    if high in peaks and part > 1.0 - _PEAK_FRACTION:
        return Place("peak", float(f[high]), periods[high])
    if low in valleys and part < _VALLEY_FRACTION:
        return Place("valley")
    return Place("flank", float(f[high]), periods[high]) if high in peaks else Place("")


@lru_cache(maxsize=64)
def _shape(force: tuple[float, ...]) -> tuple[list[int], list[int], list[int]]:
    """Extrema, peaks and valleys of a curve; cached, because a page asks for a place whenever a knob moves."""
    values = np.array(force)
    return extrema(values), *peaks_and_valleys(values)


def extrema(force: np.ndarray) -> list[int]:
    """Indices of ends, peaks and valleys of a curve, alternating, leaving out those that do not stand out."""
    turns = [0]
    for i in range(1, len(force)):
        rising = force[i] > force[turns[-1]]
        if len(turns) > 1 and rising == (force[turns[-1]] > force[turns[-2]]):
            turns[-1] = i
        elif abs(force[i] - force[turns[-1]]) >= PROMINENCE * max(force[i], force[turns[-1]]):
            turns.append(i)
    return turns


def peaks_and_valleys(force: np.ndarray) -> tuple[list[int], list[int]]:
    """Indices of the peaks and of the valleys of a curve: extrema that stand out from both sides."""
    both: tuple[list[int], list[int]] = [], []
    for before, here in pairwise(extrema(force)[:-1]):
        both[0 if force[here] > force[before] else 1].append(here)
    return both


def push_words(pushed: tuple[int, int]) -> str:
    """A ratio in words, for 1:3 "one strong push of the driver in 3 drive periods"."""
    count, periods = pushed
    number = "one strong push" if count == 1 else f"{count} strong pushes"
    return f"{number} of the driver in {'every drive period' if periods == 1 else f'{periods} drive periods'}"


def place_words(pushed: tuple[int, int] | None, place: Place | None) -> str:
    """A periodic motion in the paper's terms: strong pushes per drive periods, and its place on the curve.

    `place` is None while the curve is being computed. A peak with one strong push in n periods, and a valley with one
    in every period, get the paper's names, resonance and anti-resonance.
    """
    if pushed is None:
        return ""
    ratio = f"{pushed[0]}:{pushed[1]}"
    if place is None:
        return f"{ratio} motion (the curve is being computed)"
    if place.kind == "peak":
        return f"{ratio} resonance" if pushed[0] == 1 else f"{ratio} motion, on a peak"
    if place.kind == "valley":
        return f"{ratio} anti-resonance" if pushed == (1, 1) else f"{ratio} motion, in a valley"
    if place.kind == "flank":
        peak = f"the 1:{place.period} peak" if place.period else "the peak"
        return f"{ratio} motion, flank of {peak} at {place.peak:.0f} Hz"
    return f"{ratio} motion, stop band" if place.kind == "stop band" else f"{ratio} motion"
