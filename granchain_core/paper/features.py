"""The peaks and dips of a resonance curve by prominence, and where it stays low."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..steady.curve import Curve, CurvePoint
from ..steady.resonance import extrema


def turning_points(curve: Curve) -> tuple[list[CurvePoint], list[CurvePoint]]:
    """Peaks and dips of the elastic output force, without the curve's ends."""
    force = curve.column("max_output_force_elastic")
    turns = extrema(np.asarray(force, dtype=float))
    high: list[CurvePoint] = []
    low: list[CurvePoint] = []
    for before, here in pairwise(turns[:-1]):
        (high if force[here] > force[before] else low).append(curve.points[here])
    return high, low


def peaks(curve: Curve) -> list[CurvePoint]:
    """Resonances: peaks on which the motion is periodic."""
    return [p for p in turning_points(curve)[0] if p.regime.period is not None]


def dips(curve: Curve) -> list[CurvePoint]:
    """The first dip after each resonance but the last."""
    tops = [p.frequency for p in peaks(curve)]
    found = []
    for low, high in pairwise(tops):
        between = [p for p in turning_points(curve)[1] if low < p.frequency < high]
        found.append(between[0])
    return found
