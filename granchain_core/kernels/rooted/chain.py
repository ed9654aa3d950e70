"""A short chain in vectors, in a variable x in which the motion next to one contact's event is smooth.

After an onset at t_e the overlap of contact c grows as t − t_e and its force as the power 3/2, so the motion has no
Taylor series in t there; the same holds before a release. It has one in x (ξ in docs/model.md), with

    q = δ_c^{1/p},    dt/dx = q^{p−1},    dq/dx = δ̇_c/p

and p as in flow/event_time.py. q and t are integrated along with the chain, and the forces of contact c are powers of
q. At a release q passes through zero with everything else smooth, so that a step may go beyond the release, which is
then a root on the step's dense output: nothing is repeated. Contacts that are open stay so within a step, for the same
reason. With no contact chosen, x is the time.

Lane 0 is the driver, which moves as an oscillator: no stage needs a sine.
"""

from __future__ import annotations

from math import copysign
from typing import Any, NamedTuple

import numpy as np

from ..dop853.tableau import DENSE_WEIGHTS, E3, E5, STAGES, A
from ..effects.contact import positive_part
from ..effects.dissipation import shape
from ..effects.driver import driver_acceleration
from ..effects.foundation import add_foundation_force
from ..effects.preload import row_overlap
from ..flow.event_time import smooth_power
from ..jit import inline_llvm
from ..rk4.short_chain import chain_velocity
from ..simd.functions import root
from ..simd.sums import only_lane, sum_of, weighted_rows
from ..simd.vector import at, blank, from_left, from_right, load_like, splat, store, with_first

#: Lanes of the clock: q, then t in all others.
ROOT, TIME = 0, 1
#: Rows of the workspace's state: displacements, velocities, elastic forces.
DISPLACEMENT, VELOCITY, ELASTIC, STATE_ROWS = 0, 1, 2, 3


class Stages(NamedTuple):
    """Rows of displacements, of w (rows, width) and of the clock (rows, 8)."""

    u: np.ndarray
    w: np.ndarray
    clock: np.ndarray


class RootedWorkspace(NamedTuple):
    """Workspace of steps along a short chain.

    `slopes` are those in x of 16 stages, `dense` the 7 rows of the dense output, `begin` (1 row) the step's start. Rows
    of `state` (3, width) are named above; `closed` (1, width) is 1 where a contact is closed. `polynomial` (8,) is one
    quantity of the dense output.
    """

    chain: Any
    slopes: Stages
    dense: Stages
    begin: Stages
    state: np.ndarray
    closed: np.ndarray
    polynomial: np.ndarray


class Variable(NamedTuple):
    """What x is: the root of contact `contact` (`rooted` 1) or the time (0).

    `others` is 1 for the closed contacts but that one, `chosen` for that one; `stiffness` and `chosen_stiffness` are
    the contacts' stiffness times these.
    """

    rooted: float
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
    """Velocities, ẇ, overlaps, their rates, elastic forces."""

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
def signed_shape(law, power, q):
    """The shape of G at the overlap q^p, continued to q < 0 as a power of q."""
    _, r, d = powers(power, q)
    return shape(law, d, r) if power == 2 else copysign(1.0, q) * shape(law, d, r)


@inline_llvm
def rates_at(values, driver, variable, point):
    """All rates in t at a point."""
    q, u, power = at(point.clock, ROOT), point.u, smooth_power(values.dissipation)
    _, r, d = powers(power, q)
    overlap = row_overlap(values.preload, u, from_right(u, blank(u)))
    pressed = positive_part(overlap)
    roots = root(pressed)
    elastic = variable.stiffness * (pressed * roots) + variable.chosen_stiffness * (d * r)
    shapes = (variable.others * shape(values.dissipation, pressed, roots)
              + variable.chosen * signed_shape(values.dissipation, power, q))
    du = chain_velocity(values.dissipation, point.w, values.damping_over_mass, shapes)
    net_force = add_foundation_force(values.foundation, from_left(blank(elastic), elastic) - elastic, u)
    dw = with_first(values.inverse_mass * net_force, driver_acceleration(driver, at(u, 0)))
    return Rates(du, dw, overlap, du - from_right(du, blank(du)), elastic)


@inline_llvm
def time_variable(values, closed):
    """x is the time."""
    zero = blank(closed)
    return Variable(0.0, 0, closed, zero, closed * values.stiffness, zero)


@inline_llvm
def new_variable(values, closed, contact):
    """x for the root of a contact, or the time where `contact` is −1."""
    if contact < 0:
        return time_variable(values, closed)
    chosen = only_lane(closed, contact)
    others = closed * (1.0 - chosen)
    return Variable(1.0, contact, others, chosen, others * values.stiffness, chosen * values.stiffness)


@inline_llvm
def keep_slope(work, law, variable, q, rates, row):
    """Write the slopes in x of one stage; returns them."""
    power = smooth_power(law)
    pace, _, _ = powers(power, q)
    pace = 1.0 - variable.rooted + variable.rooted * pace
    rise = variable.rooted / power * at(rates.rate, variable.contact)
    slope = Point(rates.du * pace, rates.dw * pace, with_first(splat(pace), rise))
    store(work.slopes.u, row, slope.u)
    store(work.slopes.w, row, slope.w)
    store(work.slopes.clock, row, slope.clock)
    return slope


def _stage(row):
    """Code of one stage: from the slope of the stage before it to its own."""
    total = weighted_rows(A[row], row - 1)

    @inline_llvm
    def stage(values, driver, work, variable, start, h, slope):
        slopes = work.slopes
        point = Point(start.u + h * total(slope.u, slopes.u), start.w + h * total(slope.w, slopes.w),
                      start.clock + h * total(slope.clock, slopes.clock))
        rates = rates_at(values, driver, variable, point)
        return point, rates, keep_slope(work, values.dissipation, variable, at(point.clock, ROOT), rates, row)

    return stage


(_stage1, _stage2, _stage3, _stage4, _stage5, _stage6, _stage7, _stage8, _stage9, _stage10, _stage11, _stage12,
 _stage13, _stage14, _stage15) = (_stage(row) for row in range(1, 16))
_fifth, _third = weighted_rows(E5), weighted_rows(E3)
_dense3, _dense4, _dense5, _dense6 = (weighted_rows(row) for row in DENSE_WEIGHTS)


@inline_llvm
def attempt(values, driver, work, variable, start, rates, h, units):
    """Try a step of size h in x; returns the square of the error over the tolerance, the end and its rates.

    `rates` are those at the start. Errors of displacements and w are multiplied by the first two `units`, that of the
    time by the second, as a speed; their mean square is over so many numbers as the third says.
    """
    k = keep_slope(work, values.dissipation, variable, at(start.clock, ROOT), rates, 0)
    _, _, k = _stage1(values, driver, work, variable, start, h, k)
    _, _, k = _stage2(values, driver, work, variable, start, h, k)
    _, _, k = _stage3(values, driver, work, variable, start, h, k)
    _, _, k = _stage4(values, driver, work, variable, start, h, k)
    _, _, k = _stage5(values, driver, work, variable, start, h, k)
    _, _, k = _stage6(values, driver, work, variable, start, h, k)
    _, _, k = _stage7(values, driver, work, variable, start, h, k)
    _, _, k = _stage8(values, driver, work, variable, start, h, k)
    _, _, k = _stage9(values, driver, work, variable, start, h, k)
    _, _, k = _stage10(values, driver, work, variable, start, h, k)
    _, _, k = _stage11(values, driver, work, variable, start, h, k)
    end, end_rates, _ = _stage12(values, driver, work, variable, start, h, k)
    slopes = work.slopes
    u5, w5 = units[0] * _fifth(start.u, slopes.u), units[1] * _fifth(start.w, slopes.w)
    u3, w3 = units[0] * _third(start.u, slopes.u), units[1] * _third(start.w, slopes.w)
    t5 = units[1] * at(_fifth(start.clock, slopes.clock), TIME)
    t3 = units[1] * at(_third(start.clock, slopes.clock), TIME)
    fifth, third = sum_of(u5 * u5 + w5 * w5) + t5 * t5, sum_of(u3 * u3 + w3 * w3) + t3 * t3
    norm = fifth + 0.01 * third
    square = 0.0 if norm == 0.0 else h * h * fifth * fifth / (norm * units[2])
    return square, end, end_rates


@inline_llvm
def _dense_rows(slopes, dense, start, end, h):
    """The seven rows of the dense output of one part of the state."""
    change, first, last = end - start, load_like(start, slopes, 0), load_like(start, slopes, STAGES)
    store(dense, 0, change)
    store(dense, 1, h * first - change)
    store(dense, 2, 2.0 * change - h * (last + first))
    store(dense, 3, h * _dense3(start, slopes))
    store(dense, 4, h * _dense4(start, slopes))
    store(dense, 5, h * _dense5(start, slopes))
    store(dense, 6, h * _dense6(start, slopes))


@inline_llvm
def prepare_dense_rows(values, driver, work, variable, start, end, h):
    """Fill the dense output of the step, with three more slopes, and keep its start."""
    slopes, dense, begin = work.slopes, work.dense, work.begin
    k = Point(load_like(start.u, slopes.u, STAGES), load_like(start.w, slopes.w, STAGES),
              load_like(start.clock, slopes.clock, STAGES))
    _, _, k = _stage13(values, driver, work, variable, start, h, k)
    _, _, k = _stage14(values, driver, work, variable, start, h, k)
    _, _, k = _stage15(values, driver, work, variable, start, h, k)
    _dense_rows(slopes.u, dense.u, start.u, end.u, h)
    _dense_rows(slopes.w, dense.w, start.w, end.w, h)
    _dense_rows(slopes.clock, dense.clock, start.clock, end.clock, h)
    store(begin.u, 0, start.u)
    store(begin.w, 0, start.w)
    store(begin.clock, 0, start.clock)


@inline_llvm
def _dense_vector(dense, start, x):
    """One part of the state at fraction x of the step."""
    back = 1.0 - x
    value = load_like(start, dense, 6) * x
    value = (value + load_like(start, dense, 5)) * back
    value = (value + load_like(start, dense, 4)) * x
    value = (value + load_like(start, dense, 3)) * back
    value = (value + load_like(start, dense, 2)) * x
    value = (value + load_like(start, dense, 1)) * back
    return start + (value + load_like(start, dense, 0)) * x


@inline_llvm
def point_inside(work, start, x):
    """The chain at fraction x of the step, whose dense output is prepared."""
    dense = work.dense
    return Point(_dense_vector(dense.u, start.u, x), _dense_vector(dense.w, start.w, x),
                 _dense_vector(dense.clock, start.clock, x))


@inline_llvm
def keep_state(work, point, rates):
    """Write displacements, velocities and elastic forces into the rows of the state."""
    store(work.state, DISPLACEMENT, point.u)
    store(work.state, VELOCITY, rates.du)
    store(work.state, ELASTIC, rates.elastic)
