"""Eight chains at once, one a SIMD lane: RK4 in w with a fixed step, for curves and maps.

All lanes share the effects and N; every value may differ, the step and the number of steps in a period too. A lane
that ends a period is looked at by itself; one that may have settled, or that has run long enough to be looked at,
stops the kernel so that its place can be filled with the next scene.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .effects.contact import divided_elastic_force, elastic_force, positive_part
from .effects.dissipation import damping, lane_values, lane_velocity, primitive
from .effects.foundation import lane_foundation, pull_back
from .effects.preload import lane_overlap
from .jit import inlined, kernel
from .peaks import INPUT, OUTPUT, OUTPUT_ELASTIC, ROWS, watch_lanes
from .sampling import CANCELLED, DONE, NOT_FINITE
from .simd import LANES, blank, load, store

#: Strobes remembered of each lane.
REMEMBERED = 432
#: Steps after which the stop flag is asked at the latest.
_PATIENCE = 4096
#: Longest period looked for when a lane is screened, and the relative change that makes it worth a look.
SCREENED, SMALL_CHANGE = 16, 1e-6


class Lanes(NamedTuple):
    """Values of eight scenes: chain arrays (rows, 8), effect slots with (1, 8) arrays or None, step data (rows, 8).

    `turn` is cos and sin of half a step's phase, `beta` the scaled drive rate, `h` the step.
    """

    inverse_mass: np.ndarray
    stiffness: np.ndarray
    dissipation: Any
    foundation: Any
    preload: Any
    turn: np.ndarray
    beta: np.ndarray
    h: np.ndarray


class LaneState(NamedTuple):
    """Where the lanes are: state (2(N+2), 8), sin and cos of the phase (2, 8), peaks (15, 8).

    Per lane: steps in a period and steps left, periods run, the period to stop at in any case, the earliest period to
    stop at when it may have settled, strobes (8, R, 2(N+2)) and largest forces (8, R, 3) as rings.
    """

    y: np.ndarray
    phase: np.ndarray
    peaks: np.ndarray
    steps: np.ndarray
    left: np.ndarray
    periods: np.ndarray
    look: np.ndarray
    earliest: np.ndarray
    strobes: np.ndarray
    tops: np.ndarray


class Bead(NamedTuple):
    """One bead of one Runge–Kutta stage in all lanes: state, elastic force and G of the contact on its left."""

    u: Any
    w: Any
    e: Any
    G: Any


@inlined
def first_bead(lanes, law, u0, u, w):
    """Bead 1 of a stage with the driver at u0."""
    d = positive_part(lane_overlap(lanes.preload, u0, u, 0))
    return Bead(u, w, elastic_force(load(lanes.stiffness, 0), d), primitive(law, d))


@inlined
def bead_slope(lanes, law, foundation, force, bead, i, right, right_w):
    """Slope of bead i, which is `bead`, between its neighbours; and the next bead with the contact between them.

    `force` is the elastic force's function.
    """
    d = positive_part(lane_overlap(lanes.preload, bead.u, right, i))
    e = force(load(lanes.stiffness, i), d)
    G = primitive(law, d)
    inverse = load(lanes.inverse_mass, i)
    du = lane_velocity(law, bead.w, inverse, bead.G, G)
    dw = inverse * pull_back(foundation, bead.e - e, bead.u)
    return du, dw, Bead(right, right_w, e, G)


@inlined
def lane_step(lanes, law, foundation, y, h, u0, middle, end):
    """One RK4 step in place, the driver at u0, at `middle` and at `end`.

    The four stages run along the chain one bead behind another, so that a step goes through memory once. The stages'
    states y1, y2, y3 are all there is to remember: y + h (k1 + 2k2 + 2k3 + k4)/6 = (y1 + 2y2 + y3 − y)/3 + h k4/6.
    """
    m = lanes.inverse_mass.shape[0]
    n = m - 2
    half, sixth, third = 0.5 * h, (1.0 / 6.0) * h, 1.0 / 3.0
    zero = blank(h)
    nothing = Bead(zero, zero, zero, primitive(law, zero))
    one, two, three, four = first_bead(lanes, law, u0, load(y, 1), load(y, m + 1)), nothing, nothing, nothing
    sum_u, sum_w, whole_u, whole_w = zero, zero, zero, zero
    for i in range(1, n + 4):
        u1, w1, u2, w2, u3, w3 = zero, zero, zero, zero, zero, zero
        if i <= n:
            u, w = one.u, one.w
            du, dw, one = bead_slope(lanes, law, foundation, elastic_force, one, i, load(y, i + 1), load(y, m + i + 1))
            u1, w1 = u + half * du, w + half * dw
        if i == 1:
            two = first_bead(lanes, law, middle, u1, w1)
            continue
        if i <= n + 1:
            before = two
            du, dw, two = bead_slope(lanes, law, foundation, divided_elastic_force, two, i - 1, u1, w1)
            u2, w2 = load(y, i - 1) + half * du, load(y, m + i - 1) + half * dw
            new_u, new_w = before.u + 2.0 * u2, before.w + 2.0 * w2
        else:
            new_u, new_w = zero, zero
        if i == 2:
            three = first_bead(lanes, law, middle, u2, w2)
            sum_u, sum_w = new_u, new_w
            continue
        if i <= n + 2:
            du, dw, three = bead_slope(lanes, law, foundation, elastic_force, three, i - 2, u2, w2)
            u, w = load(y, i - 2), load(y, m + i - 2)
            u3, w3 = u + h * du, w + h * dw
            newer_u, newer_w = sum_u + (u3 - u), sum_w + (w3 - w)
        else:
            newer_u, newer_w = zero, zero
        sum_u, sum_w = new_u, new_w
        if i == 3:
            four = first_bead(lanes, law, end, u3, w3)
            whole_u, whole_w = newer_u, newer_w
            continue
        du, dw, four = bead_slope(lanes, law, foundation, divided_elastic_force, four, i - 3, u3, w3)
        store(y, i - 3, third * whole_u + sixth * du)
        store(y, m + i - 3, third * whole_w + sixth * dw)
        whole_u, whole_w = newer_u, newer_w


@inlined
def watch_lane_forces(lanes, law, u0, v0, state):
    """Follow input force, output force and its elastic part in all lanes."""
    m, y = lanes.inverse_mass.shape[0], state.y
    first, second, last, before = load(y, 1), load(y, 2), load(y, m - 2), load(y, m - 3)
    wall = load(y, m - 1)
    if m == 3:
        before = u0
    d0 = positive_part(lane_overlap(lanes.preload, u0, first, 0))
    d1 = positive_part(lane_overlap(lanes.preload, first, second, 1))
    v1 = lane_velocity(law, load(y, m + 1), load(lanes.inverse_mass, 1), primitive(law, d0), primitive(law, d1))
    d_before = positive_part(lane_overlap(lanes.preload, before, last, m - 3))
    d_last = positive_part(lane_overlap(lanes.preload, last, wall, m - 2))
    v_last = lane_velocity(law, load(y, 2 * m - 2), load(lanes.inverse_mass, m - 2), primitive(law, d_before),
                           primitive(law, d_last))
    elastic = elastic_force(load(lanes.stiffness, m - 2), d_last)
    watch_lanes(state.peaks, INPUT, elastic_force(load(lanes.stiffness, 0), d0) + damping(law, d0) * (v0 - v1))
    watch_lanes(state.peaks, OUTPUT, elastic + damping(law, d_last) * v_last)
    watch_lanes(state.peaks, OUTPUT_ELASTIC, elastic)


@kernel
def lane_steps(lanes, state, count):
    """Take `count` steps in all lanes."""
    law, foundation = lane_values(lanes.dissipation), lane_foundation(lanes.foundation)
    h, beta = load(lanes.h, 0), load(lanes.beta, 0)
    c, s = load(lanes.turn, 0), load(lanes.turn, 1)
    sine, cosine = load(state.phase, 0), load(state.phase, 1)
    for _ in range(count):
        middle, middle_cosine = sine * c + cosine * s, cosine * c - sine * s
        end, cosine = middle * c + middle_cosine * s, middle_cosine * c - middle * s
        lane_step(lanes, law, foundation, state.y, h, sine, middle, end)
        sine = end
        watch_lane_forces(lanes, law, sine, beta * cosine, state)
    store(state.phase, 0, sine)
    store(state.phase, 1, cosine)


@kernel
def may_have_settled(state, lane):
    """Whether some change of the lane's strobe over 1 to 16 periods is small against the strobe itself."""
    periods, strobes = state.periods[lane], state.strobes
    now = periods % REMEMBERED
    largest = 0.0
    for i in range(strobes.shape[2]):
        largest = max(largest, abs(strobes[lane, now, i]))
    for n in range(1, SCREENED + 1):
        then, change = (periods - n) % REMEMBERED, 0.0
        for i in range(strobes.shape[2]):
            change = max(change, abs(strobes[lane, now, i] - strobes[lane, then, i]))
        if change <= SMALL_CHANGE * largest:
            return True
    return False


@kernel
def end_period(state, lane):
    """Note strobe and largest forces of a lane, restart its phase exactly; whether it should be looked at."""
    rows = state.y.shape[0]
    state.periods[lane] += 1
    place = state.periods[lane] % REMEMBERED
    finite = True
    for i in range(rows):
        state.strobes[lane, place, i] = state.y[i, lane]
        finite = finite and np.isfinite(state.y[i, lane])
    for q in range(3):
        state.tops[lane, place, q] = state.peaks[ROWS * q, lane]
        state.peaks[ROWS * q, lane] = 0.0
    state.phase[0, lane], state.phase[1, lane] = 0.0, 1.0
    state.left[lane] = state.steps[lane]
    if not finite or state.periods[lane] >= state.look[lane]:
        return True
    return state.periods[lane] >= max(SCREENED, state.earliest[lane]) and may_have_settled(state, lane)


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
