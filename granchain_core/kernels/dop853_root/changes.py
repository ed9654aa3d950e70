"""The time transformation and size of the next step, and the contacts that open or close in an accepted step."""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

from ..compiling.jit import inline_llvm, inline_numba, internal
from ..contact_cubic import hermite_turn, hermite_value, turns
from ..flow.event_time import nonnegative_root
from ..simd.sums import largest_of
from ..simd.vector import at, lowest_bit, positive_mask
from .inside import change_before, load_distance, turn_of

#: [step size] dop853-root: time is transformed if the contact's nearest event, at its present speed, is at most this
#: many steps away.
_MOST_STEPS_AWAY = 1.5
#: [no threshold] Added to speeds to avoid division by zero.
_LEAST_SPEED = 1e-300
#: [no threshold] Added to the time to the event of an open contact, so that it is never the nearest.
_OPEN_AWAY = 1e30
#: [step size] dop853-root: a contact that moves less than this part of the largest displacement in a step is at rest.
#: The time is not transformed for it.
_REST_DISPLACEMENT = 1e-9
#: [step size] dop853-root: length of the first step after a closing, and of the last before an opening, as a part of
#: the step in t. This number and those above and below were found by measurement. Over seven motions of section 2 and
#: of the rig, 0.06 to 0.2 here and 0.7 to 2.5 steps away above change the number of evaluations for an error of 1e-8 by
#: at most 7 %, up or down.
_STEP_PART_NEXT_TO_EVENT = 0.12
#: [step size] dop853-root: a step that would reach this part of the way to an opening goes beyond it.
_OPENING_PART = 0.8
#: [step size] dop853-root: length of such a step, relative to the way to the opening.
_OPENING_FACTOR = 1.3
#: [step size] dop853-root: a step is searched for a touch if the cubic's rise above its two ends, enlarged by this
#: part, reaches 0.
_MISSED_PART = 0.25


class StepInXi(NamedTuple):
    """An accepted step in ξ: its time transformation, size, start and end, with rates and dt/dξ at both.

    `error_squared` is the square of its error in units of the tolerance, as returned by `try_step` (step.py). `limited`
    is true if the step was repeated, or shortened next to an event, so that the next one should not be longer.
    """

    transform: Any
    h: float
    start: Any
    rates: Any
    dt_dxi: float
    end: Any
    end_rates: Any
    end_dt_dxi: float
    error_squared: float
    limited: bool


@internal
def size_in_xi(power, q, speed, dt):
    """Return the size of a step in ξ for a step dt in time, limited next to an event, and whether it was limited.

    The contact has the root q and the rate `speed`, which is not zero.
    """
    h, reach = inf, q**power + speed * dt
    if reach > 0.0:
        end = nonnegative_root(reach, power)
        h = 2.0 * dt / (q + end) if power == 2 else 4.0 * dt / ((q + end) * (q * q + end * end))
    if speed < 0.0 and -speed * h > _OPENING_PART * power * q:
        h = _OPENING_FACTOR * power * q / -speed
    most = power * nonnegative_root(_STEP_PART_NEXT_TO_EVENT * dt * abs(speed), power) / abs(speed)
    return min(h, most), h > most


@inline_llvm
def nearest_event(rates, closed, scale, dt):
    """The closed contact whose closing or opening is nearest in time, past or future; −1 if none is near enough.

    Near enough is within `_MOST_STEPS_AWAY` steps dt.
    """
    speed, at_rest = abs(rates.rate), _REST_DISPLACEMENT * scale
    time_to_event = (abs(rates.overlap) + at_rest) / (speed + _LEAST_SPEED) + _OPEN_AWAY * (1.0 - closed)
    nearest = -largest_of(-time_to_event)
    contact = lowest_bit(~positive_mask(time_to_event - nearest))
    return contact if nearest < _MOST_STEPS_AWAY * dt and at(speed, contact) * dt > at_rest else -1


@internal
def may_touch(d0, s0, d1, s1):
    """Whether a distance that is negative at both ends of a step, with slopes s0 and s1, may be positive in between.

    The cubic through both ends decides, with a margin for its error in an accepted step.
    """
    if not (s0 > 0.0 and s1 < 0.0):
        return False
    x = hermite_turn(d0, s0, d1, s1)
    top = hermite_value(d0, s0, d1, s1, x)
    return top + _MISSED_PART * (top - max(d0, d1)) > 0.0


@inline_numba
def may_change(step, power, bits, turned):
    """Bits of those contacts in `turned` that may have opened or closed within the step and back."""
    left, may = turned, 0
    while left != 0:
        c, left = lowest_bit(left), left & (left - 1)
        sign, s0, s1 = -1.0 if (bits >> c) & 1 != 0 else 1.0, at(step.rates.rate, c), at(step.end_rates.rate, c)
        d0, d1 = at(step.rates.overlap, c), at(step.end_rates.overlap, c)
        s0, s1 = step.dt_dxi * s0, step.end_dt_dxi * s1
        if step.transform.active != 0.0 and c == step.transform.target:
            d0, d1 = at(step.start.q, 0), at(step.end.q, 0)
            s0, s1 = at(step.rates.rate, c) / power, at(step.end_rates.rate, c) / power
        if may_touch(sign * d0, sign * step.h * s0, sign * d1, sign * step.h * s1):
            may |= 1 << c
    return may


@inline_llvm
def changes_in(step, bits, contacts):
    """Bits of the contacts that have opened or closed by the step's end, and of those that have turned in between.

    Bit c of `bits` is 1 if contact c was closed at the start.
    """
    rising, risen, overlap = positive_mask(step.rates.rate), positive_mask(step.end_rates.rate), step.end_rates.overlap
    crossed = (positive_mask(overlap) & ~bits) | (positive_mask(-overlap) & bits)
    turned = turns(bits, rising, risen)
    if step.transform.active != 0.0:
        target = 1 << step.transform.target
        crossed = crossed | target if at(step.end.q, 0) < 0.0 else crossed & ~target
    all_contacts = (1 << contacts) - 1
    return crossed & all_contacts, turned & ~crossed & all_contacts


@inline_numba
def first_event(slots, work, step, bits, crossed, turned):
    """Return (contact, fraction) of the first change in the step, whose dense output is prepared; (−1, 2) if none."""
    first, contact = 2.0, -1
    for c in range(slots.chain.stiffness.size):
        if ((crossed | turned) >> c) & 1 == 0:
            continue
        sign, high, s0 = -1.0 if (bits >> c) & 1 != 0 else 1.0, 1.0, at(step.rates.rate, c)
        is_target = step.transform.active != 0.0 and c == step.transform.target
        load_distance(slots, work, c, is_target, sign)
        if (crossed >> c) & 1 == 0:
            high, top = turn_of(work.polynomial, 1.0)
            if top <= 0.0:
                continue
        x = change_before(work.polynomial, sign * s0 < 0.0, high)
        if x < first:
            first, contact = x, c
    return contact, first
