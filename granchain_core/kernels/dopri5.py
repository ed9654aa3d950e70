"""Error-controlled integration without events: Dormand–Prince 5 in w, as a general solver would do it.

Kinks at contact events are met by rejected steps alone, and a contact that opens and closes within a step is not
seen. It is in the table of methods for what the location of events is worth.
Source: Dormand & Prince 1980; Hairer, Nørsett & Wanner 1993, section II.5, table 5.2.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from .dop853 import evaluate, new_scale
from .jit import kernel, part
from .largest_forces import end_overlaps, watch_crossings, watch_state
from .motion import copy
from .sampling import CANCELLED, DONE, NOT_FINITE, STEP_TOO_SMALL, first_not_finite, keep


class Dopri5(NamedTuple):
    """Method slot: relative tolerance of one step and the largest step."""

    tolerance: float
    largest_step: float


_STAGES = 6
_C = np.array([0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0])
_A = np.array([
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
    [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
    [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
    [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
    [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
])
#: Difference of the orders 5 and 4.
_E = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])
#: Growth and shrinkage of the step from one to the next.
_GROW, _SHRINK, _SAFETY = 5.0, 0.2, 0.9


@kernel
def attempt(method, slots, beta, t, h, y, work):
    """Try a step of size h from y, whose slope is work.k[0]; the result is work.end, its slope work.k[6].

    Returns the error over the tolerance, root mean square over the beads.
    """
    k, end, m = work.k, work.end, slots.chain.inverse_mass.size
    for s in range(1, _STAGES + 1):
        for i in range(y.size):
            value = y[i]
            for q in range(s):
                value += h * _A[s, q] * k[q, i]
            end[i] = value
        evaluate(slots, beta, t + _C[s] * h, end, k[s], work.forces)
    total = 0.0
    for row in range(2):
        for i in range(row * m + 1, row * m + m - 1):
            error = 0.0
            for q in range(_STAGES + 1):
                error += _E[q] * k[q, i]
            total += (error / (method.tolerance * work.scale[row])) ** 2
    return abs(h) * sqrt(total / (2 * (m - 2)))


@part
def step(method, slots, beta, t, limit, y, work, clock, counts):
    """One accepted step from y at local time t, at most to `limit`; returns (status, step taken)."""
    h = min(clock[0], method.largest_step, limit - t)
    while True:
        error = attempt(method, slots, beta, t, h, y, work)
        counts[1] += _STAGES
        if not np.isfinite(error):
            return NOT_FINITE, h
        if error <= 1.0:
            break
        counts[3] += 1
        h *= max(_SHRINK, _SAFETY * error**-0.2)
        if t + 0.1 * h == t:
            return STEP_TOO_SMALL, h
    if h < limit - t or error > 0.5 or clock[0] <= h:
        clock[0] = h * min(_GROW, _SAFETY * max(error, 1e-12) ** -0.2)
    counts[0] += 1
    return DONE, h


@kernel
def run_without_events(method, slots, beta, period, y, work, clock, first, points, grid, every, samples, log, counts,
                       stop):
    """Run over `points` points of a grid of `grid` points a period; arguments and result as of run_certified.

    Steps end at samples and at periods only.
    """
    m, spacing = slots.chain.inverse_mass.size, period / grid
    g, done, row, stride = first, 0, 1, every if every > 0 else grid
    t = g * spacing
    evaluate(slots, beta, t, y, work.k[0], work.forces)
    watch_state(slots, y, work.k[0], work.forces.e, 0.0, log)
    if every > 0:
        keep(slots, 0, y, work.k[0], work.forces.e, samples)
    while done < points:
        goal = min((g // stride + 1) * stride, grid, g + points - done)
        limit = period if goal == grid else goal * spacing
        while t < limit:
            if stop[0] != 0:
                return CANCELLED, row if every > 0 else done
            status, h = step(method, slots, beta, t, limit, y, work, clock, counts)
            if status != DONE:
                return status, row if every > 0 else done
            theta, log.met[2] = beta * t, row - 1
            t = limit if limit - (t + h) < 1e-13 * period else t + h
            before = end_overlaps(slots.dissipation, slots, y, work.k[0])
            watch_crossings(slots.dissipation, slots, before, work.end, work.k[_STAGES], h, theta, beta * h, log)
            copy(work.end, y)
            copy(work.k[_STAGES], work.k[0])
            new_scale(y, work, m)
            watch_state(slots, y, work.k[0], work.forces.e, h, log)
            if first_not_finite(y, m) != 0:
                return NOT_FINITE, row if every > 0 else done
        done += goal - g
        g = goal
        if every > 0 and g % every == 0:
            keep(slots, row, y, work.k[0], work.forces.e, samples)
            row += 1
        if g == grid:
            g, t = 0, 0.0
            evaluate(slots, beta, t, y, work.k[0], work.forces)
    return DONE, row if every > 0 else done
