"""One step of DOP853 in the transformed time: stages, error estimate, dense output."""

from __future__ import annotations

from typing import NamedTuple

from ..compiling.jit import inline_llvm
from ..dop853.step import interpolant
from ..dop853.tableau import DENSE_WEIGHTS, E3, E5, STAGES, A
from ..flow.event_time import smooth_power
from ..simd.sums import moved_by_rows, repeat_like, sum_of, weighted_rows
from ..simd.vector import at, load_like, splat8, store
from .chain import Point, powers, rates_at


class Units(NamedTuple):
    """1/(tolerance · scale) of displacements and of w, the factors of their errors, and the number of components.

    The error of t is measured on the scale of w. The error of q is not measured: q^p is the overlap of a contact, and
    the displacements on both sides of it are already measured.
    """

    u: float
    w: float
    components: float


class StepSize(NamedTuple):
    """`xi` is the step size h in ξ. `root` is h/p, the factor of δ̇ in the increment of q; 0 where ξ is the time."""

    xi: float
    root: float


@inline_llvm
def step_size(law, transform, h):
    """`StepSize` of h in ξ."""
    return StepSize(h, h * transform.active / smooth_power(law))


@inline_llvm
def keep_increment(work, law, transform, h, q, rates, row):
    """Write the increments of one stage, i.e. its slopes in ξ times the step size, and return them."""
    dt_dxi, _, _ = powers(smooth_power(law), q)
    dt = h.xi * (1.0 - transform.active + transform.active * dt_dxi)
    dt_like = repeat_like(rates.du, dt)
    target = transform.target
    rise = splat8(at(rates.du, target)) - splat8(at(rates.du, target + 1))  # `rates.rate` is not known yet
    increment = Point(rates.du * dt_like, rates.dw * dt_like, h.root * rise, dt)
    store(work.increments.u, row, increment.u)
    store(work.increments.w, row, increment.w)
    store(work.increments.q, row, increment.q)
    store(work.increments.t, row, increment.t)
    return increment


def _stage(row):
    """Make the code of one stage: from the increment of the previous stage to its own."""
    moved = moved_by_rows(A[row], row - 1)

    @inline_llvm
    def stage(values, driver, work, transform, start, h, increment):
        increments = work.increments
        point = Point(moved(start.u, increment.u, increments.u), moved(start.w, increment.w, increments.w),
                      moved(start.q, increment.q, increments.q), moved(start.t, increment.t, increments.t))
        rates = rates_at(values, driver, transform, point)
        return point, rates, keep_increment(work, values.slots.dissipation, transform, h, point.q, rates, row)

    return stage


(_stage1, _stage2, _stage3, _stage4, _stage5, _stage6, _stage7, _stage8, _stage9, _stage10, _stage11, _stage12,
 _stage13, _stage14, _stage15) = (_stage(row) for row in range(1, 16))
_fifth, _third = weighted_rows(E5), weighted_rows(E3)
_dense3, _dense4, _dense5, _dense6 = (weighted_rows(row) for row in DENSE_WEIGHTS)


@inline_llvm
def try_step(values, driver, work, transform, start, rates, h, units):
    """Try a step of size h in ξ; return the squared error in units of the tolerance, the end, and the rates there.

    `rates` are those at the start; `units` are `Units`.
    """
    law = values.slots.dissipation
    h = step_size(law, transform, h)
    k = keep_increment(work, law, transform, h, start.q, rates, 0)
    _, _, k = _stage1(values, driver, work, transform, start, h, k)
    _, _, k = _stage2(values, driver, work, transform, start, h, k)
    _, _, k = _stage3(values, driver, work, transform, start, h, k)
    _, _, k = _stage4(values, driver, work, transform, start, h, k)
    _, _, k = _stage5(values, driver, work, transform, start, h, k)
    _, _, k = _stage6(values, driver, work, transform, start, h, k)
    _, _, k = _stage7(values, driver, work, transform, start, h, k)
    _, _, k = _stage8(values, driver, work, transform, start, h, k)
    _, _, k = _stage9(values, driver, work, transform, start, h, k)
    _, _, k = _stage10(values, driver, work, transform, start, h, k)
    _, _, k = _stage11(values, driver, work, transform, start, h, k)
    end, end_rates, _ = _stage12(values, driver, work, transform, start, h, k)
    increments = work.increments
    u5, w5 = units.u * _fifth(start.u, increments.u), units.w * _fifth(start.w, increments.w)
    u3, w3 = units.u * _third(start.u, increments.u), units.w * _third(start.w, increments.w)
    t5, t3 = units.w * at(_fifth(start.t, increments.t), 0), units.w * at(_third(start.t, increments.t), 0)
    fifth, third = sum_of(u5 * u5 + w5 * w5) + t5 * t5, sum_of(u3 * u3 + w3 * w3) + t3 * t3
    norm = fifth + 0.01 * third  # as in `error_norm` (dop853/step.py)
    square = 0.0 if norm == 0.0 else fifth * fifth / (norm * units.components)
    return square, end, end_rates


@inline_llvm
def _dense_rows(increments, dense, start, end):
    """The seven rows of the dense output of one part of the state."""
    change, first, last = end - start, load_like(start, increments, 0), load_like(start, increments, STAGES)
    store(dense, 0, change)
    store(dense, 1, first - change)
    store(dense, 2, 2.0 * change - (last + first))
    store(dense, 3, _dense3(start, increments))
    store(dense, 4, _dense4(start, increments))
    store(dense, 5, _dense5(start, increments))
    store(dense, 6, _dense6(start, increments))


@inline_llvm
def prepare_dense_rows(values, driver, work, transform, start, end, h):
    """Fill the dense output of the step, with three more stages, and store its start."""
    increments, dense = work.increments, work.dense
    h = step_size(values.slots.dissipation, transform, h)
    k = Point(load_like(start.u, increments.u, STAGES), load_like(start.w, increments.w, STAGES),
              load_like(start.q, increments.q, STAGES), load_like(start.t, increments.t, STAGES))
    _, _, k = _stage13(values, driver, work, transform, start, h, k)
    _, _, k = _stage14(values, driver, work, transform, start, h, k)
    _, _, k = _stage15(values, driver, work, transform, start, h, k)
    _dense_rows(increments.u, dense.u, start.u, end.u)
    _dense_rows(increments.w, dense.w, start.w, end.w)
    _dense_rows(increments.q, dense.q, start.q, end.q)
    _dense_rows(increments.t, dense.t, start.t, end.t)
    store(work.start.u, 0, start.u)
    store(work.start.w, 0, start.w)
    store(work.start.q, 0, start.q)
    store(work.start.t, 0, start.t)


@inline_llvm
def _dense_vector(dense, start, x):
    """One part of the state at fraction x of the step."""
    rows = (load_like(start, dense, 0), load_like(start, dense, 1), load_like(start, dense, 2),
            load_like(start, dense, 3), load_like(start, dense, 4), load_like(start, dense, 5),
            load_like(start, dense, 6))
    return interpolant(start, rows, x)


@inline_llvm
def point_inside(work, start, x):
    """The chain at fraction x of the step, whose dense output is prepared."""
    dense = work.dense
    return Point(_dense_vector(dense.u, start.u, x), _dense_vector(dense.w, start.w, x),
                 _dense_vector(dense.q, start.q, x), _dense_vector(dense.t, start.t, x))


