"""The spectral lines of stroboscopic states: on how many curves the states lie, and which frequency is basic.

The states of a quasi-periodic motion with two frequencies have lines at m ρ + j modulo 1, in units of one per drive
period. If they lie on n closed curves that are visited in turn, there are also lines at j/n.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .birkhoff import refined_frequency, weights

#: [rotation] Weakest line that counts, as a fraction of the strongest one.
WEAKEST_LINE = 1e-2
#: [rotation] Maximum number of lines that are examined.
_MOST_LINES = 10
#: [rotation] Distance in units of 1/P within which two peaks of the spectrum count as one line: the width of the
#: window's main lobe.
_WIDTH = 8
#: [rotation] Length of a record with the appended zeros over its length without them.
_PADDED = 2
#: [rotation] Maximum number of curves visited in turn, before lines at several fractions are combined.
MOST_CURVES = 16
#: [rotation] Difference between a line and a fraction j/q, in units of 1/P, below which the line is at j/q.
_AT_FRACTION = 0.02
#: [rotation] Difference between a line and a multiple of the basic frequency, in units of 1/P, below which the line is
#: that multiple; also the largest difference between the advance of an angle and its line.
AT_MULTIPLE = 0.2
#: [rotation] Largest multiple of the basic frequency.
_LARGEST_MULTIPLE = 15
#: [rotation] Largest multiple of the basic frequency at which the strongest line may be.
_LARGEST_STRONGEST = 4


@dataclass(frozen=True)
class Basic:
    """A frequency per period of which all lines are multiples modulo 1: line i is the `multiples[i]`-th."""

    frequency: float
    multiples: tuple[int, ...]


def lines_of(states: np.ndarray) -> np.ndarray:
    """Frequencies per period (L,) of the lines of pairs of successive states, in [0, ½], the strongest first.

    `states` (P, 2D) are the pairs, with the mean removed; the spectrum is that of the first of each pair. Anything
    slower than a few turns in the record is not a line: it is a drift, or a remainder of the mean.
    """
    count = len(states)
    power = np.zeros(_PADDED * count // 2 + 1)
    for column in states.T[: states.shape[1] // 2]:  # one at a time, because a long padded record is large
        power += np.abs(np.fft.rfft(weights(count) * column, n=_PADDED * count)) ** 2
    power[: _PADDED * _WIDTH] = 0.0
    around = np.concatenate([[0.0], power, [0.0]])
    peaks = np.nonzero((power >= around[:-2]) & (power >= around[2:]) & (power > WEAKEST_LINE**2 * power.max()))[0]
    kept: list[int] = []
    for peak in peaks[np.argsort(-power[peaks])]:
        if len(kept) < _MOST_LINES and all(abs(peak - other) > _PADDED * _WIDTH for other in kept):
            kept.append(int(peak))
    return np.array([refined_frequency(states, peak / (_PADDED * count)) for peak in kept])


def fraction_at(line: float, periods: int) -> int:
    """The denominator q of the fraction j/q at which a line of a record of `periods` periods lies; 0 if at none."""
    for q in range(1, MOST_CURVES + 1):
        if abs(line * q - round(line * q)) < q * _AT_FRACTION / periods:
            return q
    return 0


def curves_of(lines: np.ndarray, periods: int) -> int:
    """The number of closed curves that the states visit in turn: the common denominator of lines at fractions j/q."""
    return math.lcm(*(q for line in lines if (q := fraction_at(float(line), periods))))


def basic_frequency(lines: np.ndarray, periods: int) -> Basic | None:
    """Find the frequency of which all lines (L,) of a record are multiples modulo 1; None if there is no such one.

    The strongest line may itself be a small multiple k of it, for example if a coordinate goes round k times in one
    turn of the curve. Then the basic frequency is one of (ν₁ + j)/k with j = 0 … k − 1.
    """
    for k in range(1, _LARGEST_STRONGEST + 1):
        candidates = [Basic((lines[0] + j) / k, multiples) for j in range(k)
                 if (multiples := _multiples(lines, (lines[0] + j) / k, periods)) and math.gcd(*multiples) == 1]
        if candidates:
            return min(candidates, key=lambda basic: max(map(abs, basic.multiples)))
    return None


def _multiples(lines: np.ndarray, frequency: float, periods: int) -> tuple[int, ...]:
    """For every line, the smallest m, |m| ≤ 15, with line = m · frequency modulo 1; empty if one is not a multiple."""
    candidates = np.array(sorted(range(-_LARGEST_MULTIPLE, _LARGEST_MULTIPLE + 1), key=abs)[1:])
    apart = lines[:, None] - candidates * frequency
    at = np.abs(apart - np.round(apart)) < AT_MULTIPLE / periods
    return tuple(int(candidates[i]) for i in at.argmax(axis=1)) if at.any(axis=1).all() else ()
