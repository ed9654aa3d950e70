"""Event-located, error-controlled integration: DOP853 in w, restarted where a contact opens or closes.

The slope is continuous across an event but its derivative is not, and after an onset the solution has a term
(t − t_e)^{5/2}: no method for smooth equations keeps its order across. So every contact event inside a step is located
on the dense output, the step is repeated so that it ends just past it, and the next one starts small.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.jit import by_slot, inline_numba, internal, kernel
from ..effects.energy_account import add_to_account, force_free_loss
from ..effects.preload import overlap
from ..effects.tension import TensionCut
from ..equations.motion import copy
from ..forces.largest import SAMPLE, Instant, Span, record_closings
from ..samples import first_not_finite, write_sample
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
from .bracket import may_turn, value_at
from .force_kinks import KINK, WRONG_SIDE, enter_force_free, first_kink, leave_force_free
from .force_search import update_forces_in_step
from .step import (
    GOAL_TOLERANCE,
    RESOLUTION,
    Overlap,
    Step,
    attempt,
    crossing,
    evaluate,
    growth,
    interpolate,
    new_scale,
    prepare_dense,
    shrunk,
    turning_point,
)
from .tableau import DENSE_EVALUATIONS, STAGES

#: Overlap aimed at just past an event, in units of the largest displacement: a few roundings.
_OVERLAP_AIM = 1e-15
#: The overlap reached may be this many times larger. The event's time is then as exact as the approach speed allows.
_ACCEPTED_FACTOR = 4.0
#: The same two where tension is cut: a force-free contact may linger at δ = 0 and would chatter with smaller ones.
_OVERLAP_AIM_CUT = 1e-14
_ACCEPTED_FACTOR_CUT = 100.0
#: Most corrections of a step that is to end at an event: Newton's method for one root, which doubles the digits.
_MOST_CORRECTIONS = 6
#: A step that is to end at an event may become longer by this factor.
_EVENT_STRETCH = 1.01
#: An event within this part of a step of its end needs no shorter step before it is located.
_NEAR_END = 1e-9
#: After an event is a term (t − t_e)^{5/2}: the first step is this times tolerance^{2/5}, and errs by about the
#: tolerance.
_STEP_AFTER_EVENT = 2.0


class SampleRange(NamedTuple):
    """What a run covers: `points` points of a grid of `grid` points a period, from number `first` on.

    With `every` = n > 0 each n-th grid point is recorded, the first one too; with 0 none.
    """

    first: int
    points: int
    grid: int
    every: int


@inline_numba
def first_event(step, counts):
    """(contact, fraction) of the first opening or closing inside the accepted step; (−1, 2) if there is none.

    Events closer to t than the resolution of the time within a period are ignored. The resolution at t itself would be
    too fine at the start of a period: steps too small to change the state would follow one another without end.
    """
    slots, drive, y, workspace = step.trajectory
    t, h, k = step.t, step.h, workspace.k
    contact, first, dense_ready = -1, 2.0, False
    for c in range(slots.chain.stiffness.size):
        d0, d1 = overlap(slots.preload, y, c), overlap(slots.preload, workspace.end, c)
        crossed = (d0 > 0.0) != (d1 > 0.0)
        sign = -1.0 if d0 > 0.0 else 1.0
        turns = (not crossed) and may_turn(d0, h * (k[0, c] - k[0, c + 1]), d1,
                                           h * (k[STAGES, c] - k[STAGES, c + 1]), sign)
        if not (crossed or turns):
            continue
        if not dense_ready:
            prepare_dense(step)
            counts[EVALUATIONS] += DENSE_EVALUATIONS
            dense_ready = True
        signed_overlap, high = Overlap(c, sign), 1.0
        if turns:
            high = turning_point(signed_overlap, step)
            if value_at(signed_overlap, step, high) <= 0.0:
                continue
        root = crossing(signed_overlap, step, 0.0, high)
        if root < first and 0.1 * root * h > RESOLUTION * (t + 1.0 / drive.beta):
            contact, first = c, root
    return contact, first


@by_slot
def event_tolerance(tension):
    """Target overlap past an event and the accepted factor. Absent: the smallest that rounding allows."""
    return _OVERLAP_AIM, _ACCEPTED_FACTOR


@event_tolerance.of(TensionCut)
def _(tension):
    return _OVERLAP_AIM_CUT, _ACCEPTED_FACTOR_CUT


@inline_numba
def locate_event(method, step, limit, c, counts):
    """Shorten or lengthen a step so that it ends just past the event of contact c; returns its size.

    An event that turns out to lie beyond `limit` is left to the next step. So is one that is approached so slowly that
    the step would become long enough to pass other events.
    """
    slots, _, y, workspace = step.trajectory
    h, longest = step.h, min(limit - step.t, _EVENT_STRETCH * step.h)
    before = overlap(slots.preload, y, c) > 0.0
    past, near = event_tolerance(slots.tension)
    past *= max(1.0, workspace.scale[0])
    target = -past if before else past
    for _ in range(_MOST_CORRECTIONS):
        d = overlap(slots.preload, workspace.end, c)
        if (d > 0.0) != before and abs(d) < near * abs(target):
            break
        approach = workspace.k[STAGES, c] - workspace.k[STAGES, c + 1]
        correction = (target - d) / approach if approach != 0.0 else 0.0
        if correction == 0.0 or abs(correction) > 0.5 * h or h + correction > longest:
            break
        h += correction
        attempt(method, Step(step.trajectory, step.t, h))
        counts[EVALUATIONS] += STAGES
        target *= 2.0
    return h


@inline_numba
def accepted_step(method, trajectory, t, h, counts):
    """Shrink a step from t until its error is tolerable; returns (status, size, factor for the next one)."""
    while True:
        error = attempt(method, Step(trajectory, t, h))
        counts[EVALUATIONS] += STAGES
        if not np.isfinite(error):
            return NOT_FINITE, h, 1.0
        if error <= 1.0:
            return DONE, h, growth(error)
        counts[REJECTED] += 1
        h = shrunk(h, error)
        if t + 0.1 * h == t:
            return STEP_TOO_SMALL, h, 1.0


@internal
def located_step(method, trajectory, t, limit, counts):
    """One accepted step from y at local time t, at most to `limit`; the result is workspace.end.

    A step is tried. Where a contact event or a kink of a force lies inside, the step is shortened to it and tried
    again, until nothing lies before its end; Newton's method then puts the end just past the event (`locate_event`).
    Contacts that rounding put on the wrong side of a kink change sides once (`first_kink`), and the step begins anew.

    Returns (status, step taken, contact that changed at its end or −1); workspace.next_step[0] is the next step to try.
    """
    tension, next_step = trajectory.slots.tension, trajectory.workspace.next_step
    h = min(next_step[0], method.largest_step, limit - t)
    enter_force_free(tension, trajectory, t)
    aimed, kinked, skip_wrong_side = -1, False, False
    while True:
        tried = h
        status, h, factor = accepted_step(method, trajectory, t, tried, counts)
        if status != DONE:
            return status, h, -1
        step, not_shortened = Step(trajectory, t, h), h == tried
        if not_shortened and (aimed >= 0 or kinked):
            break
        kinked = False
        aimed, x = first_event(step, counts)
        outcome, kink = first_kink(tension, step, min(x, 1.0), counts, skip_wrong_side)
        if outcome == WRONG_SIDE:
            aimed, skip_wrong_side = -1, True
            continue
        if outcome == KINK:
            next_step[0] = min(next_step[0], h * factor)
            aimed, kinked = -1, True
            h *= kink
            continue
        if aimed < 0 or x > 1.0 - _NEAR_END:
            break
        h *= x
    if aimed >= 0:
        h = locate_event(method, step, limit, aimed, counts)
        next_step[0] = min(next_step[0], _STEP_AFTER_EVENT * method.tolerance**0.4)
    elif not kinked and (h < limit - t or factor < 1.0 or next_step[0] <= h):
        next_step[0] = h * factor  # after a kink the motion is smooth on both sides: the next step need not start small
    counts[EVENTS] += aimed >= 0 or kinked
    counts[STEPS] += 1
    return DONE, h, aimed


@inline_numba
def record_step(step, point, passed, spacing, row, every, samples, out):
    """Record the forces in the accepted step, and of the `passed` grid points past number `point` each `every`-th.

    Returns the next free row of `samples`.
    """
    slots, drive, y, workspace = step.trajectory
    t, h = step.t, step.h
    ready = update_forces_in_step(step, False, out.log.peaks, out.counts)
    for p in range(point + 1, point + 1 + passed):
        if p % every == 0:
            if not ready:
                prepare_dense(step)
                out.counts[EVALUATIONS] += DENSE_EVALUATIONS
                ready = True
            at = p * spacing
            interpolate(y, workspace, min(1.0, (at - t) / h))
            lost = force_free_loss(slots.account, slots, y, workspace.probe)
            add_to_account(slots.account, workspace.probe, 0.0, lost)
            evaluate(slots, drive.beta, at, workspace.probe, workspace.slope, workspace.forces)
            write_sample(slots, row, workspace.probe, workspace.slope, workspace.forces.e, samples)
            row += 1
    out.log.counts[SAMPLE] = row - 1
    record_closings(slots.dissipation, slots, Instant(y, workspace.k[0]), Instant(workspace.end, workspace.k[STAGES]),
                  Span(h, drive.beta * t, drive.beta * h), out.log)
    return row


@inline_numba
def accept(trajectory):
    """Make the step's end the state; returns whether its slope must be evaluated anew."""
    slots, _, y, workspace = trajectory
    lost = force_free_loss(slots.account, slots, y, workspace.end)
    copy(workspace.end, y)
    copy(workspace.k[STAGES], workspace.k[0])
    add_to_account(slots.account, y, 0.0, lost)
    changed = leave_force_free(slots.tension, trajectory)
    new_scale(y, workspace, slots.chain.inverse_mass.size)
    return changed


@kernel
def run_dop853(method, trajectory, sample_range, samples, out):
    """Run over a range of the grid; its samples, closings and largest forces are recorded if `every` is above 0.

    Row 0 of `samples` is the start. Returns (status, samples filled); where nothing is recorded, (status, points done).
    """
    slots, drive, y, workspace = trajectory
    first, points, grid, every = sample_range
    bodies, period, spacing = slots.chain.inverse_mass.size, drive.period, drive.period / grid
    point, done, row, events = first, 0, 1, 0
    t = point * spacing
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
            t, point, events = 0.0, 0, 0
        if changed or end == period:
            evaluate(slots, drive.beta, t, y, workspace.k[0], workspace.forces)
        if first_not_finite(y, bodies) != 0:
            return NOT_FINITE, row if every > 0 else done
    return DONE, row if every > 0 else done
