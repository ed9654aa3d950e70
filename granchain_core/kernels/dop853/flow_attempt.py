"""One attempt of the flow's step: Dormand–Prince 8 in the time in which the motion is smooth, and what changes in it.

Which contacts are closed is kept beside the state (`Held` in the workspace's forces) and does not change within a step,
so that neither the motion's nor the tangents' slopes jump there. An onset is located from before it, where nothing is
singular yet. The time of a release is estimated, the step ends there in a time variable that is the root of the
distance, and Newton's method on the resulting overlap corrects the estimate.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..effects.preload import overlap
from ..jit import by_slot, inline_numba, kernel
from ..status import EVALUATIONS
from .run import may_turn
from .step import combine, error_norm, overlap_inside
from .tableau import STAGES, C
from .time_map import prepare_dense_in_time, rate_at, slope_in_x, time_at


class Path(NamedTuple):
    """Beside the workspace: slope in t at the step's start, which contacts are closed, overlaps of every stage.

    `log` (events, 2) has contact + 1 with the sign of onset or release and the time of each event, `logged` their
    number; `gaps` is None where there are no tangents.
    """

    first: np.ndarray
    closed: np.ndarray
    log: np.ndarray
    logged: np.ndarray


@by_slot
def keep_gaps(tangent, slots, state, slope, stage):
    """Keep what tangents need of one stage, its overlaps; `slope` has its velocities. Absent: nobody needs them."""


@kernel
def attempt_in_time(method, slots, beta, time, h, y, work, path, tangent):
    """Try a step of size h in x from y; the result is work.end, its slope in t work.slope.

    Returns the error over the tolerance.
    """
    rate = rate_at(time, 0.0)
    for i in range(y.size):
        work.k[0, i] = rate * path.first[i]
    keep_gaps(tangent, slots, y, path.first, 0)
    for s in range(1, STAGES + 1):
        combine(y, h, work.k, s, work.end)
        slope_in_x(slots, beta, time, C[s] * h, work.end, s, work)
        keep_gaps(tangent, slots, work.end, work.slope, s)
    return error_norm(method.tolerance, h, y, work, slots.chain.inverse_mass.size)


@kernel
def overlap_at(slots, beta, time, h, y, work, c, x):
    """δ_c at fraction x of the step in x."""
    return overlap_inside(slots, beta * time_at(time, x * h), y, work, c, x)


@inline_numba
def root_between(slots, beta, time, h, y, work, c, low, high, rising):
    """Fraction in [low, high] at which δ_c changes sign, upwards if `rising` (bisection and regula falsi in turn)."""
    f_low = overlap_at(slots, beta, time, h, y, work, c, low)
    f_high = overlap_at(slots, beta, time, h, y, work, c, high)
    for trial in range(100):
        x = 0.5 * (low + high)
        if trial % 3 != 2 and f_high != f_low:
            x = min(high, max(low, (low * f_high - high * f_low) / (f_high - f_low)))
        f = overlap_at(slots, beta, time, h, y, work, c, x)
        if (f > 0.0) == rising:
            high, f_high = x, f
        else:
            low, f_low = x, f
        if high - low < 1e-14 or f == 0.0:
            return x
    return high


@kernel
def turning_point(slots, beta, time, h, y, work, c, sign):
    """Fraction at which sign·δ_c is largest inside the step, by golden section on the dense output."""
    ratio = 0.6180339887498949
    low, high = 0.0, 1.0
    for _ in range(45):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        fa = sign * overlap_at(slots, beta, time, h, y, work, c, a)
        fb = sign * overlap_at(slots, beta, time, h, y, work, c, b)
        if fa > fb:
            high = b
        else:
            low = a
    return 0.5 * (low + high)


@inline_numba
def first_change(slots, beta, time, h, y, work, path, counts, but):
    """(contact, fraction) of the first change inside the step of any contact but one; (−1, 2) if there is none."""
    contact, first, ready = -1, 2.0, False
    dt = time_at(time, h) - time.start
    for c in range(path.closed.size):
        if c == but:
            continue
        was = path.closed[c] != 0
        sign = -1.0 if was else 1.0  # the change looked for makes sign·δ positive
        d0, d1 = overlap(slots.preload, y, c), overlap(slots.preload, work.end, c)
        s0, s1 = dt * (path.first[c] - path.first[c + 1]), dt * (work.slope[c] - work.slope[c + 1])
        crossed = was != (d1 > 0.0)
        if not (crossed or may_turn(d0, s0, d1, s1, sign)):
            continue
        if not ready:
            prepare_dense_in_time(slots, beta, time, h, y, work)
            counts[EVALUATIONS] += 4
            ready = True
        low, high = 0.0, 1.0
        if not crossed:
            high = turning_point(slots, beta, time, h, y, work, c, sign)
            if sign * overlap_at(slots, beta, time, h, y, work, c, high) <= 0.0:
                continue
        elif sign * d0 > 0.0 or d0 == 0.0:  # a contact that has just changed: rounding has the wrong sign
            low = turning_point(slots, beta, time, h, y, work, c, -sign) if sign * s0 < 0.0 else 1.0
            if low == 1.0 or sign * overlap_at(slots, beta, time, h, y, work, c, low) >= 0.0:
                return c, 0.0
        x = root_between(slots, beta, time, h, y, work, c, low, high, not was)
        if x < first:
            contact, first = c, x
    return contact, first
