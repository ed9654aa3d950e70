"""Gaps in a series of samples: their definition, and the ways to treat them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput

#: A spacing of more than this factor times the median spacing is a gap.
GAP = 1.5
#: Ways to treat gaps: refuse them, set the quantity to zero in them, or interpolate across them.
GAPS = ("refuse", "zero", "interpolate")
#: Zeros inserted into a gap begin and end at most this fraction of the gap away from the neighbouring samples.
_PART_OF_GAP = 0.4


def sample_number(index: int) -> str:
    """Return the place of a sample, for messages on samples that do not come from a file."""
    return f"Sample {index}"


@dataclass(frozen=True, eq=False)
class Gaps:
    """Gaps between samples at ascending times.

    Attributes
    ----------
    before : numpy.ndarray of int, shape (G,)
        Index of the last sample before each gap.
    usual : float
        The usual spacing [s].
    since : float
        Time at which the first gap starts [s].
    where : str
        The first gap in words, with its place in the source.
    """

    before: np.ndarray
    usual: float
    since: float
    where: str

    @classmethod
    def of(cls, time: np.ndarray, place: Callable[[int], str] = sample_number) -> Gaps:
        """Return the gaps of samples at these times (T,) [s]; `place` gives the place of a sample in its source."""
        steps = np.diff(time)
        usual = float(np.median(steps))
        before = np.flatnonzero(steps > GAP * usual)
        at = int(before[0]) if len(before) else 0
        return cls(before, usual, float(time[at]), f"{place(at + 1)}: {steps[at]:.4g} s after the sample before, "
                                                   f"where {usual:.4g} s is usual")

    def treated(self, gap: str, across: str, quantity: str = "") -> str:
        """Describe what the choice `gap` does; empty without gaps. Raises `BadInput` if it refuses gaps or is unknown.

        `across` describes the interpolation. `quantity` is the quantity that "zero" sets to zero; without it, this
        choice is refused.
        """
        if gap not in GAPS:
            raise BadInput(f"gap {str(gap)[:30]!r} is not one of {', '.join(GAPS)}.")
        count = len(self.before)
        if not count:
            return ""
        if gap == "refuse" or (gap == "zero" and not quantity):
            others = f" (and {count - 1} more)" if count > 1 else ""
            zero = f"zero (no {quantity} in it) or " if quantity else ""
            raise BadInput(f"{self.where}: a gap{others}; choose {zero}interpolate ({across}).")
        what = f"taken as zero {quantity}" if gap == "zero" else "interpolated"
        return f"{count} gap{'s' if count > 1 else ''} {what}, the first at {self.since:.6g} s"


def with_zeros(time: np.ndarray, values: np.ndarray, gaps: np.ndarray,
               spacing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Insert zeros into the gaps after the samples `gaps`, a spacing from their ends; return the zeros' indices too."""
    beside = np.minimum(spacing, _PART_OF_GAP * (time[gaps + 1] - time[gaps]))
    inside = np.sort(np.concatenate([time[gaps] + beside, time[gaps + 1] - beside]))
    places = np.searchsorted(time, inside)
    return np.insert(time, places, inside), np.insert(values, places, 0.0), places + np.arange(len(places))
