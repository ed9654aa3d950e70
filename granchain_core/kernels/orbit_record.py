"""A run along an orbit that keeps the turning points of all overlaps and the largest forces.

Each accepted step of the certified method is looked at on its dense output. A contact's overlap has a turning point
where its bodies move equally fast; the smallest of these are the touches and separations about to appear or vanish. The
forces are maximised inside the steps, so that their tops are as exact as the dense output (about 1e-9), not as a grid.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .certified import certified_step, inner_extremum, overlap_in_step
from .dop853 import dense_value, evaluate, new_scale, prepare_dense
from .dop853_tableau import STAGES
from .effects.contact import elastic_force, positive_part
from .effects.preload import overlap
from .jit import kernel, part
from .motion import contact_force, copy
from .sampling import CANCELLED, DONE, NOT_FINITE, first_not_finite

#: Outcome: there were more turning points than places to keep them.
FULL = 5
#: Golden sections around the top of a force; each shrinks the bracket to 0.618 of it.
_SECTIONS = 32
#: Only what comes this near to the largest force so far is maximised.
_WORTH = 0.98


class OrbitRecord(NamedTuple):
    """What is kept of an orbit.

    Turning points are rows of `turns` (T, 4): contact, +1 for a largest and −1 for a smallest overlap, scaled time
    since the orbit's phase 0, overlap.
    `tops` (3,) are the largest input, output and elastic output force.
    """

    turns: np.ndarray
    tops: np.ndarray


@kernel
def force_in_step(slots, beta, t, h, y, work, x, which):
    """Input (0), output (1) or elastic output force (2) at fraction x of the step."""
    for i in range(y.size):
        work.probe[i] = dense_value(work.dense, y[i], x, i)
    evaluate(slots, beta, t + x * h, work.probe, work.slope, work.forces)
    last = work.forces.e.size - 1
    if which == 2:
        d = positive_part(overlap(slots.preload, work.probe, last))
        return elastic_force(slots.chain.stiffness[last], d)
    return contact_force(slots, work.probe, work.slope, work.forces.e, 0 if which == 0 else last)


@part
def top_in_step(slots, beta, t, h, y, work, which):
    """Largest value of a force inside the step, by golden section; that at an end where it lies there."""
    ratio = 0.6180339887498949
    low, high = 0.0, 1.0
    a, b = 1.0 - ratio, ratio
    fa = force_in_step(slots, beta, t, h, y, work, a, which)
    fb = force_in_step(slots, beta, t, h, y, work, b, which)
    for _ in range(_SECTIONS):
        if fa > fb:
            high, b, fb = b, a, fa
            a = high - ratio * (high - low)
            fa = force_in_step(slots, beta, t, h, y, work, a, which)
        else:
            low, a, fa = a, b, fb
            b = low + ratio * (high - low)
            fb = force_in_step(slots, beta, t, h, y, work, b, which)
    return max(fa, fb)


@part
def follow_forces(slots, beta, t, h, y, work, tops):
    """Raise the largest forces to what the step holds."""
    for which in range(3):
        start = force_in_step(slots, beta, t, h, y, work, 0.0, which)
        middle = force_in_step(slots, beta, t, h, y, work, 0.5, which)
        end = force_in_step(slots, beta, t, h, y, work, 1.0, which)
        largest = max(start, middle, end)
        worth = largest > _WORTH * tops[which] and largest > 0.0
        turns = 4.0 * middle - 3.0 * start - end > 0.0 and 4.0 * middle - start - 3.0 * end > 0.0
        if worth and turns:
            largest = max(largest, top_in_step(slots, beta, t, h, y, work, which))
        tops[which] = max(tops[which], largest)


@part
def follow_turns(slots, beta, t, h, y, work, since, record, row):
    """Keep the turning points of all overlaps inside the step; returns the next free row.

    The step has work.k[0] and work.k[12] as slopes at its ends; `since` is the time from the orbit's start to t.
    """
    k = work.k
    for c in range(slots.chain.stiffness.size):
        s0, s1 = k[0, c] - k[0, c + 1], k[STAGES, c] - k[STAGES, c + 1]
        if (s0 > 0.0) != (s1 > 0.0):
            if row < record.turns.shape[0]:
                sign = 1.0 if s0 > 0.0 else -1.0
                x = inner_extremum(slots, beta, t, h, y, work, c, sign)
                record.turns[row, 0], record.turns[row, 1] = c, sign
                record.turns[row, 2] = since + x * h
                record.turns[row, 3] = overlap_in_step(slots, beta, t, h, y, work, c, x)
            row += 1
    return row


@kernel
def record_orbit(method, slots, beta, period, periods, y, work, clock, record, counts, stop):
    """Run whole periods from phase 0 and fill `record`. Returns (status, periods done, turning points met)."""
    m, row = slots.chain.inverse_mass.size, 0
    evaluate(slots, beta, 0.0, y, work.k[0], work.forces)
    for p in range(periods):
        t = 0.0
        while t < period:
            status, h, _ = certified_step(method, slots, beta, t, period, y, work, clock, counts)
            if status != DONE:
                return status, p, row
            prepare_dense(slots, beta, t, h, y, work)
            row = follow_turns(slots, beta, t, h, y, work, p * period + t, record, row)
            follow_forces(slots, beta, t, h, y, work, record.tops)
            copy(work.end, y)
            new_scale(y, work, m)
            copy(work.k[STAGES], work.k[0])
            t = period if period - (t + h) < 1e-13 * period else t + h
        evaluate(slots, beta, 0.0, y, work.k[0], work.forces)
        if first_not_finite(y, m) != 0:
            return NOT_FINITE, p, row
        if stop[0] != 0:
            return CANCELLED, p, row
    return (DONE if row <= record.turns.shape[0] else FULL), periods, row
