"""Special points of a branch: changes between two neighbouring orbits, enclosed in a narrow interval of the knob.

`KINDS` has all kinds, with their names in AUTO and MatCont.

Each change lies between two computed orbits (docs/branches.md says what the interval is). Test functions only choose
the next orbit to compute, so a wrong test function cannot make an interval wrong.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...errors import ComputationError
from ...former_names import with_former_names
from .axis import KnobAxis
from .between import Between
from .normal_forms import NOT_DECIDED, NormalForm
from .point import CONTACT, OVERLAP, TIME, TURN_SIGN, BranchPoint

_BOTH_KNOBS = "the two orbits' knobs"


@dataclass(frozen=True)
class Kind:
    """A kind of special point: how results, files and JSON spell it, its words, and its names in AUTO and MatCont.

    `passes` is what changes there, `interval` what the stated interval of the knob is.
    """

    name: str
    words: str
    auto: str
    matcont: str
    passes: str
    interval: str = _BOTH_KNOBS


#: All kinds of special points; bifurcations with a normal form come first.
KINDS = (
    Kind("fold", "fold", "LP", "LPC", "a real multiplier passes +1 and the branch turns back in the knob",
         "from the nearer orbit to the farthest point where the tangents of both can meet"),
    Kind("period_doubling", "period doubling", "PD", "PD", "a real multiplier passes −1"),
    Kind("neimark_sacker", "Neimark–Sacker", "TR", "NS", "a complex pair passes the unit circle"),
    Kind("multiplier_one", "multiplier +1 without a fold", "BP", "BPC",
         "a real multiplier passes +1 and the knob does not turn: not classified; it may be a branch point"),
    Kind("grazing", "grazing", "", "", "a contact has one closed or one open interval more, or less, per orbit"),
)
#: The end `merged` of a doubled branch (ends.py), which AUTO and MatCont report as a branch point.
MERGED = Kind("period_doubling", "the end `merged` of a doubled branch", "BP", "BPC",
              "a doubled branch meets its parent: one of its own multipliers passes +1")
SPECIAL_KINDS = tuple(kind.name for kind in KINDS)
#: Where stability changes.
BIFURCATIONS = SPECIAL_KINDS[:3]
_WORDS = {kind.name: kind.words for kind in KINDS}
#: [branch] Width of an interval that is narrow enough, relative to the knob or to a thousandth of the range's larger
#: end.
RELATIVE_WIDTH = 1e-5
#: [branch] The tangents at both ends of a bracket meet within this factor times its length. In a plane it is within
#: once the length where the branch turns by less than 90°, and `_LARGEST_TURN` in steps.py is below that.
_TANGENT_REACH = 1.25
#: [branch] Offset of the next orbit from the root of the straight line through the test function, as a fraction of the
#: bracket.
_OFFSET_FROM_ROOT = 0.02
#: [branch] First part of the offset from the root of the parabola, where a third value is known, as a fraction of the
#: width that is narrow enough.
_WIDTH_FRACTION = 0.4
#: [branch] Second part of that offset, as a fraction of the distance between both roots. The parabola's error is a
#: small fraction of the line's.
_ERROR_FRACTION = 0.1
#: [branch] Levels of bisection from one that takes the middle, whatever the test function says, to the next.
_LEVELS_TO_MIDDLE = 5
#: [branch] Most levels of bisection between two neighbours. The interval is then taken as it is.
_MOST_LEVELS = 60


@with_former_names
@dataclass(frozen=True, eq=False)
class SpecialPoint:
    """A special point: its kind, the interval of the knob that holds it, and the two orbits around it.

    `kind` is one of `SPECIAL_KINDS`, `knob` the middle of the interval.
    `contact` and `gained` belong to a grazing: on the side `gained_side` of it the contact has one `gained` more per
    orbit, a "closed interval" or an "open interval". `multiplier` is the one that passes the unit circle. `normal_form`
    has the criticality and its coefficient; it is None for a grazing, for `multiplier_one`, at the end of a doubled
    branch, and in older files.
    """

    kind: str
    knob: float
    interval: tuple[float, float]
    before: BranchPoint
    after: BranchPoint
    multiplier: complex | None = None
    contact: int | None = None
    gained: str | None = None
    normal_form: NormalForm | None = None

    @property
    def gained_side(self) -> str | None:
        """On which side of `knob` a contact has one `gained` more: "below" or "above"; None where the knob turns."""
        if self.contact is None or self.before.turning != self.after.turning:
            return None
        more, fewer = _more_and_fewer(self.before, self.after, self.contact)
        return None if more.knob == fewer.knob else "below" if more.knob < fewer.knob else "above"

    @property
    def kind_words(self) -> str:
        """The kind in words."""
        return _WORDS[self.kind]

    @property
    def criticality(self) -> str | None:
        """One of `CRITICALITIES` (normal_forms.py); None where there is no normal form."""
        return None if self.normal_form is None else self.normal_form.criticality

    def criticality_words(self) -> str:
        """The criticality, with the reason where it is not decided; "" where there is no normal form."""
        form = self.normal_form
        if form is None or form.criticality != NOT_DECIDED:
            return self.criticality or ""
        return f"{'not known to be nondegenerate' if self.kind == 'fold' else 'criticality not decided'}: {form.reason}"

    @property
    def angle(self) -> float | None:
        """Angle in radians by which the map turns about the orbit, the argument of a Neimark–Sacker multiplier."""
        if self.kind != "neimark_sacker" or self.multiplier is None:
            return None
        return float(np.angle(self.multiplier))


def special_between(between: Between) -> list[SpecialPoint]:
    """All special points between two neighbours, in their order.

    Rough orbits find brackets, whose ends are then computed exactly. Where that fails, or an exact end is not on the
    side of its rough one, all orbits are computed as those of the branch.
    """
    axis, a, b = between.equations.axis, between.a, between.b
    try:
        rough = _brackets(axis, a, b, between)
        brackets = [(between.made_exact(one), between.made_exact(other)) for one, other in rough]
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
    """An interval that holds all knob values between a and b.

    Where the knob turns in between, the curve stays on the inner side of its tangents at a and b.
    """
    low, high = min(a.knob, b.knob), max(a.knob, b.knob)
    if a.turning != b.turning:
        reach = _TANGENT_REACH * _distance(axis, a, b) * min(abs(a.tangent[-1]), abs(b.tangent[-1])) * axis.slope(high)
        return (high, float(high + reach)) if a.turning > 0 else (float(low - reach), low)
    return low, high


def _distance(axis: KnobAxis, a: BranchPoint, b: BranchPoint) -> float:
    """Length of the straight line between two points of the branch."""
    moved = axis.coordinate(b.knob) - axis.coordinate(a.knob)
    return float(np.hypot(np.linalg.norm(b.x - a.x) / np.sqrt(len(a.x)), moved))


def _fraction(axis: KnobAxis, a: BranchPoint, b: BranchPoint, depth: int,
              beyond: BranchPoint | None) -> tuple[float, bool]:
    """Place of the next orbit, as a fraction of the bracket from a to b, and whether to solve it exactly.

    The orbit lies just beyond the estimated root of the test function, on the side of the longer part, so that the
    bracket shrinks from both ends; at times, or without a test function, it is the middle. The first root is that of a
    straight line. With a third value the root is known so well that the orbits on both sides of it are the ends of the
    narrow bracket; these are solved exactly.
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
    """Root of the test function by inverse quadratic interpolation of the arclength, from a (0) to b (1); else None."""
    one, other = (a, beyond) if beyond.arclength > b.arclength else (beyond, b)
    outer = None if one.signature == other.signature else _test_values(one, other)
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
    if a.turning != b.turning:
        return float(a.tangent[-1]), float(b.tangent[-1])
    if a.unstable_multipliers != b.unstable_multipliers:
        k = max(a.unstable_multipliers, b.unstable_multipliers) - 1
        return float(np.log(abs(a.multipliers[k]))), float(np.log(abs(b.multipliers[k])))
    if a.doubling_sign != b.doubling_sign:
        return float(np.prod(1.0 + a.multipliers).real), float(np.prod(1.0 + b.multipliers).real)
    contact = int(np.flatnonzero(a.closings != b.closings)[0])
    return _turning_values(a, b, contact)


def _turning_values(a: BranchPoint, b: BranchPoint, contact: int) -> tuple[float, float] | None:
    """The overlap at the turning point that passes zero, at a and at b; None if it is not found in both."""
    more, fewer = _more_and_fewer(a, b, contact)
    nearest = _slightest_crossing(more, contact)
    if nearest is None:
        return None
    turns = _turns(fewer, contact)
    uncrossed = turns[(turns[:, TURN_SIGN] == nearest[TURN_SIGN]) & (turns[:, OVERLAP] * nearest[OVERLAP] < 0.0)]
    if not len(uncrossed):
        return None
    partner = uncrossed[np.argmin(np.abs(uncrossed[:, TIME] - nearest[TIME]))]
    values = float(nearest[OVERLAP]), float(partner[OVERLAP])
    return values if more is a else values[::-1]


def _slightest_crossing(point: BranchPoint, contact: int) -> np.ndarray | None:
    """The turning point nearest to zero on the side it turns to: a maximum of the overlap above it, or a minimum below.

    Before and after such a turning point the contact closes and opens. None if there is none.
    """
    turns = _turns(point, contact)
    crossed = turns[turns[:, TURN_SIGN] * turns[:, OVERLAP] > 0.0]
    return crossed[np.argmin(np.abs(crossed[:, OVERLAP]))] if len(crossed) else None


def _turns(point: BranchPoint, contact: int) -> np.ndarray:
    """The turning points of one contact's overlap, rows of `BranchPoint.turns`."""
    return point.turns[point.turns[:, CONTACT] == contact]


def _more_and_fewer(a: BranchPoint, b: BranchPoint, contact: int) -> tuple[BranchPoint, BranchPoint]:
    """Of two orbits first the one along which a contact closes more often."""
    return (a, b) if _closings(a, contact) > _closings(b, contact) else (b, a)


def _closings(point: BranchPoint, contact: int) -> int:
    """Number of closings of a contact along the orbit."""
    return max(0, int(point.closings[contact]))


def _classified(axis: KnobAxis, a: BranchPoint, b: BranchPoint) -> list[SpecialPoint]:
    """The special points inside a narrow bracket, usually one."""
    low, high = _interval(axis, a, b)
    special_points = []
    left = _passing(a, b)
    if a.turning != b.turning:
        mine = next((mu for mu in left if mu.imag == 0.0 and mu.real > 0.0), None)
        left = [mu for mu in left if mu is not mine]
        special_points.append(SpecialPoint("fold", 0.5 * (low + high), (low, high), a, b, multiplier=mine))
    interval = min(low, a.knob, b.knob), max(high, a.knob, b.knob)
    knob = 0.5 * (interval[0] + interval[1])
    for mu in left:
        kind = "neimark_sacker" if mu.imag != 0.0 else "fold" if mu.real > 0.0 else "period_doubling"
        special_points.append(SpecialPoint(kind, knob, interval, a, b, multiplier=mu))
    for contact in np.flatnonzero(a.closings != b.closings):
        special_points.append(SpecialPoint("grazing", knob, interval, a, b, contact=int(contact),
                                           gained=_gained(a, b, int(contact))))
    return special_points


def _passing(a: BranchPoint, b: BranchPoint) -> list[complex]:
    """Multipliers that pass the unit circle between a and b; of a complex pair the one above the real axis.

    Of two that pass in opposite directions, one of them through −1, those at a that are nearest to −1 and to +1.
    """
    if a.unstable_multipliers == b.unstable_multipliers and a.doubling_sign != b.doubling_sign:
        real = a.multipliers[a.multipliers.imag == 0.0]
        return [complex(real[np.argmin(np.abs(real - through))]) for through in (-1.0, 1.0)]
    more, fewer = (a, b) if a.unstable_multipliers > b.unstable_multipliers else (b, a)
    passing = more.multipliers[fewer.unstable_multipliers : more.unstable_multipliers]
    return [complex(mu) for mu in passing if mu.imag >= 0.0]


def _gained(a: BranchPoint, b: BranchPoint, contact: int) -> str:
    """Of a contact, the "closed interval" or "open interval" that one of two orbits has and the other has not."""
    more, fewer = _more_and_fewer(a, b, contact)
    if _closings(fewer, contact) == 0:
        return "open interval" if fewer.closings[contact] < 0 else "closed interval"
    nearest = _slightest_crossing(more, contact)
    assert nearest is not None
    return "closed interval" if nearest[TURN_SIGN] > 0.0 else "open interval"


def _merged(special_points: list[SpecialPoint]) -> list[SpecialPoint]:
    """A fold's turning and its multiplier's passage through 1 are one, also where a bracket ended between them.

    A multiplier that passes 1 without a turn is `multiplier_one`.
    """
    merged: list[SpecialPoint] = []
    for one in special_points:
        last = merged[-1] if merged else None
        if last is not None and one.kind == last.kind == "fold" and one.before is last.after \
                and (one.multiplier is None) != (last.multiplier is None):
            turn = one if one.before.turning != one.after.turning else last
            merged[-1] = SpecialPoint("fold", turn.knob, turn.interval, last.before, one.after,
                                      multiplier=one.multiplier or last.multiplier)
        else:
            merged.append(one)
    return [replace(one, kind="multiplier_one")
            if one.kind == "fold" and one.before.turning == one.after.turning else one for one in merged]
