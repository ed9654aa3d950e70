"""Several chains at once, one in each SIMD lane: RK4 in w with a fixed step, for curves and maps.

All members have the same effects and the same N; every value may differ, as may the step and the number of steps in a
period. Each member is checked at the ends of its own periods. When one may have settled, or has run as long as it may,
the kernel returns, and the next scene can have its lane. Arrays have an axis of L lanes; index `member` is the lane.
"""

from __future__ import annotations

from math import log, sqrt
from typing import Any, NamedTuple

import numpy as np

from ..batch_size import BATCH_SIZE
from ..compiling.by_address import call_at
from ..compiling.jit import inline_llvm, inline_numba, kernel
from ..effects.preload import vector_overlap
from ..equations.motion import batch_slots
from ..simd.subnormals import flush_subnormals, restore_subnormals
from ..simd.vector import load_batch, store
from ..status import CANCELLED, DONE, NOT_FINITE, STEPS_BETWEEN_STOP_CHECKS
from .contact_correction import correct_contacts
from .period_end import end_period
from .record import is_finite_member
from .step import Values, batch_step, update_batch_peaks

#: `neighbour` of a member that has no neighbouring trajectory, and of one that is a neighbouring trajectory itself.
NO_NEIGHBOUR, IS_NEIGHBOUR = -1, -2


class Members(NamedTuple):
    """Values of the members' scenes, L of them.

    `wall` (1, L) is the wall's stiffness; the effects' `slots` hold arrays (1, L) or (rows, L), or are None. `beta`
    (1, L) is the scaled drive rate.
    """

    wall: np.ndarray
    unequal: Any
    slots: Any
    beta: np.ndarray


class BatchState(NamedTuple):
    """State of L members (BATCH_SIZE) with N beads each, one in each lane; R is STROBES_KEPT.

    State of a chain: displacements of driver, beads and wall, then w of the same, N + 2 rows each; an axis of length 2
    holds the two.

    begins (L,)              1 where the member is new: it begins at the kernel's next call (begin.py)
    y (2(N+2), L)            state
    drive_period (L,)        period of the drive
    h, turn (1 and 2, L)     step; cosine and sine of the drive phase of half a step
    overlaps (N+1, L)        overlaps of the contacts after the last step, before its correction
    static_overlap (N+1, L)  overlaps of the contacts at rest, 0 without preload
    end_contacts (4, L)      one step ago: overlap and rate of the first contact, overlap and rate of the last
    phase (2, L)             sine and cosine of the drive phase
    peaks (BATCH_PEAKS, L)   largest forces, jumps and unresolved peaks, and the last four values of each force
                             (forces/peaks.py)
    steps, steps_left (L,)   steps in a period, and how many of them are left
    finer_steps (L,)         steps in a period of the finer run that follows once an orbit is found; 0 if none does
    periods, return_at (L,)  periods run, and the period at which the kernel returns at the latest
    next_check (L,)          next period at which the strobes are checked
    extrapolate_from (L,)    period from which a transient may be extrapolated
    wait_after_undo (L,)     periods without extrapolation after the next one that is undone
    due (L,)                 1 where the member is to be returned to the caller, else 0
    neighbour (L,)           lane of the member's neighbouring trajectory; NO_NEIGHBOUR, or IS_NEIGHBOUR
    distance (L,)            distance to which the neighbour is brought back after each period
    growth (L, R)            logarithm of the factor by which that distance has grown in each period; NaN if lost
    strobe_count (L,)        strobes kept
    first_strobe (2, L)      place of the first strobe since the member was last moved to another state, and of the
                             first since the time before that
    slowest_decay (L,)       slowest decay per drive period before an extrapolation that was not undone, 0 if there is
                             none; above 0 an orbit that is found must survive a disturbance
    slowest_decay_before (L,)  the same before the last extrapolation, which may be undone
    change_before_extrapolation (L,)  change per orbit before an extrapolation that is not confirmed yet, else 0
    tested_period (L,)       period of an orbit that is being disturbed, else 0
    state_before (L, 2, N+2)  state before the last extrapolation
    fine_record (L, FINE_COLUMNS)  record of a finer run (begin.py); its period is 0 in a coarse one
    coarse_orbit (L, ORBIT_COLUMNS)  what the coarse run found (begin.py)
    strobes (L, 2R, 2, N+2)  states at the ends of periods
    maxima (L, R, MAXIMA)    of the last R periods, a ring: three largest forces (input, output, elastic output), then
                             of the input and output force the largest jumps and the largest unresolved peaks
    last_check (L, CHECK_COLUMNS)  result of the last check (begin.py)
    stages                   three states, (2(N+2), L) each, of the stages of a step (step.py)

    Workspaces of checks.py, with ORBITS of strobes/extrapolation.py: scale (2,), change (3·LONGEST_PERIOD or more,),
    limit (2, N+2), basis (ORBITS, 2(N+2)), triangle (ORBITS, ORBITS).
    """

    begins: np.ndarray
    y: np.ndarray
    drive_period: np.ndarray
    h: np.ndarray
    turn: np.ndarray
    overlaps: np.ndarray
    static_overlap: np.ndarray
    end_contacts: np.ndarray
    phase: np.ndarray
    peaks: np.ndarray
    steps: np.ndarray
    steps_left: np.ndarray
    finer_steps: np.ndarray
    periods: np.ndarray
    return_at: np.ndarray
    next_check: np.ndarray
    extrapolate_from: np.ndarray
    wait_after_undo: np.ndarray
    due: np.ndarray
    neighbour: np.ndarray
    distance: np.ndarray
    growth: np.ndarray
    strobe_count: np.ndarray
    first_strobe: np.ndarray
    slowest_decay: np.ndarray
    slowest_decay_before: np.ndarray
    change_before_extrapolation: np.ndarray
    tested_period: np.ndarray
    state_before: np.ndarray
    fine_record: np.ndarray
    coarse_orbit: np.ndarray
    strobes: np.ndarray
    maxima: np.ndarray
    last_check: np.ndarray
    scale: np.ndarray
    change: np.ndarray
    limit: np.ndarray
    basis: np.ndarray
    triangle: np.ndarray
    stages: tuple[np.ndarray, np.ndarray, np.ndarray]


@inline_llvm
def take_steps(members, state, count):
    """Take `count` steps in all members.

    Inlined, because a call would copy all arrays of both arguments each time that a period of a member ends.
    """
    y, before = state.y, flush_subnormals()
    last = y.shape[0] // 2 - 2
    values = Values(load_batch(members.wall, 0), batch_slots(members.slots), members.unequal, last)
    preload = values.slots.preload
    h, beta = load_batch(state.h, 0), load_batch(members.beta, 0)
    c, s = load_batch(state.turn, 0), load_batch(state.turn, 1)
    sine, cosine = load_batch(state.phase, 0), load_batch(state.phase, 1)
    for _ in range(count):
        middle, middle_cosine = sine * c + cosine * s, cosine * c - sine * s
        end, end_cosine = middle * c + middle_cosine * s, middle_cosine * c - middle * s
        first_overlap = vector_overlap(preload, sine, load_batch(y, 1), 0)
        last_overlap = vector_overlap(preload, load_batch(y, last), load_batch(y, last + 1), last)
        chain_ends = batch_step(values, y, state.stages, h, sine, middle, end)
        update_batch_peaks(values, h, first_overlap, last_overlap, beta * cosine, chain_ends, state.end_contacts,
                           state.peaks)
        correct_contacts(values, y, state.overlaps, h, end)
        sine, cosine = end, end_cosine
    store(state.phase, 0, sine)
    store(state.phase, 1, cosine)
    restore_subnormals(before)


@inline_numba
def bring_back(state, member):
    """Record how far a member and its neighbour have parted in a period, and bring the neighbour back."""
    y, neighbour, rows = state.y, state.neighbour[member], state.y.shape[0]
    if not (is_finite_member(y, member) and is_finite_member(y, neighbour)):
        state.growth[member, :] = np.nan
        state.due[member] = 1
        return
    total = 0.0
    for i in range(rows):
        total += (y[i, neighbour] - y[i, member]) ** 2
    start, now = state.distance[member], max(sqrt(total), 1e-300)
    state.growth[member, state.periods[member] - 1] = log(now / start)
    for i in range(rows):
        y[i, neighbour] = y[i, member] + (y[i, neighbour] - y[i, member]) * (start / now)


@kernel
def batch_steps(members, state, count):
    """Take `count` steps in all members, whose periods do not end: for tests and benchmarks."""
    take_steps(members, state, count)


@kernel
def run_batch(members, state, stop, check):
    """Run until a member is due: its regime is decided, its periods are over, or it is not finite.

    Returns (status, member). Every member that is due is returned before any of them continues. `check` is the address
    of `check_member`.
    """
    steps_left, due, neighbour = state.steps_left, state.due, state.neighbour
    some_due, some_neighbour = True, False
    for member in range(BATCH_SIZE):
        if state.begins[member] != 0:
            call_at(check, (state, member))
        some_neighbour = some_neighbour or neighbour[member] >= 0
    while True:
        if some_due:
            for member in range(BATCH_SIZE):
                if due[member] != 0:
                    due[member] = 0
                    return (DONE if is_finite_member(state.y, member) else NOT_FINITE), member
            some_due = False
        if stop[0] != 0:
            return CANCELLED, -1
        count = STEPS_BETWEEN_STOP_CHECKS
        for member in range(BATCH_SIZE):
            count = min(count, steps_left[member])
        take_steps(members, state, count)
        for member in range(BATCH_SIZE):
            steps_left[member] -= count
            if steps_left[member] == 0 and end_period(state, member, check) and neighbour[member] != IS_NEIGHBOUR:
                due[member], some_due = 1, True
        if some_neighbour:
            for member in range(BATCH_SIZE):
                if neighbour[member] >= 0 and steps_left[member] == state.steps[member]:
                    bring_back(state, member)
                    some_due = some_due or due[member] != 0
