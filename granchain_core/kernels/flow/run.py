"""The flow over whole drive periods, from contact event to contact event, with or without tangents.

If `tangent` is None, no code for tangents is compiled. The events are logged, because the sequence in which contacts
open and close changes where an orbit grazes.
"""

from __future__ import annotations

import numpy as np

from ..compiling.dispatch import by_slot
from ..compiling.jit import internal, kernel
from ..effects.preload import overlap
from ..equations.motion import copy
from ..error_control.step import evaluate, new_scale
from ..samples import first_not_finite
from ..status import CANCELLED, DONE, EVENTS, NOT_FINITE, STEPS, TOO_MANY_EVENTS, TOO_MANY_STEPS
from .event_time import t_at
from .events import flow_step
from .tangent import Tangent, propagate

#: [step size] flow: most steps in one drive period.
_MOST_STEPS = 5_000_000
#: [step size] flow: a step that ends closer to the period's end than this, in periods, ends there. It covers the
#: rounding of a time and of its map to s. `GOAL_TOLERANCE` (error_control/step.py) is larger, because it also covers
#: the times of samples, which are rounded products; here it would only add to the error of the map.
_PERIOD_END = 1e-14


@by_slot
def apply_saltation(tangent, slots, c, closes):
    """Apply the tangents' jump where contact c opens or closes. Effect absent: no tangents, or continuous ones in w."""


apply_saltation.absent_for(Tangent)


@internal
def begin(slots, y, contacts):
    """Mark the contacts that are closed at the start."""
    for c in range(contacts.closed.size):
        contacts.closed[c] = 1 if overlap(slots.preload, y, c) > 0.0 else 0


@internal
def toggle_contact(slots, contacts, tangent, c, t):
    """Close contact c at time t, or open it; return whether it closed."""
    closes = contacts.closed[c] == 0
    contacts.closed[c] = 1 if closes else 0
    apply_saltation(tangent, slots, c, closes)
    row = contacts.logged[0]
    contacts.log[row, 0], contacts.log[row, 1] = c + 1.0 if closes else -c - 1.0, t
    contacts.logged[0] = row + 1
    return closes


@kernel
def run_flow(method, problem, periods, counts, stop):
    """Propagate motion and tangents through whole periods from phase 0.

    Returns (status, periods done, ∫ trace); the log's times count from the first period's start.
    """
    trajectory, contacts, tangent = problem
    slots, drive, y, workspace = trajectory
    bodies, period, trace, last_closing = slots.chain.inverse_mass.size, drive.period, 0.0, -np.inf
    begin(slots, y, contacts)
    contacts.logged[0] = 0
    for p in range(periods):
        t, steps = 0.0, 0
        while t < period:
            steps += 1
            if stop[0] != 0:
                return CANCELLED, p, trace
            if steps > _MOST_STEPS:
                return TOO_MANY_STEPS, p, trace
            evaluate(slots, drive.beta, t, y, contacts.slope_at_start, workspace.forces)
            status, transform, h, contact = flow_step(method, problem, t, last_closing, counts)
            if status != DONE:
                return status, p, trace
            if h > 0.0:
                trace += propagate(tangent, slots, transform, h, contacts)
                copy(workspace.end, y)
                new_scale(y, workspace, bodies)
                end = t_at(transform, h)
                t = period if period - end < _PERIOD_END * period else end
                counts[STEPS] += 1
            if contact >= 0:
                if contacts.logged[0] >= contacts.log.shape[0]:
                    return TOO_MANY_EVENTS, p, trace
                if toggle_contact(slots, contacts, tangent, contact, p * period + t):
                    last_closing = t
                counts[EVENTS] += 1
        last_closing -= period
        if first_not_finite(y, bodies) != 0:
            return NOT_FINITE, p, trace
    return DONE, periods, trace
