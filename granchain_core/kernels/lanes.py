"""Eight chains at once, one a SIMD lane: RK4 in w with a fixed step, for curves and maps.

All lanes share the effects and N; every value may differ, the step and the number of steps in a period too. A lane
that ends a period is looked at by itself; one that may have settled, or that has run long enough to be looked at,
stops the kernel so that its place can be filled with the next scene.
"""

from __future__ import annotations

from math import log, sqrt
from typing import Any, NamedTuple

import numpy as np

from .effects.contact import positive_part
from .effects.dissipation import LAWS, damping, lane_values, shape
from .effects.foundation import lane_foundation, pull_back
from .effects.preload import lane_overlap
from .effects.unequal import over_mass, times_stiffness
from .jit import inlined, kernel, term
from .lane_events import correct_contacts
from .lane_looks import end_period
from .peaks import INPUT, OUTPUT, OUTPUT_ELASTIC, watch_lanes
from .sampling import CANCELLED, DONE, NOT_FINITE
from .simd import LANES, blank, flush_subnormals, load, restore_subnormals, store
from .simd_math import above_zero, root, root_by_series

#: Steps after which the stop flag is asked at the latest.
_PATIENCE = 4096


class Lanes(NamedTuple):
    """Values of eight scenes: the wall's stiffness, effect slots with (1, 8) or (rows, 8) arrays or None, step data.

    `turn` is cos and sin of half a step's phase, `beta` the scaled drive rate, `h` the step.
    """

    wall: np.ndarray
    unequal: Any
    dissipation: Any
    foundation: Any
    preload: Any
    turn: np.ndarray
    beta: np.ndarray
    h: np.ndarray


class LaneState(NamedTuple):
    """Where the lanes are: state (2(N+2), 8), overlaps a step ago (N+1, 8), sin and cos of the phase (2, 8),
    peaks (15, 8).

    Per lane: steps in a period and steps left, periods run, the period to stop at in any case and the next at which the
    strobes are looked at; the period from which an approach may be followed and how long it is waited after a vain one,
    the slowest decay known, the change before an extrapolation that has not proved itself and the state `before` it
    (8, 2, N+2), the period of an orbit that is disturbed; what is known of a fine lane (8, 7); strobes (8, 2R, 2, N+2)
    of which `kept` are there, largest forces (8, R, 3) as a ring, and what was seen last (8, 3): period, rate,
    distance. The rest are workspaces of lane_looks.
    """

    y: np.ndarray
    gaps: np.ndarray
    phase: np.ndarray
    peaks: np.ndarray
    steps: np.ndarray
    left: np.ndarray
    periods: np.ndarray
    look: np.ndarray
    earliest: np.ndarray
    ready: np.ndarray
    wait: np.ndarray
    kept: np.ndarray
    slowest: np.ndarray
    jumped: np.ndarray
    testing: np.ndarray
    before: np.ndarray
    fine: np.ndarray
    strobes: np.ndarray
    tops: np.ndarray
    seen: np.ndarray
    scale: np.ndarray
    change: np.ndarray
    limit: np.ndarray
    basis: np.ndarray
    triangle: np.ndarray


class Values(NamedTuple):
    """What the lanes' scenes are made of, in registers where it is one number a scene."""

    wall: Any
    law: Any
    foundation: Any
    preload: Any
    unequal: Any
    last: Any


class Bead(NamedTuple):
    """One bead of one Runge–Kutta stage in all lanes: state, elastic force and shape of the contact on its left."""

    u: Any
    w: Any
    e: Any
    G: Any


@inlined
def by_divider(d):
    """√d by the divider."""
    return root(d)


@inlined
def by_multipliers(d):
    """√d, d > 0, by the multipliers."""
    return root_by_series(d)


@inlined
def contact(values, root_of, left, right, c):
    """Elastic force and shape of G of contact c; `root_of` takes the root its own way."""
    d = above_zero(lane_overlap(values.preload, left, right, c))
    r = root_of(d)
    return times_stiffness(values.unequal, values.wall, c, values.last, d * r), shape(values.law, d, r)


@inlined
def first_bead(values, root_of, u0, u, w):
    """Bead 1 of a stage with the driver at u0."""
    e, G = contact(values, root_of, u0, u, 0)
    return Bead(u, w, e, G)


@inlined
def bead_slope(values, root_of, bead, i, right, right_w):
    """Slope of bead i, which is `bead`, between its neighbours; and the next bead with the contact between them."""
    e, G = contact(values, root_of, bead.u, right, i)
    du = lane_velocity(values.law, values.unequal, i, bead.w, bead.G - G)
    dw = over_mass(values.unequal, i, pull_back(values.foundation, bead.e - e, bead.u))
    return du, dw, Bead(right, right_w, e, G)


@term
def lane_velocity(law, unequal, i, w, difference):
    """v = w + (G_{i-1} − G_i)/m of bead i in all lanes, from the difference of shapes."""
    return w


for _law in LAWS:

    @lane_velocity.of(_law)
    def _(law, unequal, i, w, difference):
        return w + over_mass(unequal, i, law.coefficient * difference)


class Ends(NamedTuple):
    """What is known of the chain's two ends where a step begins: elastic forces and the beads' velocities."""

    pushed: Any
    v_first: Any
    passed: Any
    v_last: Any


@inlined
def lane_step(values, y, h, u0, middle, end):
    """One RK4 step in place, the driver at u0, at `middle` and at `end`; returns the `Ends` where it began.

    The four stages run along the chain one bead behind another, so that a step goes through memory once. The stages'
    states y1, y2, y3 are all there is to remember: y + h (k1 + 2k2 + 2k3 + k4)/6 = (y1 + 2y2 + y3 − y)/3 + h k4/6.
    """
    m, n = values.last + 2, values.last
    half, sixth, third = 0.5 * h, (1.0 / 6.0) * h, 1.0 / 3.0
    zero = blank(h)
    nothing = Bead(zero, zero, zero, shape(values.law, zero, zero))
    two, three, four = nothing, nothing, nothing
    one = first_bead(values, by_multipliers, u0, load(y, 1), load(y, m + 1))
    pushed, v_first, v_last = one.e, zero, zero
    sum_u, sum_w, whole_u, whole_w = zero, zero, zero, zero
    for i in range(1, n + 4):
        u1, w1, u2, w2, u3, w3 = zero, zero, zero, zero, zero, zero
        if i <= n:
            u, w = one.u, one.w
            v_last, dw, one = bead_slope(values, by_multipliers, one, i, load(y, i + 1), load(y, m + i + 1))
            u1, w1 = u + half * v_last, w + half * dw
        if i == 1:
            v_first = v_last
            two = first_bead(values, by_divider, middle, u1, w1)
            continue
        if i <= n + 1:
            before = two
            du, dw, two = bead_slope(values, by_divider, two, i - 1, u1, w1)
            u2, w2 = load(y, i - 1) + half * du, load(y, m + i - 1) + half * dw
            new_u, new_w = before.u + 2.0 * u2, before.w + 2.0 * w2
        else:
            new_u, new_w = zero, zero
        if i == 2:
            three = first_bead(values, by_multipliers, middle, u2, w2)
            sum_u, sum_w = new_u, new_w
            continue
        if i <= n + 2:
            du, dw, three = bead_slope(values, by_multipliers, three, i - 2, u2, w2)
            u, w = load(y, i - 2), load(y, m + i - 2)
            u3, w3 = u + h * du, w + h * dw
            newer_u, newer_w = sum_u + (u3 - u), sum_w + (w3 - w)
        else:
            newer_u, newer_w = zero, zero
        sum_u, sum_w = new_u, new_w
        if i == 3:
            four = first_bead(values, by_divider, end, u3, w3)
            whole_u, whole_w = newer_u, newer_w
            continue
        du, dw, four = bead_slope(values, by_divider, four, i - 3, u3, w3)
        store(y, i - 3, third * whole_u + sixth * du)
        store(y, m + i - 3, third * whole_w + sixth * dw)
        whole_u, whole_w = newer_u, newer_w
    return Ends(pushed, v_first, one.e, v_last)


@inlined
def watch_ends(values, gap_first, gap_last, v0, ends, peaks):
    """Follow input force, output force and its elastic part in all lanes, where a step began."""
    first = damping(values.law, positive_part(gap_first)) * (v0 - ends.v_first)
    last = damping(values.law, positive_part(gap_last)) * ends.v_last
    watch_lanes(peaks, INPUT, ends.pushed + first)
    watch_lanes(peaks, OUTPUT, ends.passed + last)
    watch_lanes(peaks, OUTPUT_ELASTIC, ends.passed)


@kernel
def lane_steps(lanes, state, count):
    """Take `count` steps in all lanes."""
    y, before = state.y, flush_subnormals()
    last = y.shape[0] // 2 - 2
    values = Values(load(lanes.wall, 0), lane_values(lanes.dissipation), lane_foundation(lanes.foundation),
                    lanes.preload, lanes.unequal, last)
    h, beta = load(lanes.h, 0), load(lanes.beta, 0)
    c, s = load(lanes.turn, 0), load(lanes.turn, 1)
    sine, cosine = load(state.phase, 0), load(state.phase, 1)
    for _ in range(count):
        middle, middle_cosine = sine * c + cosine * s, cosine * c - sine * s
        end, end_cosine = middle * c + middle_cosine * s, middle_cosine * c - middle * s
        correct_contacts(values, y, state.gaps, h, sine)
        gap_first = lane_overlap(values.preload, sine, load(y, 1), 0)
        gap_last = lane_overlap(values.preload, load(y, last), load(y, last + 1), last)
        ends = lane_step(values, y, h, sine, middle, end)
        watch_ends(values, gap_first, gap_last, beta * cosine, ends, state.peaks)
        sine, cosine = end, end_cosine
    store(state.phase, 0, sine)
    store(state.phase, 1, cosine)
    restore_subnormals(before)


@kernel
def run_lanes(lanes, state, stop):
    """Run until a lane should be looked at; returns (status, lane)."""
    while True:
        count = _PATIENCE
        for lane in range(LANES):
            count = min(count, state.left[lane])
        lane_steps(lanes, state, count)
        found = -1
        for lane in range(LANES):
            state.left[lane] -= count
            if state.left[lane] == 0 and end_period(state, lane) and found < 0:
                found = lane
        if stop[0] != 0:
            return CANCELLED, found
        if found >= 0:
            return (DONE if np.isfinite(state.y[1, found]) else NOT_FINITE), found


@kernel
def part_again(state, m, start, growth, lane):
    """Note by how much a pair of lanes has parted in a period and pull the second back to the distance `start`."""
    y, total = state.y, 0.0
    for i in range(2 * m):
        total += (y[i, lane + 1] - y[i, lane]) ** 2
    now = max(sqrt(total), 1e-300)
    growth[lane // 2, state.periods[lane] - 1] = log(now / start)
    for i in range(2 * m):
        y[i, lane + 1] = y[i, lane] + (y[i, lane + 1] - y[i, lane]) * (start / now)


@kernel
def run_pairs(lanes, state, start, growth, stop):
    """Run lanes in pairs, a chain and its shadow at the distance `start`, through as many periods as `growth` has.

    growth (4, P) holds the logarithm of each period's growth; pairs that are never to be looked at are left out.
    """
    m, periods, busy = state.y.shape[0] // 2, growth.shape[1], True
    while busy:
        count = _PATIENCE
        for lane in range(LANES):
            count = min(count, state.left[lane])
        lane_steps(lanes, state, count)
        busy = False
        for lane in range(0, LANES, 2):
            counted = state.periods[lane] < periods and state.look[lane] == periods
            for one in range(lane, lane + 2):
                state.left[one] -= count
                if state.left[one] == 0:
                    end_period(state, one)
            if counted and state.left[lane] == state.steps[lane]:
                if not (np.isfinite(state.y[1, lane]) and np.isfinite(state.y[1, lane + 1])):
                    return NOT_FINITE
                part_again(state, m, start, growth, lane)
            busy = busy or (counted and state.periods[lane] < periods)
        if stop[0] != 0:
            return CANCELLED
    return DONE
