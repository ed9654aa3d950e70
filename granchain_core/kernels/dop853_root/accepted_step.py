"""Accepted steps of a short chain: the error is tolerable, and only the contact that the step aims at may open."""

from __future__ import annotations

from math import isfinite
from typing import Any, NamedTuple

from ..compiling.jit import inline_numba
from ..dop853.tableau import DENSE_EVALUATIONS, STAGES
from ..error_control.step import is_too_small
from ..flow.event_time import nonnegative_root
from ..simd.functions import inverse_sixteenth_root
from ..simd.sums import largest_of
from ..simd.vector import at, splat8, with_first
from ..status import DONE, EVALUATIONS, NOT_FINITE, REJECTED, STEP_TOO_SMALL
from .chain import Point, powers, transform_at
from .changes import StepInXi, changes_in, first_event, may_change, size_in_xi
from .forces import end_forces, in_xi, may_exceed
from .step import Units, prepare_dense_rows, try_step

#: [step size] dop853-root: smallest factor from one attempt to the next.
_MIN_FACTOR = 0.1
#: [step size] dop853-root: safety factor of a step that is repeated, as in Hairer's dop853.f (SAFE).
_SAFETY_OF_REPEATED = 0.9
#: [step size] dop853-root: numbers that overflow in a step shorter than this overflow in any step.
_OVERFLOW_STEP = 1e-9
#: [step size] dop853-root: most attempts at one step, and most consecutive steps in which no time passes.
ATTEMPTS = 60


class RunContext(NamedTuple):
    """Data shared by the steps of a run: chain, method, workspace, counters, and p of the time transformation.

    `last` is the number of the last contact, and of beads; `period` that of the drive. Grid points are `spacing` apart,
    and a point that is missed by at most `near` counts as passed. Every `every`-th point is recorded, none if `every`
    is 0.
    """

    slots: Any
    values: Any
    driver: Any
    beta: float
    method: Any
    work: Any
    out: Any
    power: int
    last: int
    period: float
    spacing: float
    near: float
    every: int


class StepStart(NamedTuple):
    """The chain at a step's start: time in the period, point, rates, forces; closed contacts as bits and as 0 or 1.

    The forces are up to date only if they are being recorded.
    """

    t: float
    point: Any
    rates: Any
    forces: Any
    bits: int
    closed: Any


class CheckedStep(NamedTuple):
    """An accepted step, the forces at its end, and the first contact that changes in it (−1: none), with the fraction.

    `prepared` is true if the dense output is in the workspace, `exceeds` if a new largest force may lie inside the
    step.
    """

    step: Any
    forces: Any
    contact: int
    x: float
    prepared: bool
    exceeds: bool


@inline_numba
def new_units(context, point, scale):
    """Raise the scale of the tolerance to the largest values at a point; return the `Units` of the errors."""
    for q in range(2):
        largest = largest_of(abs(with_first(point.u if q == 0 else point.w, 0.0)))
        scale[q] = max(scale[q], largest)
    tolerance = context.method.tolerance
    return Units(1.0 / (tolerance * scale[0]), 1.0 / (tolerance * scale[1]), 2.0 * context.last)


@inline_numba
def tolerable_step(context, start, target, dt, units):
    """Shrink a step until its error is tolerable, in the time next to the event of contact `target`, or in t (−1).

    Returns (status, step, dt). dt is nominal: the next step is planned from it, and it shrinks by the same factor as
    the step in ξ, although their ratio is not constant next to an event.
    """
    counts = context.out.counts
    transform, q, h, limited, dt_dxi = transform_at(context.values, start.closed, target), 0.0, dt, False, 1.0
    if target >= 0:
        q = nonnegative_root(at(start.rates.overlap, target), context.power)
        dt_dxi, _, _ = powers(context.power, q)
        h, limited = size_in_xi(context.power, q, at(start.rates.rate, target), dt)
    point, status = Point(start.point.u, start.point.w, splat8(q), splat8(start.t)), DONE
    while True:
        square, end, end_rates = try_step(context.values, context.driver, context.work, transform, point,
                                          start.rates, h, units)
        counts[EVALUATIONS] += STAGES
        if square <= 1.0:
            break
        counts[REJECTED] += 1
        limited = True
        if isfinite(square):
            factor = max(_MIN_FACTOR, _SAFETY_OF_REPEATED * inverse_sixteenth_root(square))
        elif dt < _OVERFLOW_STEP:
            status = NOT_FINITE
            break
        else:
            factor = _MIN_FACTOR  # an overflow: ξ covers far more time than it should
        h, dt = h * factor, dt * factor
        if is_too_small(dt, start.t, context.beta):
            status = STEP_TOO_SMALL
            break
    end_dt_dxi = 1.0
    if target >= 0:
        end_dt_dxi, _, _ = powers(context.power, at(end.q, 0))
    return status, StepInXi(transform, h, point, start.rates, dt_dxi, end, end_rates, end_dt_dxi, square, limited), dt


@inline_numba
def accepted_step(context, start, target, dt, units, g):
    """Take an accepted step past grid point g in which only the contact of its time transformation may open.

    If another contact would open, the step is tried again with the time transformation of that contact's event. Returns
    (status, `CheckedStep`, dt), with dt as in `tolerable_step`.
    """
    slots, work, values, counts = context.slots, context.work, context.values, context.out.counts
    attempts = 1
    while True:
        status, step, dt = tolerable_step(context, start, target, dt, units)
        forces, contact, x, prepared, exceeds = start.forces, -1, 2.0, False, False
        if status == DONE:
            crossed, turned = changes_in(step, start.bits, context.last + 1)
            turned = may_change(step, context.power, start.bits, turned)
            changes = crossed | turned != 0
            prepared = changes or (g + 1) * context.spacing <= at(step.end.t, 0) + context.near
            if context.every > 0:
                forces = end_forces(values, context.driver, step.end, step.end_rates, context.last)
                if not prepared:
                    exceeds = may_exceed(in_xi(start.forces, step.dt_dxi), in_xi(forces, step.end_dt_dxi), step.h,
                                         context.out.log.peaks)
            if prepared or exceeds:
                prepare_dense_rows(values, context.driver, work, step.transform, step.start, step.end, step.h)
                counts[EVALUATIONS] += DENSE_EVALUATIONS
            if changes:
                contact, x = first_event(slots, work, step, start.bits, crossed, turned)
        done = status != DONE or contact < 0 or contact == target or (start.bits >> contact) & 1 == 0 or x == 0.0
        if done:
            break
        target = contact
        counts[REJECTED] += 1
        if attempts > 2:
            dt *= 0.5
        attempts += 1
        if attempts > ATTEMPTS or is_too_small(dt, start.t, context.beta):
            status = STEP_TOO_SMALL
            break
    return status, CheckedStep(step, forces, contact, min(x, 1.0), prepared, exceeds), dt
