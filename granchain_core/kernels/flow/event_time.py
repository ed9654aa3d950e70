"""A time variable in which the motion next to a contact event is smooth: a root of the time from the event.

After a contact closes at t_e, its overlap grows as t − t_e and its elastic force as the power 3/2 of that, so the
motion has no Taylor series in t there. It has one in s, where

    t = t_e + s^p  after a closing,    t = t_e − s^p  before an opening,    p = 2

and p = 4 for damping ∝ δ^{1/4}, δ^{3/4} or δ^{5/4}, where the power of G is a multiple of 1/4. A Dormand–Prince step
that begins at an event can then be as long as any other, for motion and tangents alike. In t, error control would need
tiny steps there.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from ..compiling.dispatch import by_slot
from ..compiling.jit import internal
from ..effects.dissipation import LAWS, exponent
from ..error_control.step import evaluate

#: Kinds of time: after a closing, plain, before an opening.
AFTER, PLAIN, BEFORE = 1, 0, -1


class TimeTransform(NamedTuple):
    """The transformed time s of a step from `start`, next to `event`: its value `s` at the start, and p, the `power`.

    `ds` below is the magnitude of the change of s since the start. If the kind is `PLAIN`, s is t.
    """

    kind: int
    event: float
    start: float
    s: float
    power: int


@by_slot
def smooth_power(dissipation):
    """Return the power p for which motion and tangents next to an event are smooth in s."""
    return 2


@smooth_power.of(*LAWS)
def _(dissipation):
    twice = 2.0 * exponent(dissipation)
    return 2 if twice == int(twice) else 4


@internal
def nonnegative_root(value, power):
    """The p-th root of a value, or 0 where rounding has made it negative."""
    if value <= 0.0:
        return 0.0
    return sqrt(value) if power == 2 else sqrt(sqrt(value))


@internal
def transform_from(kind, event, start, power):
    """Return the time transformation of a step from `start`, next to `event`."""
    return TimeTransform(kind, event, start, nonnegative_root(kind * (start - event), power), power)


@internal
def t_at(transform, ds):
    """The time t after s has changed by ds."""
    if transform.kind == PLAIN:
        return transform.start + ds
    s = transform.s + transform.kind * ds
    s *= s
    if transform.power == 4:
        s *= s
    return transform.event + transform.kind * s


@internal
def dt_ds_at(transform, ds):
    """|dt/ds| after s has changed by ds."""
    if transform.kind == PLAIN:
        return 1.0
    s = transform.s + transform.kind * ds
    return 2.0 * s if transform.power == 2 else 4.0 * s * s * s


@internal
def size_in_s(transform, dt):
    """The change ds after which dt has passed since the step's start."""
    if transform.kind == PLAIN:
        return dt
    distance = transform.kind * (transform.start + dt - transform.event)
    return transform.kind * (nonnegative_root(distance, transform.power) - transform.s)


@internal
def slope_in_s(slots, beta, transform, ds, state, row, workspace):
    """Compute slope `row` in s, at `state`; leave the slope in t in workspace.slope."""
    evaluate(slots, beta, t_at(transform, ds), state, workspace.slope, workspace.forces)
    dt_ds = dt_ds_at(transform, ds)
    for i in range(state.size):
        workspace.k[row, i] = dt_ds * workspace.slope[i]
