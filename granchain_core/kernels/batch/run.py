"""Several chains at once, one per SIMD lane: RK4 in w with a fixed step, for curves and maps.

All members have the same effects and the same N; every value may differ, including the step and the number of steps per
period. Each member is checked at the ends of its own periods. When a member may have settled, or has reached its last
period, the kernel returns, and the next scene can take over its lane. The index `member` is the lane.

The order of one step, `take_steps`:

1. overlaps of both end contacts at the start of the step (effects/preload.py);
2. `batch_step`: four stages, each a pass along the chains that computes contacts and beads (step.py);
3. `update_batch_peaks`: largest forces and jumps up to the start of the step (step.py, forces/peaks.py);
4. `correct_contacts`: the step's error at contacts that opened or closed in it (contact_correction.py).

At the end of a member's period, `end_period` records its strobe and forces, and checks its regime if a check is due
(period_end.py, checks.py). Then its neighbouring trajectory, if it has one, is brought back.
"""

from __future__ import annotations

from math import log, sqrt

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
from .state import IS_NEIGHBOUR
from .step import Values, batch_step, update_batch_peaks


@inline_llvm
def take_steps(members, motion, count):
    """Take `count` steps in all members.

    Inlined, because a call would copy all array descriptors of both arguments each time a member's period ends.
    """
    y, before = motion.y, flush_subnormals()
    last = y.shape[0] // 2 - 2
    values = Values(load_batch(members.wall, 0), batch_slots(members.slots), members.unequal, last)
    preload = values.slots.preload
    h, beta = load_batch(motion.h, 0), load_batch(members.beta, 0)
    s, c = load_batch(motion.half_step, 0), load_batch(motion.half_step, 1)
    sine, cosine = load_batch(motion.phase, 0), load_batch(motion.phase, 1)
    for _ in range(count):
        middle, middle_cosine = sine * c + cosine * s, cosine * c - sine * s
        end, end_cosine = middle * c + middle_cosine * s, middle_cosine * c - middle * s
        first_overlap = vector_overlap(preload, sine, load_batch(y, 1), 0)
        last_overlap = vector_overlap(preload, load_batch(y, last), load_batch(y, last + 1), last)
        chain_ends = batch_step(values, y, motion.stages, h, sine, middle, end)
        update_batch_peaks(values, h, first_overlap, last_overlap, beta * cosine, chain_ends, motion.end_contacts,
                           motion.peaks)
        correct_contacts(values, y, motion.overlaps, h, end)
        sine, cosine = end, end_cosine
    store(motion.phase, 0, sine)
    store(motion.phase, 1, cosine)
    restore_subnormals(before)


@inline_numba
def bring_back(state, member):
    """Record how far a member and its neighbour have separated in a period, and bring the neighbour back."""
    y, pairs = state.motion.y, state.pairs
    neighbour, rows = pairs.neighbour[member], y.shape[0]
    if not (is_finite_member(y, member) and is_finite_member(y, neighbour)):
        pairs.growth[member, :] = np.nan
        state.schedule.due[member] = 1
        return
    total = 0.0
    for i in range(rows):
        total += (y[i, neighbour] - y[i, member]) ** 2
    wanted, distance = pairs.distance[member], max(sqrt(total), 1e-300)
    pairs.growth[member, state.record.periods[member] - 1] = log(distance / wanted)
    for i in range(rows):
        y[i, neighbour] = y[i, member] + (y[i, neighbour] - y[i, member]) * (wanted / distance)


@kernel
def batch_steps(members, motion, count):
    """Take `count` steps in all members without ending periods, for tests and benchmarks."""
    take_steps(members, motion, count)


@kernel
def run_batch(members, state, stop, check):
    """Run until a member is due: its regime is decided, its periods are used up, or its state is not finite.

    Returns (status, member). Every member that is due is returned before any of them continues. `check` is the address
    of `begin_or_check_member`.
    """
    schedule, neighbour = state.schedule, state.pairs.neighbour
    steps_left, due = schedule.steps_left, schedule.due
    some_due, some_neighbour = True, False
    for member in range(BATCH_SIZE):
        if schedule.begins[member] != 0:
            call_at(check, (state, member))
        some_neighbour = some_neighbour or neighbour[member] >= 0
    while True:
        if some_due:
            for member in range(BATCH_SIZE):
                if due[member] != 0:
                    due[member] = 0
                    return (DONE if is_finite_member(state.motion.y, member) else NOT_FINITE), member
            some_due = False
        if stop[0] != 0:
            return CANCELLED, -1
        count = STEPS_BETWEEN_STOP_CHECKS
        for member in range(BATCH_SIZE):
            count = min(count, steps_left[member])
        take_steps(members, state.motion, count)
        for member in range(BATCH_SIZE):
            steps_left[member] -= count
            if steps_left[member] == 0 and end_period(state, member, check) and neighbour[member] != IS_NEIGHBOUR:
                due[member], some_due = 1, True
        if some_neighbour:
            for member in range(BATCH_SIZE):
                if neighbour[member] >= 0 and steps_left[member] == schedule.steps[member]:
                    bring_back(state, member)
                    some_due = some_due or due[member] != 0
