"""Quantities inside a step, on its dense output: an overlap or q, and the time; their zeros and maxima."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.jit import internal
from ..dop853.step import interpolant
from ..effects.preload import overlap
from ..error_control.bracket import maximum_inside, value_at
from ..error_control.step import TURN_SECTIONS

#: The search for a zero ends when the fraction of the step changes by less than this; the next change would be far
#: smaller.
_CHECKED_CHANGE = 1e-9


class Polynomial(NamedTuple):
    """One quantity of the dense output, times a sign: its seven rows, then its value at the start (8,)."""

    coefficients: np.ndarray
    sign: float


@internal
def load_distance(slots, work, contact, is_target, sign):
    """Load a contact's overlap (q for the target of the time transformation), times a sign, into the polynomial."""
    p, start, dense = work.polynomial, work.start, work.dense
    if is_target:
        p[7] = sign * start.q[0, 0]
        for k in range(7):
            p[k] = sign * dense.q[k, 0]
    else:
        p[7] = sign * overlap(slots.preload, start.u[0], contact)
        for k in range(7):
            p[k] = sign * (dense.u[k, contact] - dense.u[k, contact + 1])


@internal
def load_time(work, instant):
    """Load the time since an instant into the polynomial."""
    work.polynomial[7] = work.start.t[0, 0] - instant
    for k in range(7):
        work.polynomial[k] = work.dense.t[k, 0]


@internal
def polynomial_at(p, x):
    """The polynomial at fraction x of the step."""
    return interpolant(p[7], p, x)


@value_at.of(Polynomial)
def _(quantity, step, x):
    return quantity.sign * polynomial_at(quantity.coefficients, x)


@internal
def zero_between(p, low, high, f_low, f_high):
    """Where the polynomial passes from f_low < 0 to f_high > 0: by secants, or by halving if one leaves the bracket.

    This takes fewer evaluations than `root_inside` (error_control/bracket.py), which halves the value at the end that
    stays. If 60 do not suffice, the last estimate is returned.
    """
    last, x, f_last, f = low, high, f_low, f_high
    for _ in range(60):
        nearer = x - f * (x - last) / (f - f_last)
        if not low <= nearer <= high:
            nearer = 0.5 * (low + high)
        last, f_last, x = x, f, nearer
        f = polynomial_at(p, x)
        if f > 0.0:
            high = x
        else:
            low = x
        if f == f_last or abs(x - last) < _CHECKED_CHANGE:
            break
    return x


@internal
def turn_of(p, sign):
    """Return (fraction, value) where the polynomial times `sign` is largest, if it has one maximum in the step."""
    return maximum_inside(Polynomial(p, sign), None, 1.0, TURN_SECTIONS)


@internal
def time_inside(work, x):
    """The time at fraction x of the step."""
    load_time(work, 0.0)
    return polynomial_at(work.polynomial, x)


@internal
def fraction_at(work, instant, high):
    """Fraction of the step, up to `high`, at which the time is `instant`."""
    load_time(work, instant)
    first, last = work.polynomial[7], polynomial_at(work.polynomial, high)
    if first >= 0.0:
        return 0.0
    return high if last <= 0.0 else zero_between(work.polynomial, 0.0, high, first, last)


@internal
def change_before(p, falls, high):
    """Fraction up to `high` at which a distance becomes positive; 0 if it is so at the start, unless it `falls`.

    A distance that falls at first can only become positive after its minimum. For a contact that has just changed, it
    is zero at the start except for rounding, which may have either sign and would be mistaken for the root.
    """
    low, before = 0.0, p[7]
    if falls:
        low, lowest = turn_of(p, -1.0)
        before = -lowest
    if before >= 0.0 or low >= high:
        return 0.0
    return zero_between(p, low, high, before, polynomial_at(p, high))
