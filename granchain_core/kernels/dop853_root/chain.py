"""A short chain in vectors, in a transformed time ξ in which the motion next to one contact's event is smooth.

After contact c closes at t_e, its overlap grows as t − t_e and its force as the power 3/2 of that, so the motion has no
Taylor series in t there; the same applies before an opening. It has one in ξ, with

    q = δ_c^{1/p},    dt/dξ = q^{p−1},    dq/dξ = δ̇_c/p

and p as in flow/event_time.py. (Sundman transformed time in this way in celestial mechanics.) q and t are integrated
along with the chain, and the forces of contact c are powers of q. At an opening, q passes through zero while everything
else is smooth. So an attempt may go beyond the opening, which is then a root of its dense output, and need not be
repeated. For the same reason, open contacts stay open within an attempt. Far from events, ξ is the time.

Lane 0 is the driver, which is integrated as an oscillator, so that no stage needs a sine. q and t have vectors of their
own, with the same number in all lanes: moving a number from one vector to another would delay the next stage.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_llvm
from ..effects.dissipation import LAWS, unit_primitive
from ..effects.driver import driver_acceleration
from ..effects.preload import row_overlap
from ..equations.body_forces import force_on_bead
from ..equations.chain_in_vector import chain_velocity
from ..flow.event_time import smooth_power
from ..simd.functions import chain_root, gate, positive_part
from ..simd.sums import only_lane, repeat_like
from ..simd.vector import at, blank, from_left, from_right, splat8, store, with_first

#: Rows of the workspace's state, and their number.
DISPLACEMENT, VELOCITY, ELASTIC, W, STATE_ROWS = range(5)


class Stages(NamedTuple):
    """Rows of displacements, of w (rows, width), of q and of t (rows, 8)."""

    u: np.ndarray
    w: np.ndarray
    q: np.ndarray
    t: np.ndarray


class Dop853RootWorkspace(NamedTuple):
    """Workspace of steps along a short chain.

    `increments` are the slopes in ξ of 16 stages times the size of the step, `dense` the 7 rows of the dense output,
    `start` (1 row) the step\'s start. The rows of `state` (4, width) are named above; `closed` (1, width) is 1 where a
    contact is closed. `polynomial` (8,) is one quantity of the dense output: its seven rows, then its value at the
    start.
    """

    chain: Any
    increments: Stages
    dense: Stages
    start: Stages
    state: np.ndarray
    closed: np.ndarray
    polynomial: np.ndarray


class TimeTransformation(NamedTuple):
    """The transformed time ξ: that of the event of contact `target` (`active` 1), or the time itself (0).

    `others` is 1 for all other closed contacts; `stiffness` is that of the others, and `target_stiffness` that of
    the target. `pull` is 1 on the bead after the target and −1 on the bead before it: its action on these two beads is
    added at the end, because q, on which it depends, is known last. `damping_pull` is λ/m times `pull`, None
    without damping, and `stiff_pull` is the stiffness times `pull`.
    """

    active: float
    target: int
    others: Any
    stiffness: Any
    target_stiffness: Any
    damping_pull: Any
    stiff_pull: Any


class Point(NamedTuple):
    """Displacements and w with the driver in lane 0; q and t, each in all lanes."""

    u: Any
    w: Any
    q: Any
    t: Any


class Rates(NamedTuple):
    """Rates in t: velocities and ẇ; also overlaps, their rates and elastic forces."""

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
    primitive = unit_primitive(law, d, r)
    return primitive if power == 2 else gate(q, primitive) - gate(-q, primitive)


@by_slot
def pull_of_damping(law, damping_over_mass, pull):
    """λ/m times the signs with which a contact acts on its beads. Effect absent: None."""
    return None


@pull_of_damping.of(*LAWS)
def _(law, damping_over_mass, pull):
    return damping_over_mass * pull


@by_slot
def with_damping_of(law, du, damping_pull, power, q):
    """Add the share of the damping of the contact at q to the velocities du of its beads."""
    return du


@with_damping_of.of(*LAWS)
def _(law, du, damping_pull, power, q):
    return du + damping_pull * signed_primitive(law, power, q)


@inline_llvm
def rates_at(values, driver, transform, point):
    """All rates in t at a point."""
    law, u = values.slots.dissipation, point.u
    power, q = smooth_power(law), repeat_like(u, point.q)
    _, r, d = powers(power, q)
    overlap = row_overlap(values.preload, u, from_right(u, blank(u)))
    pressed = positive_part(overlap)
    roots, target_power = chain_root(pressed), d * r
    elastic = transform.stiffness * (pressed * roots)
    du = chain_velocity(law, point.w, values.damping_over_mass, transform.others * unit_primitive(law, pressed, roots))
    du = with_damping_of(law, du, transform.damping_pull, power, q)
    contacts = from_left(blank(elastic), elastic) - elastic + transform.stiff_pull * target_power
    net_force = force_on_bead(values.slots, None, contacts, u, du)
    dw = with_first(values.inverse_mass * net_force, driver_acceleration(driver, at(u, 0)))
    return Rates(du, dw, overlap, du - from_right(du, blank(du)), elastic + transform.target_stiffness * target_power)


@inline_llvm
def transform_of(values, closed, in_target, active, target):
    """The transformed time next to the event of the contact for which `in_target` is 1; if none is, the time itself."""
    others, pull = closed * (1.0 - in_target), from_left(blank(in_target), in_target) - in_target
    stiffness = repeat_like(in_target, splat8(at(values.stiffness, target)))
    return TimeTransformation(active, target, others, others * values.stiffness, in_target * stiffness,
                              pull_of_damping(values.slots.dissipation, values.damping_over_mass, pull),
                              stiffness * pull)


@inline_llvm
def no_transform(values, closed):
    """The time itself as ξ."""
    return transform_of(values, closed, blank(closed), 0.0, 0)


@inline_llvm
def transform_at(values, closed, target):
    """The transformed time next to the event of contact `target`, or the time itself where `target` is −1."""
    if target < 0:
        return no_transform(values, closed)
    return transform_of(values, closed, only_lane(closed, target), 1.0, target)


@inline_llvm
def keep_state(work, point, rates):
    """Write displacements, velocities and elastic forces into the rows of the state."""
    store(work.state, DISPLACEMENT, point.u)
    store(work.state, VELOCITY, rates.du)
    store(work.state, ELASTIC, rates.elastic)
