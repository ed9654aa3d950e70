"""A second chain close by, reset to the same small distance once a period: the growth of a disturbance."""

from __future__ import annotations

from math import log, sqrt

from ..equations.motion import place
from ..jit import internal, kernel
from ..samples import first_not_finite, keep_strobe
from ..status import CANCELLED, DONE, NOT_FINITE, STEPS_BETWEEN_STOP_CHECKS
from .step import step


@kernel
def run_two_trajectories(method, one, other, growth, strobes, out):
    """Run two chains through growth.size periods, recording the logarithm of each period's growth of their distance.

    Both start at phase 0 with their slopes in place; strobes (P, 2, N+2) are those of the first. The forces of both go
    into the same log, which is not used. Returns (status, periods).
    """
    n, m = method.steps_per_period, one.slots.chain.inverse_mass.size
    start = distance(one.y, other.y, m)
    for p in range(growth.size):
        for j in range(n):
            step(method, one, j, out)
            step(method, other, j, out)
            if j % STEPS_BETWEEN_STOP_CHECKS == 0 and out.stop[0] != 0:
                return CANCELLED, p
        if first_not_finite(one.y, m) != 0:
            return NOT_FINITE, p
        now = max(distance(one.y, other.y, m), 1e-300)
        growth[p] = log(now / start)
        for i in range(2 * m):
            other.y[i] = one.y[i] + (other.y[i] - one.y[i]) * (start / now)
        place(other.slots, 0.0, other.y, other.work.k[0], other.work.forces, False)
        keep_strobe(one.y, one.work.k[0], strobes[p])
    return DONE, growth.size


@internal
def distance(y, other, m):
    """Euclidean distance of two states in (u, w)."""
    total = 0.0
    for i in range(2 * m):
        total += (y[i] - other[i]) ** 2
    return sqrt(total)
