"""Steps with error control that end where a contact opens or closes, or where a cut force has a kink.

The slope is continuous across an event, but its derivative is not. After a closing, the solution has a term in
(t − t_e)^{5/2}: no method for smooth equations keeps its order there. So every contact event inside a step is located
on the dense output, the step is repeated so that it ends just past the event, and the next step starts small.
"""

from __future__ import annotations

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_numba, internal
from ..effects.preload import overlap
from ..effects.tension import TensionCut
from ..status import DONE, EVALUATIONS, EVENTS, STEPS
from .bracket import may_turn, value_at
from .force_kinks import KINK, WRONG_SIDE, enter_force_free, first_kink
from .step import Overlap, Step, accepted_in_t, attempt, crossing, is_too_small, prepare_dense, stages, turning_point

#: [step size] dop853: target overlap just past an event, in units of the largest displacement: a few rounding errors.
_OVERLAP_AIM = 1e-15
#: [step size] dop853: an overlap past the event is accepted up to this many times the target. The event's time is then
#: as accurate as the approach speed allows.
_ACCEPTED_FACTOR = 4.0
#: [step size] dop853, tension cut: target overlap just past an event. A force-free contact may linger at δ = 0 and
#: would chatter with a smaller target.
_OVERLAP_AIM_CUT = 1e-14
#: [step size] dop853, tension cut: an overlap past the event is accepted up to this many times the target.
_ACCEPTED_FACTOR_CUT = 100.0
#: [step size] dop853: most corrections of a step that must end at an event. They are Newton steps for one root, which
#: double the number of correct digits.
_MOST_CORRECTIONS = 6
#: [step size] dop853: a step that must end at an event may become longer by this factor.
_EVENT_STRETCH = 1.01
#: [step size] dop853: an event closer to the step's end than this part of the step is located without first shortening
#: the step.
_NEAR_END = 1e-9
#: [step size] dop853: first step after an event over tolerance^{2/5}. With the elastic force and the linear dashpot,
#: the solution has a term (t − t_e)^{5/2} after a closing, so the error of this step is about the tolerance.
_FIRST_STEP_FACTOR = 2.0


@inline_numba
def first_event(step, counts):
    """Return (contact, fraction) of the first opening or closing inside the accepted step; (−1, 2) if there is none.

    Events closer to t than the resolution of the time are ignored (`is_too_small`).
    """
    slots, drive, y, workspace = step.trajectory
    t, h, k = step.t, step.h, workspace.k
    end = k[stages(workspace)]
    contact, first, dense_ready = -1, 2.0, False
    for c in range(slots.chain.stiffness.size):
        d0, d1 = overlap(slots.preload, y, c), overlap(slots.preload, workspace.end, c)
        crossed = (d0 > 0.0) != (d1 > 0.0)
        sign, change = -1.0 if d0 > 0.0 else 1.0, h * (k[0, c] - k[0, c + 1])
        turns = (not crossed) and may_turn(d0, change, d1, h * (end[c] - end[c + 1]), sign)
        if not (crossed or turns):
            continue
        if not dense_ready:
            counts[EVALUATIONS] += prepare_dense(workspace, step)
            dense_ready = True
        signed_overlap, low, high = Overlap(c, sign), 0.0, 1.0
        if crossed and sign * change < 0.0:  # moves away first; after an event d0 is rounding, not a root
            low = turning_point(Overlap(c, -sign), step)
            if value_at(signed_overlap, step, low) > 0.0:
                low = 0.0
        if turns:
            high = turning_point(signed_overlap, step)
            if value_at(signed_overlap, step, high) <= 0.0:
                continue
        root = crossing(signed_overlap, step, low, high)
        if root < first and not is_too_small(root * h, t, drive.beta):
            contact, first = c, root
    return contact, first


@by_slot
def event_tolerance(tension):
    """Target overlap past an event, and the accepted factor. Effect absent: the smallest that rounding allows."""
    return _OVERLAP_AIM, _ACCEPTED_FACTOR


@event_tolerance.of(TensionCut)
def _(tension):
    return _OVERLAP_AIM_CUT, _ACCEPTED_FACTOR_CUT


@inline_numba
def locate_event(method, step, limit, c, counts):
    """Shorten or lengthen a step so that it ends just past the event of contact c.

    Returns its size, and whether the contact has changed at its end. An event that turns out to lie beyond `limit` is
    left to the next step. The same applies if the event is approached so slowly that the step would become long enough
    to pass other events. The target doubles after each correction: rounding may keep the overlap from reaching it.
    """
    slots, _, y, workspace = step.trajectory
    slope = workspace.k[stages(workspace)]
    h, longest = step.h, min(limit - step.t, _EVENT_STRETCH * step.h)
    before = overlap(slots.preload, y, c) > 0.0
    past, near = event_tolerance(slots.tension)
    past *= max(1.0, workspace.scale[0])
    target = -past if before else past
    for _ in range(_MOST_CORRECTIONS):
        d = overlap(slots.preload, workspace.end, c)
        if (d > 0.0) != before and abs(d) < near * abs(target):
            break
        approach = slope[c] - slope[c + 1]
        correction = (target - d) / approach if approach != 0.0 else 0.0
        if correction == 0.0 or abs(correction) > 0.5 * h or h + correction > longest:
            break
        h += correction
        attempt(method, Step(step.trajectory, step.t, h))
        counts[EVALUATIONS] += stages(workspace)
        target *= 2.0
    return h, (overlap(slots.preload, workspace.end, c) > 0.0) != before


@internal
def located_step(method, trajectory, t, limit, counts):
    """Take one accepted step from y at local time t, at most to `limit`; the result is in workspace.end.

    A step is tried. If a contact event or a kink of a force lies inside, the step is shortened to it and tried again,
    until nothing lies before its end. Newton's method then puts the end just past the event (`locate_event`). Contacts
    that rounding put on the wrong side of a kink change sides once (`first_kink`), and the step starts again. Returns
    (status, step taken, contact that changed at its end or −1); workspace.next_step[0] is the next step to try.
    """
    tension, next_step = trajectory.slots.tension, trajectory.workspace.next_step
    h = min(next_step[0], method.largest_step, limit - t)
    enter_force_free(tension, trajectory, t)
    aimed, kinked, skip_wrong_side = -1, False, False
    while True:
        tried = h
        status, h, factor = accepted_in_t(method, trajectory, t, tried, counts)
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
        h, changed = locate_event(method, step, limit, aimed, counts)
        aimed = aimed if changed else -1
        next_step[0] = min(next_step[0], _FIRST_STEP_FACTOR * method.tolerance**0.4)
    elif not kinked and (h < limit - t or factor < 1.0 or next_step[0] <= h):
        next_step[0] = h * factor  # the motion is smooth on both sides of a kink: the next step need not start small
    counts[EVENTS] += aimed >= 0 or kinked
    counts[STEPS] += 1
    return DONE, h, aimed
