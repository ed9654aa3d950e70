"""The first contact event within a step, and the initial mode of every contact."""

from __future__ import annotations

import numpy as np

from .step import NET_FORCE, OPEN, SLACK, gap_and_rate, gap_and_rate_of, jit

#: Intervals of a step at whose ends contacts are examined; turning points within them are searched for as well.
_LOOKS = 8
#: Error of an overlap by rounding, relative to the displacements.
_ROUNDING = 4e-16
_HALVINGS = 60
#: The watched quantities: the overlap and, if tension is cut, the law's force. An event is a zero of one of them.
OVERLAP, FORCE = 0, 1


@jit
def _power_force(law, c, gap, rate):
    """Return the law's force over the power of the overlap in g, which is smooth with a nonzero slope at its zero."""
    d = max(gap, 0.0)
    return law.stiffness[c] * d ** (1.5 - 0.25 * law.power) + law.strength * rate


@jit
def _watched(law, c, what, gap, rate):
    return gap if what == OVERLAP else _power_force(law, c, gap, rate)


@jit
def _rounding(law, y, c, what):
    """Return the size below which a watched value is only rounding."""
    n = law.inverse_mass.size
    u = 1.0 if c == 0 else abs(y[c - 1])
    v = law.beta if c == 0 else abs(y[n + c - 1])
    if c < n:
        u, v = u + abs(y[c]), v + abs(y[n + c])
    if what == OVERLAP:
        return _ROUNDING * (u + abs(law.static[c])) + 1e-300
    return _ROUNDING * (law.stiffness[c] * (u + abs(law.static[c])) + law.strength * v) + 1e-300


@jit
def _least(law, y, scale, c, what):
    """Return the size below which a watched value is only rounding or within the error allowed in a step."""
    n = law.inverse_mass.size
    u = (scale[c - 1] if c > 0 else 0.0) + (scale[c] if c < n else 0.0)
    v = (scale[n + c - 1] if c > 0 else 0.0) + (scale[n + c] if c < n else 0.0)
    return _rounding(law, y, c, what) + (u if what == OVERLAP else law.stiffness[c] * u + law.strength * v)


@jit
def _sign(law, state, what):
    """Return +1 if an event makes the quantity positive, −1 if negative, 0 if it is not watched."""
    if what == OVERLAP:
        if state == OPEN:
            return 1.0
        return -1.0 if state == SLACK or not law.cut else 0.0
    if not law.cut or state == OPEN:
        return 0.0
    return 1.0 if state == SLACK else -1.0


@jit
def _value(law, t, y, h, f, c, what, sign, x):
    gap, rate = gap_and_rate(law, t, y, h, f, c, x)
    return sign * _watched(law, c, what, gap, rate)


@jit
def _turn(law, t, y, h, f, c, what, sign, a, b):
    """Return where the value is largest between a and b, by golden-section search; stop early where it is positive."""
    part = 0.5 * (np.sqrt(5.0) - 1.0)
    left, right = b - part * (b - a), a + part * (b - a)
    at_left = _value(law, t, y, h, f, c, what, sign, left)
    at_right = _value(law, t, y, h, f, c, what, sign, right)
    for _ in range(_HALVINGS):
        if at_left > 0.0:
            return left
        if at_right > 0.0:
            return right
        if at_left > at_right:
            b, right, at_right = right, left, at_left
            left = b - part * (b - a)
            at_left = _value(law, t, y, h, f, c, what, sign, left)
        else:
            a, left, at_left = left, right, at_right
            right = a + part * (b - a)
            at_right = _value(law, t, y, h, f, c, what, sign, right)
        if b - a < 1e-8:
            break
    return 0.5 * (a + b)


@jit
def _root(law, t, y, h, f, c, what, sign, a, b):
    """Return the zero between a, where the value is not positive, and b, where it is."""
    if _value(law, t, y, h, f, c, what, sign, a) >= 0.0:
        return a
    for _ in range(_HALVINGS):
        middle = 0.5 * (a + b)
        if _value(law, t, y, h, f, c, what, sign, middle) > 0.0:
            b = middle
        else:
            a = middle
        if b - a < 1e-15:
            break
    return b


@jit
def _crossing(law, t, y, scale, h, f, c, what, sign, until):
    """Return the first place up to `until` where the value becomes positive by more than rounding; 2.0 if none."""
    least = _least(law, y, scale, c, what)
    values = np.empty(_LOOKS + 1)
    for i in range(_LOOKS + 1):
        values[i] = _value(law, t, y, h, f, c, what, sign, until * i / _LOOKS)
    for i in range(_LOOKS + 1):
        low, high = max(i - 1, 0), min(i + 1, _LOOKS)
        if values[i] > least:
            return _root(law, t, y, h, f, c, what, sign, until * low / _LOOKS, until * i / _LOOKS)
        if values[i] < values[low] or values[i] < values[high]:
            continue
        if values[i] + 2.0 * max(values[i] - values[low], values[i] - values[high]) > least:
            top = _turn(law, t, y, h, f, c, what, sign, until * low / _LOOKS, until * high / _LOOKS)
            if _value(law, t, y, h, f, c, what, sign, top) > least:
                return _root(law, t, y, h, f, c, what, sign, until * low / _LOOKS, top)
    return 2.0


@jit
def _far(law, t, y, h, f, c, sign):
    """Return whether the overlap is too far from zero, at its rate, to reach it within the step."""
    near, fast = -np.inf, 0.0
    for i in range(3):
        gap, rate = gap_and_rate(law, t, y, h, f, c, 0.5 * i)
        near, fast = max(near, sign * gap), max(fast, abs(rate))
    return near + h * fast < 0.0


@jit
def first_event(law, mode, t, y, scale, h, f):
    """Return the first event in the step from y: its place (2.0 if there is none), contact and watched quantity."""
    where, contact, becomes = 2.0, -1, OVERLAP
    for c in range(mode.size):
        for what in range(2):
            sign = _sign(law, mode[c], what)
            if sign == 0.0 or (what == OVERLAP and _far(law, t, y, h, f, c, sign)):
                continue
            x = _crossing(law, t, y, scale, h, f, c, what, sign, min(where, 1.0))
            if x < where:
                where, contact, becomes = x, c, what
    return where, contact, becomes


@jit
def missing(law, mode, t, y, h, f, end, c, what):
    """Return by how much the step h must be lengthened for the watched quantity of contact c to be zero at its end; 0
    if it is as near to zero as rounding allows.
    """
    sign = _sign(law, mode[c], what)
    gap, rate = gap_and_rate_of(law, t + h, end, c)
    value = _watched(law, c, what, gap, rate)
    if abs(value) <= 0.5 * _rounding(law, y, c, what):
        return 0.0
    change = rate
    if what == FORCE:
        near = 1e-4
        change = sign * (_value(law, t, y, h, f, c, what, sign, 1.0) -
                         _value(law, t, y, h, f, c, what, sign, 1.0 - near)) / (near * h)
    return 0.0 if abs(change) * h <= abs(value) * 10.0 else -value / change


@jit
def after(law, mode, c, what):
    """Return the mode of contact c after its event."""
    if what == FORCE:
        return NET_FORCE if mode[c] == SLACK else SLACK
    return NET_FORCE if mode[c] == OPEN else OPEN


@jit
def begin(law, mode, t, y):
    """Set the mode of each contact for a state; a contact with overlap zero counts as closed unless it is opening."""
    for c in range(mode.size):
        gap, rate = gap_and_rate_of(law, t, y, c)
        least = _rounding(law, y, c, OVERLAP)
        if gap < -least or (gap <= least and rate < 0.0):
            mode[c] = OPEN
        else:
            mode[c] = SLACK if law.cut and _power_force(law, c, gap, rate) < 0.0 else NET_FORCE
