"""Peaks and dips of a resonance curve, by prominence: the paper's resonances and anti-resonances."""

from __future__ import annotations

from itertools import pairwise

from ..steady.curve.curve import Curve, CurvePoint
from ..steady.curve.resonance import peaks_and_valleys


def turning_points(curve: Curve) -> tuple[list[CurvePoint], list[CurvePoint]]:
    """Return peaks and dips of the elastic output force, excluding the curve's ends."""
    high, low = peaks_and_valleys(curve.column("max_output_force_elastic"))
    return [curve.points[i] for i in high], [curve.points[i] for i in low]


def peaks(curve: Curve) -> list[CurvePoint]:
    """Return the resonances: peaks at which the motion is periodic."""
    return [p for p in turning_points(curve)[0] if p.regime.period is not None]


def dips(curve: Curve) -> list[CurvePoint]:
    """Return the first dip after each resonance except the last."""
    tops = [p.frequency for p in peaks(curve)]
    lowest = []
    for low, high in pairwise(tops):
        between = [p for p in turning_points(curve)[1] if low < p.frequency < high]
        lowest.append(between[0])
    return lowest
