"""The largest forces of a motion: their suprema over the recorded time, the jumps of closing contacts included.

Equation   F = K δ^{3/2} + g(δ) δ̇. With a linear dashpot, F jumps from 0 to λδ̇ at the instant a contact closes. The
           value after the jump, the right limit, counts: it is often the largest force of all
Method     Between two states, the force is the cubic through its values and slopes at both. At an event, it is
           evaluated on either side, so that nothing is interpolated across a jump or a kink. Methods that do not locate
           events find closings in their own way (crossings.py)
Source     Zhang et al. 2016, eq. (1), for the force; docs/model.md for the definition
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_numba, internal
from ..contact_cubic import hermite_turn, hermite_value
from ..effects.contact import TINY, elastic_force, elastic_slope
from ..effects.dissipation import JUMP_LAWS, SMOOTH_LAWS, closing_force, dashpot_force, dashpot_slope
from ..effects.driver import driver_acceleration
from ..effects.preload import overlap
from ..effects.tension import cut_at_zero
from ..equations.body_forces import force_on_bead
from ..equations.motion import contact_force
from ..simd.functions import positive_part
from ..step_ends import OVERLAP, RATE
from .peaks import INPUT, INPUT_JUMP, OUTPUT, OUTPUT_ELASTIC, OUTPUT_JUMP, PEAKS, row_of

#: The slope of a force is only computed above this part of the largest force so far: a maximum inside a step exceeds
#: the values at its ends by h²/8 times the force's curvature, which is a few per cent.
_SLOPE_COMPUTED_ABOVE = 0.9
#: Bound on the cubic's slope: the largest change of a force in one step, relative to its value. It is needed after a
#: closing, where g may have an infinite slope.
_STEEPEST = 3.0
#: Entries of `ForceLog.counts`: the number of closings with a jump, the number of these that were touches within a step
#: of a method that does not locate events, and the number of the last sample.
CLOSED, UNRESOLVED, SAMPLE = range(3)


class ForceLog(NamedTuple):
    """The forces so far: the largest, those at the last state, and the jumps.

    `peaks` (PEAKS,) contains input, output and elastic output force and the largest jumps (peaks.py); `last` (3, 2) is
    the value and slope of each force at the last state processed. Rows of `closings` (C, 4) are the number of the last
    sample before a contact closed, the drive phase θ, the contact and the force after the jump. `counts` (3,) are the
    numbers CLOSED, UNRESOLVED and SAMPLE.
    """

    peaks: np.ndarray
    last: np.ndarray
    closings: np.ndarray
    counts: np.ndarray


class Instant(NamedTuple):
    """State y (M,) and its slope dy (M,) at one end of a step."""

    y: np.ndarray
    dy: np.ndarray


class Span(NamedTuple):
    """A step's size, the drive phase θ at its start, and the increase of θ in it."""

    h: float
    theta: float
    dtheta: float


def new_log(before: ForceLog | None = None, closings: int = 0) -> ForceLog:
    """Return a log with room for a number of closings; the largest forces continue from an earlier log."""
    peaks, last = (np.zeros(PEAKS), np.zeros((3, 2))) if before is None else (before.peaks, before.last)
    return ForceLog(peaks, last, np.zeros((closings, 4)), np.zeros(3, dtype=np.int64))


@internal
def update_largest(peaks, row, value):
    """Raise one of the largest forces to `value` if `value` is larger."""
    if value > peaks[row]:
        peaks[row] = value


@internal
def force_at_event(slots, y, dy, e, c, event, closed):
    """Total force of contact c; if c is `event`, its one-sided limit at the event. `closed` selects the side."""
    if c != event:
        return contact_force(slots, y, dy, e, c)
    if not closed:
        return 0.0
    return cut_at_zero(slots.tension, closing_force(slots.dissipation, dy[c] - dy[c + 1]))


@internal
def acceleration(slots, y, dy, e, i, event, closed):
    """v̇ of body i."""
    if i == 0:
        return driver_acceleration(slots.driver, y[0])
    if slots.chain.inverse_mass[i] == 0.0:
        return 0.0
    force = force_at_event(slots, y, dy, e, i - 1, event, closed) - force_at_event(slots, y, dy, e, i, event, closed)
    return slots.chain.inverse_mass[i] * force_on_bead(slots, i, force, y[i], dy[i])


@internal
def force_slope(slots, y, dy, e, c, event, closed):
    """Ḟ = (3/2) K √δ δ̇ + g'(δ) δ̇² + g(δ) δ̈ of contact c; 0 where it is open."""
    d, rate = positive_part(overlap(slots.preload, y, c)), dy[c] - dy[c + 1]
    if c == event:
        d = TINY if closed else 0.0
    left, right = acceleration(slots, y, dy, e, c, event, closed), acceleration(slots, y, dy, e, c + 1, event, closed)
    return elastic_slope(slots.chain.stiffness[c], d) * rate + dashpot_slope(slots.dissipation, d, rate, left - right)


@internal
def cubic_top(f0, s0, f1, s1, h):
    """Largest value of the cubic with values f0, f1 and slopes s0, s1 at the ends of a step of size h."""
    largest = max(f0, f1)
    if not (s0 > 0.0 and s1 < 0.0):
        return largest
    most = _STEEPEST * largest
    a, b = min(h * s0, most), max(h * s1, -most)
    x = hermite_turn(f0, a, f1, b)
    return max(largest, hermite_value(f0, a, f1, b, x))


@internal
def update_maximum(log, q, value, slope, h):
    """Update the maximum of force q over the step of size h."""
    peaks, last = log.peaks, log.last
    row = row_of(q)
    update_largest(peaks, row, cubic_top(last[q, 0], last[q, 1], value, slope, h) if h > 0.0 else value)
    last[q, 0], last[q, 1] = value, slope


@internal
def update_forces_at_event(slots, y, dy, e, h, event, closed, log):
    """Update the largest forces over the last h before state y, whose slope is dy; h = 0 starts a new interval at y."""
    last = e.size - 1
    for q in range(2):
        c = 0 if q == 0 else last
        value, slope = force_at_event(slots, y, dy, e, c, event, closed), np.nan
        if value > _SLOPE_COMPUTED_ABOVE * log.peaks[row_of(q)]:
            slope = force_slope(slots, y, dy, e, c, event, closed)
        update_maximum(log, q, value, slope, h)
    d = 0.0 if event == last else positive_part(overlap(slots.preload, y, last))
    stiffness, slope = slots.chain.stiffness[last], np.nan
    value = elastic_force(stiffness, d)
    if value > _SLOPE_COMPUTED_ABOVE * log.peaks[OUTPUT_ELASTIC]:
        slope = elastic_slope(stiffness, d) * (dy[last] - dy[last + 1])
    update_maximum(log, 2, value, slope, h)


@internal
def update_forces(slots, y, dy, e, h, log):
    """`update_forces_at_event` where no contact changes; without slopes where no force can be near a maximum."""
    last, peaks = e.size - 1, log.peaks
    input_force, output_force = contact_force(slots, y, dy, e, 0), contact_force(slots, y, dy, e, last)
    elastic = elastic_force(slots.chain.stiffness[last], positive_part(overlap(slots.preload, y, last)))
    if (input_force > _SLOPE_COMPUTED_ABOVE * peaks[INPUT] or output_force > _SLOPE_COMPUTED_ABOVE * peaks[OUTPUT]
            or elastic > _SLOPE_COMPUTED_ABOVE * peaks[OUTPUT_ELASTIC]):
        update_forces_at_event(slots, y, dy, e, h, -1, False, log)
    else:
        log.last[0, 0], log.last[1, 0], log.last[2, 0] = input_force, output_force, elastic
        log.last[0, 1] = log.last[1, 1] = log.last[2, 1] = np.nan


@internal
def update_forces_across_event(slots, y, dy, e, h, c, theta, log):
    """Update the largest forces up to the event of contact c at drive phase θ, and start a new interval after it."""
    rate = dy[c] - dy[c + 1]
    update_forces_at_event(slots, y, dy, e, h, c, rate < 0.0, log)
    update_forces_at_event(slots, y, dy, e, 0.0, c, rate > 0.0, log)
    record_closing(slots.dissipation, rate, c, e.size - 1, theta, log)


@inline_numba
def update_end_forces_at_event(slots, ends, c, theta, log):
    """Raise the largest forces to those at the event of contact c; overlaps and rates are in `ends` (step_ends.py)."""
    last = slots.chain.stiffness.size - 1
    for q in range(2):
        contact = 0 if q == 0 else last
        delta = ends[OVERLAP, contact]
        force = elastic_force(slots.chain.stiffness[contact], positive_part(delta))
        update_largest(log.peaks, row_of(q), force + dashpot_force(slots.dissipation, delta, ends[RATE, contact]))
        if q == 1:
            update_largest(log.peaks, OUTPUT_ELASTIC, force)
    record_closing(slots.dissipation, ends[RATE, c], c, last, theta, log)


@by_slot
def record_closing(law, rate, c, last, theta, log):
    """Record the jump of contact c, which closes at `rate` at drive phase θ. Effect absent, or g(0) = 0: no jump."""


@record_closing.of(*JUMP_LAWS)
def _(law, rate, c, last, theta, log):
    if rate > 0.0:
        force = closing_force(law, rate)
        if c == 0:
            update_largest(log.peaks, INPUT, force)
            update_largest(log.peaks, INPUT_JUMP, force)
        if c == last:
            update_largest(log.peaks, OUTPUT, force)
            update_largest(log.peaks, OUTPUT_JUMP, force)
        number = log.counts[CLOSED]
        log.counts[CLOSED] = number + 1
        if number < log.closings.shape[0]:
            row = log.closings[number]
            row[0], row[1], row[2], row[3] = log.counts[SAMPLE], theta, c, force


@by_slot
def record_closings(law, slots, start, end, span, log):
    """Record the contacts that closed in a located step between two instants. Effect absent: no force jumps there.

    The step ends just past an event. An event too close to the step's start to be distinguished from it counts as being
    at the start.
    """


@record_closings.of(*JUMP_LAWS)
def _(law, slots, start, end, span, log):
    last = slots.chain.stiffness.size - 1
    for c in range(last + 1):
        before, after = overlap(slots.preload, start.y, c), overlap(slots.preload, end.y, c)
        if before <= 0.0 and after > 0.0:
            if after < -before:
                record_closing(law, end.dy[c] - end.dy[c + 1], c, last, span.theta + span.dtheta, log)
            else:
                record_closing(law, start.dy[c] - start.dy[c + 1], c, last, span.theta, log)


record_closing.absent_for(*SMOOTH_LAWS)
record_closings.absent_for(*SMOOTH_LAWS)
