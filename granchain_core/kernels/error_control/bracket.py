"""Roots and maxima of a quantity inside a step, on the dense output.

A quantity is a NamedTuple that specifies an overlap or a force, for example, and has code for `value_at`. Roots are
found by regula falsi with the Illinois modification (the value at the end that stays is halved), maxima by
golden-section search.
"""

from __future__ import annotations

from typing import NamedTuple

from ..compiling.dispatch import by_type
from ..compiling.jit import inline_numba, internal

#: Factor by which each golden section shrinks the bracket.
_RATIO = 0.6180339887498949


class Bracket(NamedTuple):
    """Fractions of a step between which a quantity changes sign, its values there, and the last end moved (−1, 1)."""

    low: float
    high: float
    f_low: float
    f_high: float
    moved: int


@by_type
def value_at(quantity, step, x):
    """A quantity at fraction x of a step."""


@internal
def secant_point(bracket):
    """Zero of the straight line through both ends, or the middle where rounding puts that zero outside."""
    low, high, f_low, f_high, _ = bracket
    x = (low * f_high - high * f_low) / (f_high - f_low)
    return x if low <= x <= high else 0.5 * (low + high)


@internal
def narrowed_to(bracket, x, f):
    """The part of the bracket in which the sign changes, given the value f at x."""
    low, high, f_low, f_high, moved = bracket
    if (f > 0.0) == (f_low > 0.0):
        return Bracket(x, high, f, 0.5 * f_high if moved < 0 else f_high, -1)
    return Bracket(low, x, 0.5 * f_low if moved > 0 else f_low, f, 1)


@inline_numba
def root_inside(quantity, step, bracket, near):
    """Fraction in the bracket at which the quantity changes sign, to about `near`.

    This takes about ten evaluations. If 80 do not suffice, the last estimate is returned.
    """
    x = bracket.high
    for _ in range(80):
        before = x
        x = secant_point(bracket)
        f = value_at(quantity, step, x)
        if f == 0.0 or abs(x - before) < near:
            break
        bracket = narrowed_to(bracket, x, f)
    return x


@internal
def maximum_inside(quantity, step, until, sections):
    """(fraction, value) where the quantity is largest in the step up to fraction `until`, if it has one maximum."""
    low, high = 0.0, until
    a, b = (1.0 - _RATIO) * until, _RATIO * until
    fa, fb = value_at(quantity, step, a), value_at(quantity, step, b)
    for _ in range(sections):
        if fa > fb:
            high, b, fb = b, a, fa
            a = high - _RATIO * (high - low)
            fa = value_at(quantity, step, a)
        else:
            low, a, fa = a, b, fb
            b = low + _RATIO * (high - low)
            fb = value_at(quantity, step, b)
    return 0.5 * (low + high), max(fa, fb)


@inline_numba
def may_turn(d0, s0, d1, s1, sign):
    """Whether an overlap with the same sign at both ends of a step may cross zero in between.

    It must move towards zero at first and away at last, as in `may_change` (rk4/step.py). If it is convex or concave in
    the step, the tangents at both ends bound its approach to zero. An inflection within the step could hide a touch,
    which then remains part of the step's error.
    """
    if not (sign * s0 > 0.0 and sign * s1 < 0.0):
        return False
    reach = max(sign * (d0 + s0), sign * (d1 - s1))
    return reach > 0.0
