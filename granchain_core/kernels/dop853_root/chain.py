"""A short chain in vectors, in a transformed time ξ in which the motion next to one contact's event is smooth.

After an onset at t_e the overlap of contact c grows as t − t_e and its force as the power 3/2, so the motion has no
Taylor series in t there; the same holds before a release. It has one in ξ, with

    q = δ_c^{1/p},    dt/dξ = q^{p−1},    dq/dξ = δ̇_c/p

and p as in flow/event_time.py. q and t are integrated along with the chain, and the forces of contact c are powers of
q. At a release q passes through zero with everything else smooth, so that a step may go beyond the release, which is
then a root on the step's dense output: nothing is repeated. Contacts that are open stay so within a step, for the same
reason. Far from events ξ is the time.

Lane 0 is the driver, which moves as an oscillator: no stage needs a sine.
"""

from __future__ import annotations

from math import copysign
from typing import Any, NamedTuple

import numpy as np

from ..compiling.jit import inline_llvm
from ..effects.contact import positive_part
from ..effects.dissipation import unit_primitive
from ..effects.driver import driver_acceleration
from ..effects.preload import row_overlap
from ..equations.body_forces import force_on_bead
from ..flow.event_time import smooth_power
from ..rk4.short_chain import chain_velocity
from ..simd.functions import root
from ..simd.sums import only_lane
from ..simd.vector import at, blank, from_left, from_right, store, with_first

#: Lane of the clock that holds q; all others hold t, and `TIME` is the first of them.
ROOT, TIME = range(2)
#: Rows of the workspace's state, and their number.
DISPLACEMENT, VELOCITY, ELASTIC, W, STATE_ROWS = range(5)


class Stages(NamedTuple):
    """Rows of displacements, of w (rows, width) and of the clock (rows, 8)."""

    u: np.ndarray
    w: np.ndarray
    clock: np.ndarray


class Dop853RootWorkspace(NamedTuple):
    """Workspace of steps along a short chain.

    `slopes` are those in ξ of 16 stages, `dense` the 7 rows of the dense output, `begin` (1 row) the step's start. Rows
    of `state` (4, width) are named above; `closed` (1, width) is 1 where a contact is closed. `polynomial` (8,) is one
    quantity of the dense output: its seven rows, then its value at the start.
    """

    chain: Any
    slopes: Stages
    dense: Stages
    begin: Stages
    state: np.ndarray
    closed: np.ndarray
    polynomial: np.ndarray


class TimeTransform(NamedTuple):
    """The transformed time ξ: that of the event of `contact` (`active` 1), or the time itself (0).

    `others` is 1 for the closed contacts but that one, `chosen` for that one; `stiffness` and `chosen_stiffness` are
    the contacts' stiffness times these.
    """

    active: float
    contact: int
    others: Any
    chosen: Any
    stiffness: Any
    chosen_stiffness: Any


class Point(NamedTuple):
    """Displacements and w with the driver in lane 0, and the clock: q, t, t, …"""

    u: Any
    w: Any
    clock: Any


class Rates(NamedTuple):
    """Rates in t: velocities and ẇ; overlaps, their rates, elastic forces."""

    du: Any
    dw: Any
    overlap: Any
    rate: Any
    elastic: Any


@inline_llvm
def powers(power, q):
    """q^{p−1}, q^{p/2} and q^p."""
    square = q * q
    if power == 2:
        return q, q, square
    return square * q, square, square * square


@inline_llvm
def signed_primitive(law, power, q):
    """G/λ at the overlap q^p, continued to q < 0 as a power of q."""
    _, r, d = powers(power, q)
    return unit_primitive(law, d, r) if power == 2 else copysign(1.0, q) * unit_primitive(law, d, r)


@inline_llvm
def rates_at(values, driver, transform, point):
    """All rates in t at a point."""
    law, q, u = values.slots.dissipation, at(point.clock, ROOT), point.u
    power = smooth_power(law)
    _, r, d = powers(power, q)
    overlap = row_overlap(values.preload, u, from_right(u, blank(u)))
    pressed = positive_part(overlap)
    roots = root(pressed)
    elastic = transform.stiffness * (pressed * roots) + transform.chosen_stiffness * (d * r)
    primitives = (transform.others * unit_primitive(law, pressed, roots)
              + transform.chosen * signed_primitive(law, power, q))
    du = chain_velocity(law, point.w, values.damping_over_mass, primitives)
    net_force = force_on_bead(values.slots, None, from_left(blank(elastic), elastic) - elastic, u, du)
    dw = with_first(values.inverse_mass * net_force, driver_acceleration(driver, at(u, 0)))
    return Rates(du, dw, overlap, du - from_right(du, blank(du)), elastic)


@inline_llvm
def no_transform(values, closed):
    """ξ is the time."""
    zero = blank(closed)
    return TimeTransform(0.0, 0, closed, zero, closed * values.stiffness, zero)


@inline_llvm
def transform_at(values, closed, contact):
    """The transformed time next to the event of a contact, or the time itself where `contact` is −1."""
    if contact < 0:
        return no_transform(values, closed)
    chosen = only_lane(closed, contact)
    others = closed * (1.0 - chosen)
    return TimeTransform(1.0, contact, others, chosen, others * values.stiffness, chosen * values.stiffness)


@inline_llvm
def keep_state(work, point, rates):
    """Write displacements, velocities and elastic forces into the rows of the state."""
    store(work.state, DISPLACEMENT, point.u)
    store(work.state, VELOCITY, rates.du)
    store(work.state, ELASTIC, rates.elastic)
