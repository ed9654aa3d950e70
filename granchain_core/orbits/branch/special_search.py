"""The search for special points of a branch: changes between neighbouring orbits, enclosed in a narrow interval.

Each change lies between two computed orbits (docs/branches.md defines the interval). Test functions only choose the
next orbit to compute, so a wrong test function cannot make an interval wrong.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...errors import ComputationError
from .axis import KnobAxis
from .between import Between
from .point import CONTACT, EXTREMUM_SIGN, OVERLAP, TIME, BranchPoint
from .special import SpecialPoint, closings_of, more_and_fewer

#: [branch] Width at which an interval is narrow enough, relative to the knob or to a thousandth of the range's larger
#: end.
RELATIVE_WIDTH = 1e-5
#: [branch] The tangents at both ends of a bracket meet within this factor times its length. In a plane, they meet
#: within one length if the branch turns by less than 90°, and `_LARGEST_TURN` in steps.py is below that.
_TANGENT_REACH = 1.25
#: [branch] Offset of the next orbit from the root of the straight line through the test function, as a fraction of the
#: bracket.
_OFFSET_FROM_ROOT = 0.02
#: [branch] First part of the offset from the root by inverse quadratic interpolation, where a third value is known, as
#: a fraction of the width at which the interval is narrow enough.
_WIDTH_FRACTION = 0.4
#: [branch] Second part of that offset, as a fraction of the distance between the linear and the inverse quadratic
#: estimate. The latter's error is a small fraction of the former's.
_ERROR_FRACTION = 0.1
#: [branch] Interval, in levels of subdivision, at which the middle is used whatever the test function says.
_LEVELS_TO_MIDDLE = 5
#: [branch] Maximum number of levels of subdivision between two neighbours. The interval is then accepted at its width.
_MOST_LEVELS = 60


def special_between(between: Between) -> list[SpecialPoint]:
    """Find all special points between two neighbours, in their order.

    Brackets are found with rough orbits, and their ends are then computed exactly. If that fails, or if an exact end is
    on another side than its rough one, all orbits are computed as carefully as those of the branch.
    """
    axis, a, b = between.equations.axis, between.a, between.b
    try:
        rough = _brackets(axis, a, b, between)
        brackets = [(between.made_exact(before), between.made_exact(after)) for before, after in rough]
        kept = all(rough_end.signature == end.signature for pair, exact in zip(rough, brackets, strict=True)
                   for rough_end, end in zip(pair, exact, strict=True))
    except ComputationError:
        kept = False
    if not kept:
        brackets = _brackets(axis, a, b, between, careful=True)
    special_points = [special for bracket in brackets for special in _classified(axis, *bracket)]
    return _merged(special_points)


def _brackets(axis: KnobAxis, a: BranchPoint, b: BranchPoint, between: Between, depth: int = 0,
              beyond: BranchPoint | None = None, careful: bool = False) -> list[tuple[BranchPoint, BranchPoint]]:
    """Narrow brackets of all changes between a and b; `beyond` is an orbit outside, next to a or to b."""
    if a.signature == b.signature:
        return []
    if _narrow(axis, a, b) or depth >= _MOST_LEVELS:
        return [(a, b)]
    fraction, is_end = _fraction(axis, a, b, depth, beyond)
    middle = (between.careful if careful else between.exact if is_end else between.rough)(a, b, fraction)
    return [*_brackets(axis, a, middle, between, depth + 1, b, careful),
            *_brackets(axis, middle, b, between, depth + 1, a, careful)]


def _narrow(axis: KnobAxis, a: BranchPoint, b: BranchPoint) -> bool:
    return _width(axis, a, b) <= _wanted(axis, a, b)


def _width(axis: KnobAxis, a: BranchPoint, b: BranchPoint) -> float:
    low, high = _interval(axis, a, b)
    return max(high, a.knob, b.knob) - min(low, a.knob, b.knob)


def _wanted(axis: KnobAxis, a: BranchPoint, b: BranchPoint) -> float:
    return RELATIVE_WIDTH * max(abs(a.knob), abs(b.knob), 1e-3 * axis.high)


def _interval(axis: KnobAxis, a: BranchPoint, b: BranchPoint) -> tuple[float, float]:
    """An interval that contains all knob values between a and b.

    Where the knob turns in between, the curve stays on the inner side of its tangents at a and b.
    """
    low, high = min(a.knob, b.knob), max(a.knob, b.knob)
    if a.knob_direction != b.knob_direction:
        reach = _TANGENT_REACH * _distance(axis, a, b) * min(abs(a.tangent[-1]), abs(b.tangent[-1])) * axis.slope(high)
        return (high, float(high + reach)) if a.knob_direction > 0 else (float(low - reach), low)
    return low, high


def _distance(axis: KnobAxis, a: BranchPoint, b: BranchPoint) -> float:
    """Length of the straight line between two points of the branch."""
    along_knob = axis.coordinate(b.knob) - axis.coordinate(a.knob)
    return float(np.hypot(np.linalg.norm(b.x - a.x) / np.sqrt(len(a.x)), along_knob))


def _fraction(axis: KnobAxis, a: BranchPoint, b: BranchPoint, depth: int,
              beyond: BranchPoint | None) -> tuple[float, bool]:
    """Place of the next orbit, as a fraction of the bracket from a to b, and whether to compute it exactly.

    The orbit is just beyond the estimated root of the test function, on the side of the longer part, so that the
    bracket shrinks from both ends; now and then, or without a test function, it is in the middle. The first estimate is
    the root of a straight line. With a third value the root is known so well that the orbits on both sides of it are
    the ends of the narrow bracket; these are computed exactly.
    """
    values = _test_values(a, b)
    if depth % _LEVELS_TO_MIDDLE == _LEVELS_TO_MIDDLE - 1 or values is None or not values[0] * values[1] < 0.0:
        return 0.5, False
    root, beside, is_end = values[0] / (values[0] - values[1]), _OFFSET_FROM_ROOT, False
    better = None if beyond is None else _inverse_quadratic_root(a, b, values, beyond)
    if better is not None:
        near, unsure = _WIDTH_FRACTION * _wanted(axis, a, b) / _width(axis, a, b), _ERROR_FRACTION * abs(better - root)
        root, beside, is_end = better, min(near + unsure, _OFFSET_FROM_ROOT), unsure <= 0.5 * near
    fraction = root + beside if root < 0.5 else root - beside
    return min(max(fraction, 0.5 * beside), 1.0 - 0.5 * beside), is_end


def _inverse_quadratic_root(a: BranchPoint, b: BranchPoint, values: tuple[float, float],
                            beyond: BranchPoint) -> float | None:
    """Root of the test function by inverse quadratic interpolation, from a (0) to b (1); None if there is none."""
    first, last = (a, beyond) if beyond.arclength > b.arclength else (beyond, b)
    outer = None if first.signature == last.signature else _test_values(first, last)
    if outer is None:
        return None
    value = outer[1] if outer[0] == values[0] else outer[0] if outer[1] == values[1] else np.nan
    length, (f, g) = b.arclength - a.arclength, values
    if length == 0.0 or not np.isfinite(value) or value in (f, g):
        return None
    place = (beyond.arclength - a.arclength) / length
    root = float(f * value / ((g - f) * (g - value)) + place * f * g / ((value - f) * (value - g)))
    return root if 0.0 < root < 1.0 else None


def _test_values(a: BranchPoint, b: BranchPoint) -> tuple[float, float] | None:
    if a.knob_direction != b.knob_direction:
        return float(a.tangent[-1]), float(b.tangent[-1])
    if a.unstable_multipliers != b.unstable_multipliers:
        k = max(a.unstable_multipliers, b.unstable_multipliers) - 1
        return float(np.log(abs(a.multipliers[k]))), float(np.log(abs(b.multipliers[k])))
    if a.doubling_sign != b.doubling_sign:
        return float(np.prod(1.0 + a.multipliers).real), float(np.prod(1.0 + b.multipliers).real)
    contact = int(np.flatnonzero(a.closings != b.closings)[0])
    return _extremal_overlaps(a, b, contact)


def _extremal_overlaps(a: BranchPoint, b: BranchPoint, contact: int) -> tuple[float, float] | None:
    """The extremum of the overlap that passes zero between a and b, at both; None if it is not found at one."""
    more, fewer = more_and_fewer(a, b, contact)
    nearest = _slightest_crossing(more, contact)
    if nearest is None:
        return None
    extrema = _extrema(fewer, contact)
    alike = extrema[extrema[:, EXTREMUM_SIGN] == nearest[EXTREMUM_SIGN]]
    uncrossed = alike[alike[:, OVERLAP] * nearest[OVERLAP] < 0.0]
    if not len(uncrossed):
        return None
    partner = uncrossed[np.argmin(np.abs(uncrossed[:, TIME] - nearest[TIME]))]
    values = float(nearest[OVERLAP]), float(partner[OVERLAP])
    return values if more is a else values[::-1]


def _slightest_crossing(point: BranchPoint, contact: int) -> np.ndarray | None:
    """The extremum of the overlap that is nearest to zero, among the maxima above zero and the minima below.

    Before and after such an extremum, the contact closes and opens. None if there is no such extremum.
    """
    extrema = _extrema(point, contact)
    crossed = extrema[extrema[:, EXTREMUM_SIGN] * extrema[:, OVERLAP] > 0.0]
    return crossed[np.argmin(np.abs(crossed[:, OVERLAP]))] if len(crossed) else None


def _extrema(point: BranchPoint, contact: int) -> np.ndarray:
    """The extrema of one contact's overlap, rows of `BranchPoint.overlap_extrema`."""
    return point.overlap_extrema[point.overlap_extrema[:, CONTACT] == contact]


def _classified(axis: KnobAxis, a: BranchPoint, b: BranchPoint) -> list[SpecialPoint]:
    """The special points inside a narrow bracket, usually just one."""
    low, high = _interval(axis, a, b)
    special_points = []
    passing = _passing(a, b)
    if a.knob_direction != b.knob_direction:
        through_one = next((mu for mu in passing if mu.imag == 0.0 and mu.real > 0.0), None)
        passing = [mu for mu in passing if mu is not through_one]
        special_points.append(SpecialPoint("fold", knob=0.5 * (low + high), interval=(low, high), before=a, after=b,
                                           multiplier=through_one))
    interval = min(low, a.knob, b.knob), max(high, a.knob, b.knob)
    knob = 0.5 * (interval[0] + interval[1])
    for mu in passing:
        kind = "neimark_sacker" if mu.imag != 0.0 else "multiplier_one" if mu.real > 0.0 else "period_doubling"
        special_points.append(SpecialPoint(kind, knob=knob, interval=interval, before=a, after=b, multiplier=mu))
    for contact in np.flatnonzero(a.closings != b.closings):
        special_points.append(SpecialPoint("grazing", knob=knob, interval=interval, before=a, after=b,
                                           contact=int(contact), gained=_gained(a, b, int(contact))))
    return special_points


def _passing(a: BranchPoint, b: BranchPoint) -> list[complex]:
    """Multipliers that pass the unit circle between a and b; of a complex pair, the one above the real axis.

    If two pass in opposite directions, one of them through −1, these are the multipliers at a nearest to −1 and to +1.
    """
    if a.unstable_multipliers == b.unstable_multipliers and a.doubling_sign != b.doubling_sign:
        real = a.multipliers[a.multipliers.imag == 0.0]
        return [complex(real[np.argmin(np.abs(real - through))]) for through in (-1.0, 1.0)]
    more, fewer = (a, b) if a.unstable_multipliers > b.unstable_multipliers else (b, a)
    passing = more.multipliers[fewer.unstable_multipliers : more.unstable_multipliers]
    return [complex(mu) for mu in passing if mu.imag >= 0.0]


def _gained(a: BranchPoint, b: BranchPoint, contact: int) -> str:
    """The kind of interval, a key of `EVENTS`, of which a contact has one more along one of two orbits."""
    more, fewer = more_and_fewer(a, b, contact)
    if closings_of(fewer, contact) == 0:
        return "open interval" if fewer.closings[contact] < 0 else "closed interval"
    nearest = _slightest_crossing(more, contact)
    assert nearest is not None
    return "closed interval" if nearest[EXTREMUM_SIGN] > 0.0 else "open interval"


def _merged(special_points: list[SpecialPoint]) -> list[SpecialPoint]:
    """The special points, with the turn of a fold and the passage of its multiplier through 1 joined to one point.

    They are two points, a fold without a multiplier and a `multiplier_one`, if a bracket ended between them.
    """
    merged: list[SpecialPoint] = []
    for point in special_points:
        last = merged[-1] if merged else None
        turn, passage = (last, point) if point.kind == "multiplier_one" else (point, last)
        if last is not None and turn is not None and passage is not None and point.before is last.after \
                and (turn.kind, passage.kind) == ("fold", "multiplier_one") and turn.multiplier is None:
            merged[-1] = replace(turn, before=last.before, after=point.after, multiplier=passage.multiplier)
        else:
            merged.append(point)
    return merged
