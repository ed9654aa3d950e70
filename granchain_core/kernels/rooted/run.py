"""Runs along a short chain: steps with error control that go past contact events, which are roots inside them."""

from __future__ import annotations

from math import isfinite

from ..dop853.step import PERIOD_END, evaluate
from ..dop853.tableau import DENSE_EVALUATIONS, STAGES
from ..effects.driver import driver_displacement, driver_velocity
from ..flow.event_time import distance_root, smooth_power
from ..forces.largest import SAMPLE, note_closing
from ..jit import inline_llvm, kernel
from ..rk4.short_chain import chain_values, load_row
from ..samples import first_not_finite, keep
from ..simd.sums import largest_of, magnitude, rough_sixteenth
from ..simd.vector import at, blank, positive_mask, splat, store, with_first
from ..status import (
    CANCELLED,
    CHATTER,
    DONE,
    EVALUATIONS,
    EVENTS,
    EVENTS_PER_CONTACT,
    NOT_FINITE,
    REJECTED,
    STEP_TOO_SMALL,
    STEPS,
)
from .chain import (
    DISPLACEMENT,
    ELASTIC,
    ROOT,
    TIME,
    VELOCITY,
    Point,
    attempt,
    keep_state,
    new_variable,
    point_inside,
    powers,
    prepare_dense_rows,
    rates_at,
    time_variable,
)
from .changes import Taken, changes_in, first_change, nearest_event, size_in_x
from .inside import (
    end_forces,
    fraction_at,
    in_x,
    may_exceed,
    search_forces,
    time_inside,
)

#: Bounds on the factor between two steps, the third where the error is below `_SMALL`; safety factors of a step after
#: an accepted one and of its repetition.
_SHRINK, _GROW, _GROW_FAST, _SMALL, _SAFETY, _AGAIN = 0.1, 1.3, 2.0, 1e-3, 0.8, 0.9
#: Numbers that overflow in a shorter step than this will do so in any.
_HOPELESS = 1e-9
#: ε in the resolution of t, ε·(t + 1/β): the spacing of floating-point numbers at 1.
_RESOLUTION = 2.2e-16
#: Attempts to begin a step, and steps in which no time passes.
_ATTEMPTS = 60


@inline_llvm
def toggled(work, status, contact):
    """Which contacts are closed, in bits and as a vector, once one more has opened or closed."""
    work.closed[0, contact] = 1.0 - work.closed[0, contact]
    return status ^ (1 << contact), load_row(work.chain.width, work.closed, 0)


@kernel
def run_rooted(method, work, trajectory, stretch, samples, out):
    """Run over a stretch of the grid, as `run_dop853` (dop853/run.py) does, with the chain's own workspace `work`."""
    slots, drive, y, workspace = trajectory
    points, grid, every = stretch.points, stretch.grid, stretch.every
    driver, values, wide, counts = slots.driver, chain_values(work.chain, slots), work.chain, out.counts
    bodies, period, spacing = slots.chain.inverse_mass.size, drive.period, drive.period / grid
    power, resolution, last = smooth_power(slots.dissipation), _RESOLUTION / drive.beta, bodies - 2
    g, done, row, events, idle, dt = stretch.first, 0, 1, 0, 0, workspace.next_step[0]
    t = g * spacing
    for i in range(bodies):
        work.state[DISPLACEMENT, i], work.state[VELOCITY, i] = y[i], y[bodies + i]
    point = Point(load_row(wide.width, work.state, DISPLACEMENT), load_row(wide.width, work.state, VELOCITY), splat(t))
    rates = rates_at(values, driver, time_variable(values, 1.0 + blank(point.u)), point)
    status = positive_mask(rates.overlap) & ((1 << (bodies - 1)) - 1)
    for c in range(bodies - 1):
        work.closed[0, c] = 1.0 if (status >> c) & 1 != 0 else 0.0
    closed, again = load_row(wide.width, work.closed, 0), True
    forces = end_forces(values, driver, point, rates, last)
    if every > 0:
        evaluate(slots, drive.beta, t, y, workspace.k[0], workspace.forces)
        keep(slots, 0, y, workspace.k[0], workspace.forces.e, samples)
    while done < points:
        if out.stop[0] != 0:
            return CANCELLED, row if every > 0 else done
        if again:
            point = Point(with_first(point.u, driver_displacement(driver, drive.beta * t)),
                          with_first(point.w, driver_velocity(driver, drive.beta * t)), splat(t))
            rates = rates_at(values, driver, time_variable(values, closed), point)
            counts[EVALUATIONS] += 1
            if every > 0:
                forces = end_forces(values, driver, point, rates, last)
        dt = min(dt, method.largest_step)
        for q in range(2):
            largest = largest_of(magnitude(with_first(point.u if q == 0 else point.w, 0.0)))
            workspace.scale[q] = max(workspace.scale[q], largest)
        units = (1.0 / (method.tolerance * workspace.scale[0]), 1.0 / (method.tolerance * workspace.scale[1]),
                 2.0 * last)
        chosen, contact, x, attempts = nearest_event(rates, closed, workspace.scale[0], dt), -1, 2.0, 0
        if chosen >= 0 and at(rates.overlap, chosen) <= 0.0 and at(rates.rate, chosen) < 0.0:
            status, closed = toggled(work, status, chosen)  # opened by rounding, or by another event at the same time
            again, events = True, events + 1
            if events > EVENTS_PER_CONTACT * (bodies - 1):
                return CHATTER, row if every > 0 else done
            continue
        while True:
            attempts += 1
            if attempts > _ATTEMPTS or not dt > resolution * (1.0 + drive.beta * t):
                return STEP_TOO_SMALL, row if every > 0 else done
            variable, q, h, shorter, pace = new_variable(values, closed, chosen), 0.0, dt, False, 1.0
            if chosen >= 0:
                q = distance_root(at(rates.overlap, chosen), power)
                pace, _, _ = powers(power, q)
                h, shorter = size_in_x(power, q, at(rates.rate, chosen), dt)
            start, rejected = Point(point.u, point.w, with_first(splat(t), q)), False
            while True:
                error, end, end_rates = attempt(values, driver, work, variable, start, rates, h, units)
                counts[EVALUATIONS] += STAGES
                if error <= 1.0:
                    break
                counts[REJECTED] += 1
                factor, rejected = _SHRINK, True  # an overflow: x covers far more time than it should
                if isfinite(error):
                    factor = max(_SHRINK, _AGAIN * rough_sixteenth(error))
                elif dt < _HOPELESS:
                    return NOT_FINITE, row if every > 0 else done
                h, dt = h * factor, dt * factor
                if not dt > resolution * (1.0 + drive.beta * t):
                    return STEP_TOO_SMALL, row if every > 0 else done
            end_pace, end_time = 1.0, at(end.clock, TIME)
            if chosen >= 0:
                end_pace, _, _ = powers(power, at(end.clock, ROOT))
            step = Taken(variable, h, rates, end, end_rates, pace, end_pace)
            crossed, turned = changes_in(step, status, bodies - 1)
            changes = crossed | turned != 0
            ready = changes or (g + 1) * spacing <= end_time + PERIOD_END * period
            exceeds = False
            if every > 0:
                at_end = end_forces(values, driver, end, end_rates, last)
                if not ready:
                    exceeds = may_exceed(in_x(forces, pace), in_x(at_end, end_pace), h, out.log.peaks)
            if ready or exceeds:
                prepare_dense_rows(values, driver, work, variable, start, end, h)
                counts[EVALUATIONS] += DENSE_EVALUATIONS
            if changes:
                contact, x = first_change(slots, work, step, status, crossed, turned)
            if contact < 0 or contact == chosen or (status >> contact) & 1 == 0 or x == 0.0:
                break
            chosen, contact, x = contact, -1, 2.0  # a release that the step did not aim at
            counts[REJECTED] += 1
            if attempts > 2:
                dt *= 0.5
        x = min(x, 1.0)
        if contact >= 0:
            end_time = time_inside(work, x)
        passed = 0
        while done + passed < points and (g + passed + 1) * spacing <= end_time + PERIOD_END * period:
            passed += 1
        if done + passed == points:
            end_time = (g + passed) * spacing
            fraction = fraction_at(work, end_time, x)
            if fraction < x:
                contact, x = -1, fraction
        cut = contact >= 0 or done + passed == points
        idle = idle + 1 if contact < 0 and end_time <= t else 0
        if idle > _ATTEMPTS:
            return STEP_TOO_SMALL, row if every > 0 else done
        if cut:
            end = point_inside(work, start, x)
            end_rates = rates_at(values, driver, time_variable(values, closed), end)
            counts[EVALUATIONS] += 1
        if every > 0:
            if cut:
                at_end = end_forces(values, driver, end, end_rates, last)
                if chosen >= 0:
                    end_pace, _, _ = powers(power, at(end.clock, ROOT))
            first_forces, last_forces = in_x(forces, pace), in_x(at_end, end_pace)
            if ready:
                exceeds = may_exceed(first_forces, last_forces, x * h, out.log.peaks)
            if exceeds:
                search_forces(slots, work, first_forces, last_forces, x, x * h, out)
            forces = at_end
            for number in range(g + 1, g + 1 + passed):
                if number % every == 0:
                    inside = point_inside(work, start, fraction_at(work, number * spacing, x))
                    keep_state(work, inside, rates_at(values, driver, time_variable(values, closed), inside))
                    keep(slots, row, work.state[DISPLACEMENT], work.state[VELOCITY], work.state[ELASTIC], samples)
                    row += 1
            out.log.counts[SAMPLE] = row - 1
        if not (cut and x < 0.5):
            most = _GROW if error > _SMALL**2 else _GROW_FAST
            dt *= min(1.0 if rejected or shorter else most, _SAFETY * rough_sixteenth(max(error, 1e-24)))
        g, done, t, point, rates, again = g + passed, done + passed, end_time, end, end_rates, contact >= 0
        counts[STEPS] += 1
        if contact >= 0:
            events += 1
            counts[EVENTS] += 1
            if events > EVENTS_PER_CONTACT * (bodies - 1):
                return CHATTER, row if every > 0 else done
            status, closed = toggled(work, status, contact)
            if (status >> contact) & 1 != 0 and every > 0:
                note_closing(slots.dissipation, at(rates.rate, contact), contact, last, drive.beta * t, out.log)
        if t >= period:
            t, g, events, again = t - period, g - grid, 0, True
    store(work.state, DISPLACEMENT, point.u)
    store(work.state, VELOCITY, point.w)
    for i in range(1, bodies - 1):
        y[i], y[bodies + i] = work.state[DISPLACEMENT, i], work.state[VELOCITY, i]
    workspace.next_step[0] = dt
    evaluate(slots, drive.beta, t, y, workspace.k[0], workspace.forces)
    if first_not_finite(y, bodies) != 0:
        return NOT_FINITE, row if every > 0 else done
    return DONE, row if every > 0 else done
