"""Time as a power of the distance from a contact event, in which the motion next to it is smooth.

After the closing t_e of a contact the overlap grows as t − t_e and the elastic force as its power 3/2, so the motion
has no Taylor series in t there. It has one in s, where

    t = t_e + s^p  after a closing,    t = t_e − s^p  before an opening,    p = 2

and p = 4 for damping ∝ δ^{1/4}, δ^{3/4} or δ^{5/4}, whose G grows as a power with quarters. A step of Dormand and
Prince that begins at an event is then as long as anywhere else, for motion and tangents alike. In t, error control
would need tiny steps there.
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


class Time(NamedTuple):
    """The transformed time s of a step from `start`, next to `event`: its value `s` at the start, and p, the `power`.

    `ds` below is by how much s has changed since the start, without its sign; where the kind is `PLAIN`, s is t.
    """

    kind: int
    event: float
    start: float
    s: float
    power: int


@by_slot
def smooth_power(dissipation):
    """The power p for which motion and tangents next to an event are smooth in s."""
    return 2


@smooth_power.of(*LAWS)
def _(dissipation):
    twice = 2.0 * exponent(dissipation)
    return 2 if twice == int(twice) else 4


@internal
def nonnegative_root(value, power):
    """The p-th root of a value, 0 where rounding made it negative."""
    if value <= 0.0:
        return 0.0
    return sqrt(value) if power == 2 else sqrt(sqrt(value))


@internal
def time_from(kind, event, start, power):
    """The time transformation of a step from `start`, next to `event`."""
    return Time(kind, event, start, nonnegative_root(kind * (start - event), power), power)


@internal
def time_at(time, ds):
    """The time t after a change ds."""
    if time.kind == PLAIN:
        return time.start + ds
    s = time.s + time.kind * ds
    s *= s
    if time.power == 4:
        s *= s
    return time.event + time.kind * s


@internal
def dt_ds_at(time, ds):
    """|dt/ds| after a change ds."""
    if time.kind == PLAIN:
        return 1.0
    s = time.s + time.kind * ds
    return 2.0 * s if time.power == 2 else 4.0 * s * s * s


@internal
def size_of(time, dt):
    """The ds after which dt has passed since the step's start."""
    if time.kind == PLAIN:
        return dt
    distance = time.kind * (time.start + dt - time.event)
    return time.kind * (nonnegative_root(distance, time.power) - time.s)


@internal
def slope_in_s(slots, beta, time, ds, state, row, workspace):
    """Slope `row` in s, at `state`; the slope in t is left in workspace.slope."""
    evaluate(slots, beta, time_at(time, ds), state, workspace.slope, workspace.forces)
    dt_ds = dt_ds_at(time, ds)
    for i in range(state.size):
        workspace.k[row, i] = dt_ds * workspace.slope[i]
