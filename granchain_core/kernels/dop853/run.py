"""Event-located, error-controlled integration: DOP853 in w, restarted where a contact opens or closes.

The slope is continuous across an event but its derivative is not, and behind an onset the solution has a term
(t − t_e)^{5/2}: no method for smooth equations keeps its order across. So every contact event inside a step is located
on the dense output, the step is repeated to end just past it, and the next one starts small.
"""

from __future__ import annotations

import numpy as np

from ..effects.balance import add_to_account, slack_loss
from ..effects.preload import overlap
from ..effects.tension import NoTension
from ..equations.motion import copy
from ..forces.largest import SAMPLE, note_closings
from ..jit import by_slot, inline_numba, kernel
from ..samples import first_not_finite, keep
from ..status import CANCELLED, CHATTER, DONE, EVALUATIONS, EVENTS, NOT_FINITE, REJECTED, STEP_TOO_SMALL, STEPS
from .bracket import between, narrowed
from .force_kinks import enter_force_free, first_kink, leave_force_free
from .force_search import follow_step
from .step import (
    STAGES,
    attempt,
    dense_value,
    evaluate,
    growth,
    new_scale,
    overlap_inside,
    prepare_dense,
    shrunk,
)

#: Target overlap just past an event, in units of the largest displacement: a few roundings.
_BEHIND = 1e-15
#: Factor by which it may be missed: the time of the event is then as exact as the approach speed allows.
_NEAR = 4.0
#: The same two where tension is cut: a contact without force may linger at δ = 0, which is no chatter.
_BEHIND_CUT = 1e-14
_NEAR_CUT = 100.0
#: A step that is to end at an event may become longer by this factor.
_LONGER = 1.01
#: Spacing of floating-point numbers at 1: how well a time is known, relative to the time since the period began plus a
#: sixth of the period, 1/β.
_RESOLUTION = 2.2e-16
#: No contact opens and closes more often than this in one period unless it chatters.
_EVENTS_PER_CONTACT = 2000


@kernel
def overlap_in_step(slots, beta, t, h, y, work, c, x):
    """δ_c at fraction x of the step from t."""
    return overlap_inside(slots, beta * (t + x * h), y, work, c, x)


@inline_numba
def overlap_root(slots, beta, t, h, y, work, c, low, high):
    """Fraction between `low` and `high` where δ_c changes sign."""
    f_low = overlap_in_step(slots, beta, t, h, y, work, c, low)
    f_high = overlap_in_step(slots, beta, t, h, y, work, c, high)
    x, side = high, 0
    for _ in range(80):
        before = x
        x = between(low, high, f_low, f_high)
        f = overlap_in_step(slots, beta, t, h, y, work, c, x)
        if f == 0.0 or abs(x - before) < 1e-15:
            break
        low, high, f_low, f_high, side = narrowed(low, high, f_low, f_high, side, x, f)
    return x


@inline_numba
def inner_extremum(slots, beta, t, h, y, work, c, sign):
    """Fraction at which sign·δ_c is largest inside the step, by golden section on the dense output."""
    ratio = 0.6180339887498949
    low, high = 0.0, 1.0
    a, b = 1.0 - ratio, ratio
    fa = sign * overlap_in_step(slots, beta, t, h, y, work, c, a)
    fb = sign * overlap_in_step(slots, beta, t, h, y, work, c, b)
    for _ in range(40):
        if fa > fb:
            high, b, fb = b, a, fa
            a = high - ratio * (high - low)
            fa = sign * overlap_in_step(slots, beta, t, h, y, work, c, a)
        else:
            low, a, fa = a, b, fb
            b = low + ratio * (high - low)
            fb = sign * overlap_in_step(slots, beta, t, h, y, work, c, b)
    return 0.5 * (low + high)


@inline_numba
def may_turn(d0, s0, d1, s1, sign):
    """Whether a contact with the same sign at both ends may cross zero in between.

    It must move towards zero first and away last; then the smaller of the two straight continuations bounds how
    near it can come, up to the curvature in a step that the error control accepted.
    """
    if not (sign * s0 > 0.0 and sign * s1 < 0.0):
        return False
    reach = max(sign * (d0 + s0), sign * (d1 - s1))
    return reach > 0.0


@inline_numba
def first_crossing(slots, beta, t, h, y, work, counts):
    """(contact, fraction) of the first opening or closing inside the accepted step; (−1, 2) if there is none.

    Events closer to t than the resolution of a period's time are ignored. That of t itself would be too fine at the
    start of a period: steps too small to change the state would follow each other without end.
    """
    contact, first, dense_ready = -1, 2.0, False
    k = work.k
    for c in range(slots.chain.stiffness.size):
        d0, d1 = overlap(slots.preload, y, c), overlap(slots.preload, work.end, c)
        crossed = (d0 > 0.0) != (d1 > 0.0)
        sign = -1.0 if d0 > 0.0 else 1.0
        turns = (not crossed) and may_turn(d0, h * (k[0, c] - k[0, c + 1]), d1,
                                           h * (k[STAGES, c] - k[STAGES, c + 1]), sign)
        if not (crossed or turns):
            continue
        if not dense_ready:
            prepare_dense(slots, beta, t, h, y, work)
            counts[EVALUATIONS] += 3
            dense_ready = True
        high = 1.0
        if turns:
            high = inner_extremum(slots, beta, t, h, y, work, c, sign)
            if sign * overlap_in_step(slots, beta, t, h, y, work, c, high) <= 0.0:
                continue
        root = overlap_root(slots, beta, t, h, y, work, c, 0.0, high)
        if root < first and 0.1 * root * h > _RESOLUTION * (t + 1.0 / beta):
            contact, first = c, root
    return contact, first


@by_slot
def event_tolerance(tension):
    """Target overlap past an event and the accepted factor. Absent: the smallest that rounding allows."""
    return _BEHIND, _NEAR


@event_tolerance.of(NoTension)
def _(tension):
    return _BEHIND_CUT, _NEAR_CUT


@inline_numba
def locate_event(method, slots, beta, t, h, limit, y, work, c, counts):
    """Shorten or lengthen a step so that it ends just behind the event of contact c; returns its size.

    An event that turns out to lie behind `limit` is left to the next step, and so is one that is approached so slowly
    that the step would grow over other events on the way to it.
    """
    longest = min(limit - t, _LONGER * h)
    before = overlap(slots.preload, y, c) > 0.0
    behind, near = event_tolerance(slots.tension)
    behind *= max(1.0, work.scale[0])
    target = -behind if before else behind
    for _ in range(6):
        d = overlap(slots.preload, work.end, c)
        if (d > 0.0) != before and abs(d) < near * abs(target):
            break
        approach = work.k[STAGES, c] - work.k[STAGES, c + 1]
        change = (target - d) / approach if approach != 0.0 else 0.0
        if change == 0.0 or abs(change) > 0.5 * h or h + change > longest:
            break
        h += change
        attempt(method, slots, beta, t, h, y, work)
        counts[EVALUATIONS] += STAGES
        target *= 2.0
    return h


@inline_numba
def certified_step(method, slots, beta, t, limit, y, work, clock, counts):
    """One accepted step from y at local time t, at most to `limit`; the result is work.end.

    Returns (status, step taken, contact that changed at its end or −1); `clock[0]` is the next step to try.
    """
    h = min(clock[0], method.largest_step, limit - t)
    enter_force_free(slots.tension, slots, beta, t, y, work)
    aimed, kinked, again, factor = -1, False, False, 1.0
    while True:
        error = attempt(method, slots, beta, t, h, y, work)
        counts[EVALUATIONS] += STAGES
        if not np.isfinite(error):
            return NOT_FINITE, h, -1
        if error > 1.0:
            aimed, kinked = -1, False
            counts[REJECTED] += 1
            h = shrunk(h, error)
            if t + 0.1 * h == t:
                return STEP_TOO_SMALL, h, -1
            continue
        factor = growth(error)
        if aimed >= 0 or kinked:
            break
        aimed, x = first_crossing(slots, beta, t, h, y, work, counts)
        kink = first_kink(slots.tension, slots, beta, t, h, y, work, min(x, 1.0), counts, again)
        if kink == 0.0:
            aimed, again = -1, True
            continue
        if kink < 1.0:
            clock[0] = min(clock[0], h * factor)
            aimed, kinked = -1, True
            h *= kink
            continue
        if aimed < 0 or x > 1.0 - 1e-9:
            break
        h *= x
    if aimed >= 0:
        h = locate_event(method, slots, beta, t, h, limit, y, work, aimed, counts)
        clock[0] = min(clock[0], 2.0 * method.tolerance**0.4)
        counts[EVENTS] += 1
    elif kinked:
        counts[EVENTS] += 1  # the motion is smooth on both sides: the next step need not start small
    elif h < limit - t or factor < 1.0 or clock[0] <= h:
        clock[0] = h * factor
    counts[STEPS] += 1
    return DONE, h, aimed


@inline_numba
def look_inside(slots, beta, t, h, at, y, work):
    """The state at local time `at` inside the accepted step from t, in work.probe, and its slope in work.slope."""
    x = min(1.0, (at - t) / h)
    for i in range(y.size):
        work.probe[i] = dense_value(work.dense, y[i], x, i)
    add_to_account(slots.balance, work.probe, 0.0, slack_loss(slots.balance, slots, y, work.probe))
    evaluate(slots, beta, at, work.probe, work.slope, work.forces)


@kernel
def run_certified(method, slots, beta, period, y, work, clock, first, points, grid, every, samples, log, counts,
                  stop):
    """Run over `points` points of a grid of `grid` points a period, starting at grid point `first`.

    With every > 0 the largest forces and closings are recorded in `log`, and each every-th grid point is kept in
    `samples`, whose row 0 is the start; with every = 0 nothing is recorded. Returns (status, rows or points done).
    """
    m = slots.chain.inverse_mass.size
    spacing = period / grid
    g, done, row, events = first, 0, 1, 0
    t = g * spacing
    evaluate(slots, beta, t, y, work.k[0], work.forces)
    if every > 0:
        keep(slots, 0, y, work.k[0], work.forces.e, samples)
    while done < points:
        if stop[0] != 0:
            return CANCELLED, row if every > 0 else done
        goal = min(grid, g + points - done)
        limit = period if goal == grid else goal * spacing
        status, h, contact = certified_step(method, slots, beta, t, limit, y, work, clock, counts)
        if status != DONE:
            return status, row if every > 0 else done
        end = limit if limit - (t + h) < 1e-13 * period else t + h
        events += contact >= 0
        if events > _EVENTS_PER_CONTACT * (m - 1):
            return CHATTER, row if every > 0 else done
        ready, lost = False, slack_loss(slots.balance, slots, y, work.end)
        if every > 0:
            ready = follow_step(slots, beta, t, h, y, work, False, log.peaks, counts)
        while done < points and (g + 1) * spacing <= end + 1e-13 * period:
            g += 1
            done += 1
            if every > 0 and g % every == 0:
                if not ready:
                    prepare_dense(slots, beta, t, h, y, work)
                    counts[EVALUATIONS] += 3
                    ready = True
                look_inside(slots, beta, t, h, g * spacing, y, work)
                keep(slots, row, work.probe, work.slope, work.forces.e, samples)
                row += 1
        if every > 0:
            log.met[SAMPLE] = row - 1
            note_closings(slots.dissipation, slots, y, work.k[0], work.end, work.k[STAGES], beta * t, beta * h, log)
        copy(work.end, y)
        copy(work.k[STAGES], work.k[0])
        add_to_account(slots.balance, y, 0.0, lost)
        changed = leave_force_free(slots.tension, slots, y, work.k[0], work.forces)
        new_scale(y, work, m)
        t = end
        if end == period:
            t, g, events = 0.0, 0, 0
        if changed or end == period:
            evaluate(slots, beta, t, y, work.k[0], work.forces)
        if first_not_finite(y, m) != 0:
            return NOT_FINITE, row if every > 0 else done
    return DONE, row if every > 0 else done
