"""Event location for the flow: steps that end at an opening, at a closing, or at neither.

A step returns (status, transform, size, contact that changed at its end or −1); its final state is in workspace.end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.jit import inline_numba, internal
from ..dop853.tableau import STAGES
from ..effects.preload import overlap
from ..error_control.step import is_too_small, shrunk
from ..status import DONE, EVALUATIONS, NOT_FINITE, OPENING_MISSED, REJECTED, STEP_TOO_SMALL
from .attempt import accepted_in_s, attempt_in_s, first_event
from .event_time import AFTER, BEFORE, PLAIN, dt_ds_at, size_in_s, smooth_power, t_at, transform_from

#: [step size] flow: largest overlap at a located event, in units of the largest displacement: a few rounding errors.
_LARGEST_EVENT_OVERLAP = 1e-14
#: [step size] flow: a step aims at the next opening if it is at most this many step sizes away.
_OPENING_STEPS = 1.5
#: [step size] flow: most attempts to locate one event.
_LOCATION_ATTEMPTS = 8
#: [step size] flow: most attempts to take one step.
_STEP_ATTEMPTS = 60
#: [step size] flow: shortest next step to try, in t. Two events that rounding places at nearly the same time cannot
#: make it shorter.
_SHORTEST_STEP = 1e-9
#: [step size] flow: the first step after a closing covers at most this part of the time to the next opening.
_FIRST_STEP_PART = 0.5


@inline_numba
def next_opening(slots, y, contacts):
    """Return (contact, time left) of the nearest opening at present speeds; (−1, ∞) if no contact opens."""
    contact, first = -1, np.inf
    for c in range(contacts.closed.size):
        if contacts.closed[c] != 0:
            speed = contacts.slope_at_start[c] - contacts.slope_at_start[c + 1]
            d = overlap(slots.preload, y, c)
            if speed < 0.0 and d > 0.0 and -d / speed < first:
                contact, first = c, -d / speed
    return contact, first


@inline_numba
def locate_change(method, problem, transform, h, c, counts):
    """Repeat a step, first with size h, until it ends where contact c opens or closes; return the size.

    The first size is the root on the dense output, and Newton's method improves it. Where the bodies hardly move
    relative to each other, near a grazing, Newton's method would diverge. The step then ends at the root of the dense
    output.
    """
    slots, _, _, workspace = problem.trajectory
    attempt_in_s(method, problem, transform, h)
    counts[EVALUATIONS] += STAGES
    for _ in range(_LOCATION_ATTEMPTS):
        d = overlap(slots.preload, workspace.end, c)
        speed = (workspace.slope[c] - workspace.slope[c + 1]) * dt_ds_at(transform, h)
        located = abs(d) <= _LARGEST_EVENT_OVERLAP * max(1.0, workspace.scale[0])
        if located or speed == 0.0 or abs(d) > 0.5 * h * abs(speed):
            break
        if h - d / speed == h:
            break
        h -= d / speed
        attempt_in_s(method, problem, transform, h)
        counts[EVALUATIONS] += STAGES
    return h


@inline_numba
def step_to_opening(method, problem, t, goal, c, counts):
    """Step from t towards the opening of contact c, estimated at `goal`: onto it, or part of the way.

    Returns (status, transform, size, c or −1); the status is OPENING_MISSED if the contact does not open there.
    """
    slots, drive, _, workspace = problem.trajectory
    power, farthest = smooth_power(slots.dissipation), goal + 3.0 * (goal - t)
    transform = transform_from(BEFORE, goal, t, power)
    error, located = np.inf, False
    for _ in range(_LOCATION_ATTEMPTS):
        error = attempt_in_s(method, problem, transform, transform.s)
        counts[EVALUATIONS] += STAGES
        if not np.isfinite(error):
            return NOT_FINITE, transform, 0.0, -1
        d, speed = overlap(slots.preload, workspace.end, c), workspace.slope[c] - workspace.slope[c + 1]
        if not speed < 0.0:
            return OPENING_MISSED, transform, 0.0, -1
        located = abs(d) <= _LARGEST_EVENT_OVERLAP * max(1.0, workspace.scale[0]) or goal - d / speed == goal
        if located:
            break
        goal -= d / speed
        if not t < goal < farthest:
            return OPENING_MISSED, transform, 0.0, -1
        transform = transform_from(BEFORE, goal, t, power)
    if not located:
        return OPENING_MISSED, transform, 0.0, -1
    h = size_in_s(transform, min(goal, drive.period) - t)
    if goal > drive.period:
        located = False
        error = attempt_in_s(method, problem, transform, h)
        counts[EVALUATIONS] += STAGES
    while error > 1.0:
        located = False
        counts[REJECTED] += 1
        h = shrunk(method, h, error)
        if is_too_small(t_at(transform, h) - t, t, drive.beta):
            return STEP_TOO_SMALL, transform, h, -1
        error = attempt_in_s(method, problem, transform, h)
        counts[EVALUATIONS] += STAGES
    return DONE, transform, h, c if located else -1


class Aim(NamedTuple):
    """The opening at which a step aims: contact `target` at the estimated time `goal`, if `active`.

    `lost` is true once an opening was aimed at in vain; after that, the step aims at no other.
    """

    active: bool
    target: int
    goal: float
    lost: bool


@inline_numba
def first_aim(slots, y, contacts, t, dt, last_closing):
    """The `Aim` of a step's first attempt: the nearest opening, if it is near and no contact has just closed."""
    target, wait = next_opening(slots, y, contacts)
    return Aim(target >= 0 and wait < _OPENING_STEPS * dt and t > last_closing, target, t + wait, False)


@inline_numba
def tried_step(method, problem, t, transform, h, aim, counts):
    """Take an accepted step from t, of size h in s at most, or towards the opening of `aim`.

    Returns (status, transform, size, contact that opens at its end or −1, factor for the next step).
    """
    if aim.active:
        status, transform, h, located = step_to_opening(method, problem, t, aim.goal, aim.target, counts)
        return status, transform, h, located, 1.0
    status, h, factor = accepted_in_s(method, problem, transform, h, counts)
    return status, transform, h, -1, factor


@internal
def flow_step(method, problem, t, last_closing, counts):
    """Take one accepted step from y at local time t, at most to the period's end; `last_closing` is a time (−∞: none).

    Each attempt is an accepted step (`tried_step`) and the first contact that changes in it (`first_event`). If no
    contact changes, the attempt is the step. If one closes, the step ends there (`locate_change`). If one opens, the
    next attempt aims at that opening. But if a contact has closed at t, the step needs the time variable of that
    closing; it is then made shorter instead.

    Returns (status, transform, size, contact); size 0 with a contact means that it changes at t itself, or so soon that
    the time does not resolve it.
    workspace.next_step[0] is the next step to try, in t.
    """
    trajectory, contacts, _ = problem
    slots, drive, y, workspace = trajectory
    next_step, limit = workspace.next_step, drive.period
    dt = min(next_step[0], method.largest_step, limit - t)
    aim = first_aim(slots, y, contacts, t, dt, last_closing)
    usual = transform_from(AFTER if last_closing > -np.inf else PLAIN, last_closing, t, smooth_power(slots.dissipation))
    transform, h = usual, size_in_s(usual, dt)
    for _ in range(_STEP_ATTEMPTS):
        status, transform, h, located, factor = tried_step(method, problem, t, transform, h, aim, counts)
        if status == OPENING_MISSED:
            aim, transform, h = Aim(False, -1, t, True), usual, size_in_s(usual, dt)
            continue
        if not aim.active:
            dt = min(dt, t_at(transform, h) - t)
        if status != DONE:
            return status, transform, h, -1
        contact, x = first_event(problem, transform, h, located, counts)
        if contact < 0:
            if not aim.active:
                next_step[0] = next_dt(transform, h, factor, next_step[0], limit)
            if located < 0 and t_at(transform, h) <= t:
                return STEP_TOO_SMALL, transform, h, -1
            return DONE, transform, h, located
        if t_at(transform, x * h) <= t:
            return DONE, transform, 0.0, contact
        if contacts.closed[contact] == 0 or aim.lost:
            return DONE, transform, locate_change(method, problem, transform, h * x, contact, counts), contact
        if t > last_closing:
            aim = Aim(True, contact, t_at(transform, x * h), False)
        else:
            h *= _FIRST_STEP_PART * x
            dt = t_at(transform, h) - t
    return STEP_TOO_SMALL, transform, h, -1


@inline_numba
def next_dt(transform, h, factor, before, limit):
    """The next step in t after an accepted one of size h in s; no shorter than before if only the limit cut that."""
    end = t_at(transform, h)
    dt = t_at(transform, h + h * factor) - end
    return max(dt, before, _SHORTEST_STEP) if end >= limit else max(dt, _SHORTEST_STEP)
