"""The flow over whole drive periods, contact event by contact event, with the tangents one asks for.

With `tangent` None there is no code for tangents. The events are written into a log: the sequence in which contacts
open and close is what changes where an orbit grazes.
"""

from __future__ import annotations

import numpy as np

from .dop853 import new_scale
from .effects.preload import overlap
from .jit import kernel
from .landing import flow_step
from .motion import copy
from .root_time import held_slope, time_at
from .sampling import CANCELLED, CHATTER, DONE, NOT_FINITE, first_not_finite
from .tangent import carry

#: Overlaps below this, in units of the largest displacement, are those of contacts that change at the same moment.
_SAME = 2e-14


@kernel
def begin(slots, y, path):
    """Which contacts are closed at the start."""
    for c in range(path.closed.size):
        path.closed[c] = 1 if overlap(slots.preload, y, c) > 0.0 else 0


@kernel
def note(path, c, t):
    """Change contact c at time t; returns whether it closed."""
    closes = path.closed[c] == 0
    path.closed[c] = 1 if closes else 0
    row = path.logged[0]
    path.log[row, 0], path.log[row, 1] = c + 1.0 if closes else -c - 1.0, t
    path.logged[0] = row + 1
    return closes


@kernel
def change(slots, y, work, path, c, t):
    """Change contact c, and with it all that touch or part at the very same moment; returns whether any closed."""
    closed = note(path, c, t)
    nearest = _SAME * max(1.0, work.scale[0])
    for other in range(path.closed.size):
        if other == c or abs(overlap(slots.preload, y, other)) > nearest or path.logged[0] >= path.log.shape[0]:
            continue
        speed = work.slope[other] - work.slope[other + 1]
        if (path.closed[other] == 0 and speed > 0.0) or (path.closed[other] != 0 and speed < 0.0):
            closed = note(path, other, t) or closed
    return closed


@kernel
def run_flow(method, slots, beta, period, periods, y, work, path, clock, tangent, counts, stop):
    """Carry motion and tangents through whole periods from phase 0.

    Returns (status, periods done, ∫ trace); the log's times count from the first period's start.
    """
    m, trace, onset = slots.chain.inverse_mass.size, 0.0, -np.inf
    begin(slots, y, path)
    path.logged[0] = 0
    for p in range(periods):
        t = 0.0
        while t < period:
            held_slope(slots, beta, t, path.closed, y, path.first, work.forces)
            status, time, h, contact = flow_step(method, slots, beta, t, period, onset, y, work, path, clock, tangent,
                                                 counts)
            if status != DONE:
                return status, p, trace
            if h > 0.0:
                trace += carry(tangent, slots, time, h, path)
                copy(work.end, y)
                new_scale(y, work, m)
                end = time_at(time, h)
                t = period if period - end < 1e-14 * period else end
                counts[0] += 1
            if contact >= 0:
                if path.logged[0] >= path.log.shape[0]:
                    return CHATTER, p, trace
                held_slope(slots, beta, t, path.closed, y, work.slope, work.forces)
                if change(slots, y, work, path, contact, p * period + t):
                    onset = t
                counts[2] += 1
        onset -= period
        if first_not_finite(y, m) != 0:
            return NOT_FINITE, p, trace
        if stop[0] != 0:
            return CANCELLED, p, trace
    return DONE, periods, trace
