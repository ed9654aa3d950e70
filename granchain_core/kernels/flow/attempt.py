"""One attempt at a step of the flow, by DOP853 in a time in which the motion is smooth, and its first event.

The set of closed contacts is part of the state (`FrozenContacts` in the workspace's forces) and does not change within
a step, so that the slopes of motion and tangents do not jump there. A closing is located from the earlier side, where
nothing is singular yet. The time of an opening is estimated; the step ends there, in a time variable that is the root
of the distance from the opening, and Newton's method on the resulting overlap corrects the estimate.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_numba, internal
from ..dop853.step import combine, dense_coefficients, error_norm
from ..dop853.tableau import ALL_STAGES, DENSE_EVALUATIONS, STAGES, C
from ..effects.preload import overlap
from ..equations.motion import Trajectory
from ..error_control.bracket import may_turn, value_at
from ..error_control.step import (
    Overlap,
    crossing,
    drive_phase,
    evaluate,
    is_too_small,
    next_factor,
    shrunk,
    turning_point,
)
from ..status import DONE, EVALUATIONS, NOT_FINITE, REJECTED, STEP_TOO_SMALL
from .event_time import TimeTransform, dt_ds_at, slope_in_s, t_at


class ContactStatus(NamedTuple):
    """State of the contacts during a step.

    `slope_at_start` (M,) is dy/dt at the step's start; `closed` (N+1,) is 1 where a contact is closed. `log`
    (events, 2) has contact + 1, positive for a closing and negative for an opening, and the time of each event;
    `logged` (1,) is the number of events.
    """

    slope_at_start: np.ndarray
    closed: np.ndarray
    log: np.ndarray
    logged: np.ndarray


class FlowProblem(NamedTuple):
    """A trajectory to be followed from contact event to contact event; `tangent` is None without tangents."""

    trajectory: Trajectory
    contacts: ContactStatus
    tangent: Any


class FlowStep(NamedTuple):
    """A step of a trajectory, of size h in s."""

    trajectory: Trajectory
    transform: TimeTransform
    h: float


@drive_phase.of(FlowStep)
def _(step, x):
    return step.trajectory.drive.beta * t_at(step.transform, x * step.h)


@by_slot
def record_stage(tangent, state, slope, stage):
    """Store the displacements of one stage, and its velocities from `slope`, for the tangents.

    Effect absent: nothing.
    """


@internal
def attempt_in_s(method, problem, transform, h):
    """Try a step of size h in s from y; the result is in workspace.end, its slope in t in workspace.slope.

    Returns the error in units of the tolerance.
    """
    trajectory, contacts, tangent = problem
    slots, drive, y, workspace = trajectory
    dt_ds = dt_ds_at(transform, 0.0)
    for i in range(y.size):
        workspace.k[0, i] = dt_ds * contacts.slope_at_start[i]
    record_stage(tangent, y, contacts.slope_at_start, 0)
    for s in range(1, STAGES + 1):
        combine(y, h, workspace.k, s, workspace.end)
        slope_in_s(slots, drive.beta, transform, C[s] * h, workspace.end, s, workspace)
        record_stage(tangent, workspace.end, workspace.slope, s)
    return error_norm(method.tolerance, h, y, workspace, slots.chain.inverse_mass.size)


@inline_numba
def accepted_in_s(method, problem, transform, h, counts):
    """Shrink a step until its error is tolerable; return (status, size, factor for the next step)."""
    rejected = False
    while True:
        error = attempt_in_s(method, problem, transform, h)
        counts[EVALUATIONS] += STAGES
        if not np.isfinite(error):
            return NOT_FINITE, h, 1.0
        if error <= 1.0:
            return DONE, h, next_factor(method, error, rejected)
        counts[REJECTED] += 1
        rejected = True
        h = shrunk(method, h, error)
        if is_too_small(t_at(transform, h) - transform.start, transform.start, problem.trajectory.drive.beta):
            return STEP_TOO_SMALL, h, 1.0


@inline_numba
def prepare_dense_in_s(step):
    """Fill workspace.dense for the step in s from y to workspace.end; restore the end's slope in workspace.slope."""
    slots, drive, y, workspace = step.trajectory
    transform, h = step.transform, step.h
    for s in range(STAGES + 1, ALL_STAGES):
        combine(y, h, workspace.k, s, workspace.stage)
        slope_in_s(slots, drive.beta, transform, C[s] * h, workspace.stage, s, workspace)
    dense_coefficients(h, y, workspace)
    evaluate(slots, drive.beta, t_at(transform, h), workspace.end, workspace.slope, workspace.forces)


@inline_numba
def first_event(problem, transform, h, excluded, counts):
    """Return (contact, fraction) of the first change of any contact but `excluded` in the step; (−1, 2) if none."""
    trajectory, contacts, _ = problem
    slots, _, y, workspace = trajectory
    step, contact, first, ready = FlowStep(trajectory, transform, h), -1, 2.0, False
    dt = t_at(transform, h) - transform.start
    for c in range(contacts.closed.size):
        if c == excluded:
            continue
        was = contacts.closed[c] != 0
        sign = -1.0 if was else 1.0  # the change makes sign·δ positive
        d0, d1 = overlap(slots.preload, y, c), overlap(slots.preload, workspace.end, c)
        start, end = contacts.slope_at_start, workspace.slope
        s0, s1 = dt * (start[c] - start[c + 1]), dt * (end[c] - end[c + 1])
        crossed = was != (d1 > 0.0)
        if not (crossed or may_turn(d0, s0, d1, s1, sign)):
            continue
        if not ready:
            prepare_dense_in_s(step)
            counts[EVALUATIONS] += DENSE_EVALUATIONS + 1
            ready = True
        signed_overlap, low, high = Overlap(c, sign), 0.0, 1.0
        if not crossed:
            high = turning_point(signed_overlap, step)
            if value_at(signed_overlap, step, high) <= 0.0:
                continue
        elif sign * s0 < 0.0 or sign * d0 >= 0.0:  # it moves away first, or has just changed: d0 may be rounding
            low = turning_point(Overlap(c, -sign), step) if sign * s0 < 0.0 else 1.0
            if low == 1.0 or value_at(signed_overlap, step, low) >= 0.0:
                if sign * d0 >= 0.0:
                    return c, 0.0
                low = 0.0
        x = crossing(signed_overlap, step, low, high)
        if x < first:
            contact, first = c, x
    return contact, first
