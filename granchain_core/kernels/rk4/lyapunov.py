"""A second chain close by, reset to the same small distance once a period: the growth of a disturbance."""

from __future__ import annotations

from math import log, sqrt

import numpy as np

from ..equations.motion import place
from ..jit import kernel
from ..samples import first_not_finite, keep_strobe
from ..status import CANCELLED, DONE, NOT_FINITE, STEPS_BETWEEN_STOP_CHECKS
from .step import step


@kernel
def run_two_trajectories(method, slots, drive, h, y, other, stages, shadow_stages, growth, strobes, forces, counts,
                         stop):
    """Run y and `other` through growth.size periods, recording the logarithm of each period's growth of their distance.

    Both start at phase 0 with their slopes in place; strobes (P, 2, N+2) are those of y. The forces of both go into
    the log `forces`, which is not used. Returns (status, periods).
    """
    n = method.steps_per_period
    dtheta = 2.0 * np.pi / n
    m = slots.chain.inverse_mass.size
    start = distance(y, other, m)
    for p in range(growth.size):
        for j in range(n):
            step(method, slots, drive, j, j * dtheta, dtheta, h, y, stages, forces, counts)
            step(method, slots, drive, j, j * dtheta, dtheta, h, other, shadow_stages, forces, counts)
            if j % STEPS_BETWEEN_STOP_CHECKS == 0 and stop[0] != 0:
                return CANCELLED, p
        if first_not_finite(y, m) != 0:
            return NOT_FINITE, p
        now = max(distance(y, other, m), 1e-300)
        growth[p] = log(now / start)
        for i in range(2 * m):
            other[i] = y[i] + (other[i] - y[i]) * (start / now)
        place(slots, 0.0, other, shadow_stages.k[0], shadow_stages.forces, False)
        keep_strobe(y, stages.k[0], strobes[p])
    return DONE, growth.size


@kernel
def distance(y, other, m):
    """Euclidean distance of two states in (u, w)."""
    total = 0.0
    for i in range(2 * m):
        total += (y[i] - other[i]) ** 2
    return sqrt(total)
