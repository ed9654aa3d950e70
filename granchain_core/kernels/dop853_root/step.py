"""One step of the Dormand–Prince method of order 8 in the transformed time: stages, error estimate, dense output."""

from __future__ import annotations

from typing import NamedTuple

from ..compiling.jit import inline_llvm
from ..dop853.step import interpolant
from ..dop853.tableau import DENSE_WEIGHTS, E3, E5, STAGES, A
from ..flow.event_time import smooth_power
from ..simd.sums import sum_of, weighted_rows
from ..simd.vector import at, load_like, splat8, store, with_first
from .chain import ROOT, TIME, Point, powers, rates_at


class Units(NamedTuple):
    """1/(tolerance · scale) of displacements and of w, by which errors are multiplied, and how many components count.

    The error of t is measured as one of w.
    """

    u: float
    w: float
    components: float


@inline_llvm
def keep_slope(work, law, transform, q, rates, row):
    """Write the slopes in ξ of one stage; returns them."""
    power = smooth_power(law)
    pace, _, _ = powers(power, q)
    pace = 1.0 - transform.active + transform.active * pace
    rise = transform.active / power * at(rates.rate, transform.contact)
    slope = Point(rates.du * pace, rates.dw * pace, with_first(splat8(pace), rise))
    store(work.slopes.u, row, slope.u)
    store(work.slopes.w, row, slope.w)
    store(work.slopes.clock, row, slope.clock)
    return slope


def _stage(row):
    """Code of one stage: from the slope of the stage before it to its own."""
    total = weighted_rows(A[row], row - 1)

    @inline_llvm
    def stage(values, driver, work, transform, start, h, slope):
        slopes = work.slopes
        point = Point(start.u + h * total(slope.u, slopes.u), start.w + h * total(slope.w, slopes.w),
                      start.clock + h * total(slope.clock, slopes.clock))
        rates = rates_at(values, driver, transform, point)
        return point, rates, keep_slope(work, values.slots.dissipation, transform, at(point.clock, ROOT), rates, row)

    return stage


(_stage1, _stage2, _stage3, _stage4, _stage5, _stage6, _stage7, _stage8, _stage9, _stage10, _stage11, _stage12,
 _stage13, _stage14, _stage15) = (_stage(row) for row in range(1, 16))
_fifth, _third = weighted_rows(E5), weighted_rows(E3)
_dense3, _dense4, _dense5, _dense6 = (weighted_rows(row) for row in DENSE_WEIGHTS)


@inline_llvm
def attempt(values, driver, work, transform, start, rates, h, units):
    """Try a step of size h in ξ; returns the square of the error over the tolerance, the end and its rates.

    `rates` are those at the start; `units` are `Units`.
    """
    k = keep_slope(work, values.slots.dissipation, transform, at(start.clock, ROOT), rates, 0)
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
    slopes = work.slopes
    u5, w5 = units.u * _fifth(start.u, slopes.u), units.w * _fifth(start.w, slopes.w)
    u3, w3 = units.u * _third(start.u, slopes.u), units.w * _third(start.w, slopes.w)
    t5 = units.w * at(_fifth(start.clock, slopes.clock), TIME)
    t3 = units.w * at(_third(start.clock, slopes.clock), TIME)
    fifth, third = sum_of(u5 * u5 + w5 * w5) + t5 * t5, sum_of(u3 * u3 + w3 * w3) + t3 * t3
    norm = fifth + 0.01 * third  # as in `error_norm` (dop853/step.py)
    square = 0.0 if norm == 0.0 else h * h * fifth * fifth / (norm * units.components)
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
def prepare_dense_rows(values, driver, work, transform, start, end, h):
    """Fill the dense output of the step, with three more slopes, and keep its start."""
    slopes, dense, begin = work.slopes, work.dense, work.begin
    k = Point(load_like(start.u, slopes.u, STAGES), load_like(start.w, slopes.w, STAGES),
              load_like(start.clock, slopes.clock, STAGES))
    _, _, k = _stage13(values, driver, work, transform, start, h, k)
    _, _, k = _stage14(values, driver, work, transform, start, h, k)
    _, _, k = _stage15(values, driver, work, transform, start, h, k)
    _dense_rows(slopes.u, dense.u, start.u, end.u, h)
    _dense_rows(slopes.w, dense.w, start.w, end.w, h)
    _dense_rows(slopes.clock, dense.clock, start.clock, end.clock, h)
    store(begin.u, 0, start.u)
    store(begin.w, 0, start.w)
    store(begin.clock, 0, start.clock)


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
                 _dense_vector(dense.clock, start.clock, x))


