"""Runs along a short chain with error control, in which an attempt may pass a contact event.

The order of one step, `take_steps`:

1. `nearest_event` (changes.py) chooses a contact whose event is near enough to transform the time for it, or none;
2. `accepted_step` (accepted_step.py) tries steps from the nominal size dt: `size_in_xi` (changes.py) gives the size in
   ξ, `try_step` (step.py) the step, and dt shrinks until the error is tolerable. If another contact opens in the step,
   the time is transformed for that contact's event instead, and the attempts start again;
3. `end_of_step` takes the part of the step up to the first change of a contact, or up to the last point of the grid.
   The state there is that of the dense output, and the next step begins there;
4. `record_step` records largest forces and samples (forces.py);
5. `growth` gives the next dt.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..compiling.jit import inline_llvm, inline_numba, kernel
from ..effects.driver import driver_displacement, driver_velocity
from ..equations.chain_in_vector import chain_values, load_row
from ..error_control.step import GOAL_TOLERANCE, evaluate, is_too_small
from ..flow.event_time import smooth_power
from ..forces.largest import SAMPLE, record_closing
from ..samples import first_not_finite, write_sample
from ..simd.functions import inverse_sixteenth_root
from ..simd.vector import at, blank, positive_mask, splat8, store, with_first
from ..status import (
    CANCELLED,
    CHATTER,
    DONE,
    EVALUATIONS,
    EVENT_WINDOW,
    EVENTS,
    EVENTS_PER_CONTACT,
    NOT_FINITE,
    STEP_TOO_SMALL,
    STEPS,
)
from .accepted_step import ATTEMPTS, RunContext, StepStart, accepted_step, new_units
from .chain import (
    DISPLACEMENT,
    ELASTIC,
    VELOCITY,
    Point,
    W,
    keep_state,
    no_transform,
    powers,
    rates_at,
)
from .changes import nearest_event
from .forces import end_forces, in_xi, may_exceed, search_forces
from .inside import fraction_at, time_inside
from .step import point_inside

#: [step size] dop853-root: largest factor between two steps. It hardly matters by measurement: with 2, as for the next
#: number, 24 motions of section 2 and the rig take 0.3 % more evaluations for errors of 1e-8 and 1e-10.
_MAX_FACTOR = 1.3
#: [step size] dop853-root: largest factor between two steps after an error below `_SMALL_ERROR` tolerances.
_MAX_FACTOR_OF_SMALL_ERROR = 2.0
#: [step size] dop853-root: error in units of the tolerance below which a step may grow faster.
_SMALL_ERROR = 1e-3
#: [step size] dop853-root: safety factor of the step after an accepted one. By measurement, seven motions take 5 % more
#: evaluations for an error of 1e-8 with 0.9, and 1 % fewer with 0.7.
_SAFETY = 0.8


class StepEnd(NamedTuple):
    """The end of a step: the contact that changes there or −1, fraction, time, grid points passed, point, rates.

    `cut` is true if it lies inside the attempt that was accepted.
    """

    contact: int
    x: float
    time: float
    passed: int
    cut: bool
    point: Any
    rates: Any


@inline_llvm
def with_contact_toggled(context, start, contact):
    """`StepStart` after a contact has opened or closed."""
    work = context.work
    work.closed[0, contact] = 1.0 - work.closed[0, contact]
    closed = load_row(work.chain.width, work.closed, 0)
    return StepStart(start.t, start.point, start.rates, start.forces, start.bits ^ (1 << contact), closed)


@inline_numba
def start_of_run(context, t, y, bodies):
    """`StepStart` at the start of a run, from its state; contacts are closed where they overlap."""
    work, values = context.work, context.values
    for i in range(bodies):
        work.state[DISPLACEMENT, i], work.state[W, i] = y[i], y[bodies + i]
    width = work.chain.width
    point = Point(load_row(width, work.state, DISPLACEMENT), load_row(width, work.state, W), splat8(0.0), splat8(t))
    rates = rates_at(values, context.driver, no_transform(values, 1.0 + blank(point.u)), point)
    bits = positive_mask(rates.overlap) & ((1 << (bodies - 1)) - 1)
    for c in range(bodies - 1):
        work.closed[0, c] = 1.0 if (bits >> c) & 1 != 0 else 0.0
    forces = end_forces(values, context.driver, point, rates, context.last)
    return StepStart(t, point, rates, forces, bits, load_row(width, work.closed, 0))


@inline_numba
def with_driver_in_place(context, start):
    """`StepStart` with the driver set to its exact phase, and the rates there."""
    driver, values, theta = context.driver, context.values, context.beta * start.t
    point = Point(with_first(start.point.u, driver_displacement(driver, theta)),
                  with_first(start.point.w, driver_velocity(driver, theta)), splat8(0.0), splat8(start.t))
    rates = rates_at(values, driver, no_transform(values, start.closed), point)
    context.out.counts[EVALUATIONS] += 1
    forces = start.forces
    if context.every > 0:
        forces = end_forces(values, driver, point, rates, context.last)
    return StepStart(start.t, point, rates, forces, start.bits, start.closed)


@inline_numba
def end_of_step(context, start, checked, g, left):
    """The end of a step past grid point g: where a contact changes, or at the last of the `left` points."""
    step, contact, x = checked.step, checked.contact, checked.x
    end, end_rates = step.end, step.end_rates
    time, passed = at(end.t, 0), 0
    if contact >= 0:
        time = time_inside(context.work, x)
    while passed < left and (g + passed + 1) * context.spacing <= time + context.near:
        passed += 1
    if passed == left:
        time = (g + passed) * context.spacing
        fraction = fraction_at(context.work, time, x)
        if fraction < x:
            contact, x = -1, fraction
    cut = contact >= 0 or passed == left
    if cut:
        end = point_inside(context.work, step.start, x)
        end_rates = rates_at(context.values, context.driver, no_transform(context.values, start.closed), end)
        context.out.counts[EVALUATIONS] += 1
    return StepEnd(contact, x, time, passed, cut, end, end_rates)


@inline_numba
def record_step(context, start, checked, end, g, row, samples):
    """Record the forces in a step, and every `every`-th of its grid points after number g.

    Returns the forces at its end and the next free row of `samples`.
    """
    slots, work, out = context.slots, context.work, context.out
    values, driver = context.values, context.driver
    step, forces, end_dt_dxi, exceeds, x = checked.step, checked.forces, checked.step.end_dt_dxi, checked.exceeds, end.x
    if end.cut:
        forces = end_forces(values, driver, end.point, end.rates, context.last)
        if step.transform.active != 0.0:
            end_dt_dxi, _, _ = powers(context.power, at(end.point.q, 0))
    first, last = in_xi(start.forces, step.dt_dxi), in_xi(forces, end_dt_dxi)
    if checked.prepared:
        exceeds = may_exceed(first, last, x * step.h, out.log.peaks)
    if exceeds:
        search_forces(slots, work, first, last, x, x * step.h, out)
    for number in range(g + 1, g + 1 + end.passed):
        if number % context.every == 0:
            inside = point_inside(work, step.start, fraction_at(work, number * context.spacing, x))
            keep_state(work, inside, rates_at(values, driver, no_transform(values, start.closed), inside))
            write_sample(slots, row, work.state[DISPLACEMENT], work.state[VELOCITY], work.state[ELASTIC], samples)
            row += 1
    out.log.counts[SAMPLE] = row - 1
    return forces, row


@inline_llvm
def growth(step, end):
    """Factor from a step's nominal size in time (`tolerable_step`) to that of the next step."""
    if end.cut and end.x < 0.5:
        return 1.0
    most = _MAX_FACTOR if step.error_squared > _SMALL_ERROR**2 else _MAX_FACTOR_OF_SMALL_ERROR
    return min(1.0 if step.limited else most, _SAFETY * inverse_sixteenth_root(max(step.error_squared, 1e-24)))


@inline_numba
def write_beads(context, start, y, bodies):
    """Write the state of the beads to y."""
    state = context.work.state
    store(state, DISPLACEMENT, start.point.u)
    store(state, W, start.point.w)
    for i in range(1, bodies - 1):
        y[i], y[bodies + i] = state[DISPLACEMENT, i], state[W, i]


@inline_numba
def with_change_recorded(context, start, contact):
    """`StepStart` after a contact has changed at a step's end; the velocity of a closing is recorded."""
    start = with_contact_toggled(context, start, contact)
    if (start.bits >> contact) & 1 != 0 and context.every > 0:
        record_closing(context.slots.dissipation, at(start.rates.rate, contact), contact, context.last,
                       context.beta * start.t, context.out.log)
    return start


@inline_numba
def take_steps(context, scale, start, dt, sample_range, samples):
    """Take steps from `start`, of size dt at first, until they have passed all points of the range.

    Returns (status, start of the next step, its size, points left, next free row of `samples`).
    """
    period, counts, left = context.period, context.out.counts, sample_range.points
    g, row, since = sample_range.first, 1, start.t
    events, most_events, idle = 0, EVENTS_PER_CONTACT * (context.last + 1), 0
    while left > 0:
        start = with_driver_in_place(context, start)  # within a period, its oscillator is as accurate as the beads
        while left > 0 and not start.t >= period:
            if context.out.stop[0] != 0:
                return CANCELLED, start, dt, left, row
            if start.t - since > EVENT_WINDOW:
                events, since = 0, start.t
            dt = min(dt, context.method.largest_step)
            units = new_units(context, start.point, scale)
            target = nearest_event(start.rates, start.closed, scale[0], dt)
            if target >= 0 and at(start.rates.overlap, target) <= 0.0 and at(start.rates.rate, target) < 0.0:
                # opened by rounding, or by another event at the same time
                start, events = with_contact_toggled(context, start, target), events + 1
                if events > most_events:
                    return CHATTER, start, dt, left, row
                continue
            if is_too_small(dt, start.t, context.beta):
                return STEP_TOO_SMALL, start, dt, left, row
            status, checked, dt = accepted_step(context, start, target, dt, units, g)
            if status != DONE:
                return status, start, dt, left, row
            end = end_of_step(context, start, checked, g, left)
            idle = idle + 1 if end.contact < 0 and end.time <= start.t else 0
            if idle > ATTEMPTS:
                return STEP_TOO_SMALL, start, dt, left, row
            forces = start.forces
            if context.every > 0:
                forces, row = record_step(context, start, checked, end, g, row, samples)
            dt *= growth(checked.step, end)
            g, left = g + end.passed, left - end.passed
            counts[STEPS] += 1
            start = StepStart(end.time, end.point, end.rates, forces, start.bits, start.closed)
            if end.contact >= 0:
                events += 1
                counts[EVENTS] += 1
                if events > most_events:
                    return CHATTER, start, dt, left, row
                start = with_change_recorded(context, start, end.contact)
        if start.t >= period:
            start = StepStart(start.t - period, start.point, start.rates, start.forces, start.bits, start.closed)
            g, events, since = g - sample_range.grid, 0, start.t
    return DONE, start, dt, left, row


@kernel
def run_dop853_root(method, work, trajectory, sample_range, samples, out):
    """Run over a range of the grid, like `run_error_controlled` (error_control/run.py), on the workspace `work`."""
    slots, drive, y, workspace = trajectory
    points, grid, every = sample_range.points, sample_range.grid, sample_range.every
    bodies, period = slots.chain.inverse_mass.size, drive.period
    context = RunContext(slots, chain_values(work.chain, slots), slots.driver, drive.beta, method, work, out,
                         smooth_power(slots.dissipation), bodies - 2, period, period / grid, GOAL_TOLERANCE * period,
                         every)
    start = start_of_run(context, sample_range.first * context.spacing, y, bodies)
    if every > 0:
        evaluate(slots, drive.beta, start.t, y, workspace.k[0], workspace.forces)
        write_sample(slots, 0, y, workspace.k[0], workspace.forces.e, samples)
    status, start, dt, left, row = take_steps(context, workspace.scale, start, workspace.next_step[0], sample_range,
                                              samples)
    if status == DONE:
        write_beads(context, start, y, bodies)
        workspace.next_step[0] = dt
        evaluate(slots, drive.beta, start.t, y, workspace.k[0], workspace.forces)
        if first_not_finite(y, bodies) != 0:
            status = NOT_FINITE
    return status, row if every > 0 else points - left
