"""A run along an orbit that records the turning points of all overlaps and the largest forces.

Each accepted step is searched on its dense output. A contact's overlap has a turning point where its two bodies have
the same velocity. A turning point with a small overlap is a touch or a separation that is about to appear or to vanish.
The largest forces are searched for inside the steps (force_search.py).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.jit import inline_numba, kernel
from ..equations.motion import copy
from ..samples import first_not_finite
from ..status import CANCELLED, DONE, FULL, NOT_FINITE
from .bracket import value_at
from .force_search import update_forces_in_step
from .located_step import located_step
from .step import GOAL_TOLERANCE, Overlap, Step, evaluate, new_scale, prepare_dense, stages, turning_point


class OrbitRecord(NamedTuple):
    """The record of an orbit.

    Turning points are rows of `turns` (T, 4): contact, +1 for a maximum and −1 for a minimum of the overlap, scaled
    time since the orbit's phase 0, overlap. `peaks` (PEAKS,) contains the largest input, output and elastic output
    force (forces/peaks.py).
    """

    turns: np.ndarray
    peaks: np.ndarray


@inline_numba
def record_turns(step, since, record, row):
    """Record the turning points of all overlaps inside the step; return the next free row.

    The step begins a time `since` after the orbit's start.
    """
    slots, _, _, workspace = step.trajectory
    slope, end = workspace.k[0], workspace.k[stages(workspace)]
    for c in range(slots.chain.stiffness.size):
        s0, s1 = slope[c] - slope[c + 1], end[c] - end[c + 1]
        if (s0 > 0.0) != (s1 > 0.0):
            if row < record.turns.shape[0]:
                sign = 1.0 if s0 > 0.0 else -1.0
                x = turning_point(Overlap(c, sign), step)
                record.turns[row, 0], record.turns[row, 1] = c, sign
                record.turns[row, 2] = since + x * step.h
                record.turns[row, 3] = value_at(Overlap(c, 1.0), step, x)
            row += 1
    return row


@kernel
def record_orbit(method, trajectory, periods, record, counts, stop):
    """Run whole periods from phase 0 and fill `record`. Returns (status, periods done, number of turning points)."""
    slots, drive, y, workspace = trajectory
    bodies, period, row = slots.chain.inverse_mass.size, drive.period, 0
    evaluate(slots, drive.beta, 0.0, y, workspace.k[0], workspace.forces)
    for p in range(periods):
        t = 0.0
        while t < period:
            if stop[0] != 0:
                return CANCELLED, p, row
            status, h, _ = located_step(method, trajectory, t, period, counts)
            if status != DONE:
                return status, p, row
            step = Step(trajectory, t, h)
            prepare_dense(workspace, step)
            row = record_turns(step, p * period + t, record, row)
            update_forces_in_step(step, True, record.peaks, counts)
            copy(workspace.end, y)
            new_scale(y, workspace, bodies)
            copy(workspace.k[stages(workspace)], workspace.k[0])
            t = period if period - (t + h) < GOAL_TOLERANCE * period else t + h
        evaluate(slots, drive.beta, 0.0, y, workspace.k[0], workspace.forces)
        if first_not_finite(y, bodies) != 0:
            return NOT_FINITE, p, row
    return (DONE if row <= record.turns.shape[0] else FULL), periods, row
