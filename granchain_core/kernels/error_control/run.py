"""Runs over a range of the grid in steps with error control: samples, closings, largest forces, periods."""

from __future__ import annotations

from typing import NamedTuple

from ..compiling.jit import inline_numba, kernel
from ..effects.energy_account import add_to_account, force_free_loss
from ..equations.motion import copy
from ..forces.largest import SAMPLE, Instant, Span, record_closings
from ..samples import first_not_finite, write_sample
from ..status import CANCELLED, CHATTER, DONE, EVALUATIONS, EVENT_WINDOW, EVENTS_PER_CONTACT, NOT_FINITE
from .force_kinks import leave_force_free
from .force_search import update_forces_in_step
from .located_step import located_step
from .step import GOAL_TOLERANCE, Step, evaluate, new_scale, prepare_dense, stages, write_dense_state


class SampleRange(NamedTuple):
    """The range of a run: `points` points of a grid with `grid` points per period, from number `first` on.

    With `every` = n > 0, every n-th grid point is recorded, including the first; with 0, none is.
    """

    first: int
    points: int
    grid: int
    every: int


@inline_numba
def record_step(step, point, passed, spacing, row, every, samples, out):
    """Record the forces in the accepted step, and every `every`-th of the `passed` grid points after number `point`.

    Returns the next free row of `samples`.
    """
    slots, drive, y, workspace = step.trajectory
    t, h = step.t, step.h
    ready = update_forces_in_step(step, False, out.log.peaks, out.counts)
    for p in range(point + 1, point + 1 + passed):
        if p % every == 0:
            if not ready:
                out.counts[EVALUATIONS] += prepare_dense(workspace, step)
                ready = True
            at = p * spacing
            write_dense_state(step, min(1.0, (at - t) / h))
            lost = force_free_loss(slots.account, slots, y, workspace.probe)
            add_to_account(slots.account, workspace.probe, 0.0, lost)
            evaluate(slots, drive.beta, at, workspace.probe, workspace.slope, workspace.forces)
            write_sample(slots, row, workspace.probe, workspace.slope, workspace.forces.e, samples)
            row += 1
    out.log.counts[SAMPLE] = row - 1
    end = Instant(workspace.end, workspace.k[stages(workspace)])
    record_closings(slots.dissipation, slots, Instant(y, workspace.k[0]), end,
                    Span(h, drive.beta * t, drive.beta * h), out.log)
    return row


@inline_numba
def accept(trajectory):
    """Make the step's end the state; return whether its slope must be evaluated again."""
    slots, _, y, workspace = trajectory
    lost = force_free_loss(slots.account, slots, y, workspace.end)
    copy(workspace.end, y)
    copy(workspace.k[stages(workspace)], workspace.k[0])
    add_to_account(slots.account, y, 0.0, lost)
    changed = leave_force_free(slots.tension, trajectory)
    new_scale(y, workspace, slots.chain.inverse_mass.size)
    return changed


@kernel
def run_error_controlled(method, trajectory, sample_range, samples, out):
    """Run over a range of the grid; its samples, closings and largest forces are recorded if `every` is above 0.

    Row 0 of `samples` is the start. Returns (status, samples filled), or (status, points done) if nothing is recorded.
    """
    slots, drive, y, workspace = trajectory
    first, points, grid, every = sample_range
    bodies, period, spacing = slots.chain.inverse_mass.size, drive.period, drive.period / grid
    point, done, row, events = first, 0, 1, 0
    t = since = point * spacing
    evaluate(slots, drive.beta, t, y, workspace.k[0], workspace.forces)
    if every > 0:
        write_sample(slots, 0, y, workspace.k[0], workspace.forces.e, samples)
    while done < points:
        if out.stop[0] != 0:
            return CANCELLED, row if every > 0 else done
        goal = min(grid, point + points - done)
        limit = period if goal == grid else goal * spacing
        status, h, contact = located_step(method, trajectory, t, limit, out.counts)
        if status != DONE:
            return status, row if every > 0 else done
        end = limit if limit - (t + h) < GOAL_TOLERANCE * period else t + h
        if t - since > EVENT_WINDOW:
            events, since = 0, t
        events += contact >= 0
        if events > EVENTS_PER_CONTACT * (bodies - 1):
            return CHATTER, row if every > 0 else done
        passed = 0
        while done + passed < points and (point + passed + 1) * spacing <= end + GOAL_TOLERANCE * period:
            passed += 1
        if every > 0:
            row = record_step(Step(trajectory, t, h), point, passed, spacing, row, every, samples, out)
        point, done = point + passed, done + passed
        changed = accept(trajectory)
        t = end
        if end == period:
            t, point, events, since = 0.0, 0, 0, 0.0
        if changed or end == period:
            evaluate(slots, drive.beta, t, y, workspace.k[0], workspace.forces)
        if first_not_finite(y, bodies) != 0:
            return NOT_FINITE, row if every > 0 else done
    return DONE, row if every > 0 else done
