"""Checks of a batch member's regime, between its periods: is its motion periodic, may its transient be extrapolated?

Coarse run. An extrapolation reaches at most three times the distance that its decay predicts
(`FARTHEST_EXTRAPOLATION`). If the change per orbit is not smaller after it than before, the extrapolation is undone,
and the record goes on from where it was. A chain may approach an unstable orbit before it leaves it, and an
extrapolation could end on that orbit. So an orbit found by extrapolation is disturbed, and accepted only if the
disturbance decays. If it decays slowly, multipliers decide (steady/batch/job.py).

Finer run. It starts on the orbit of the coarse run and is extrapolated to its own orbit; each extrapolation is checked
in the same way.

`check_member` is the same for every structure. It takes longer to compile than the steps of a batch, so it is a kernel
of its own, which `run_batch` calls by its address.
"""

from __future__ import annotations

from math import log

import numpy as np

from ..compiling.jit import inline_numba, internal, kernel
from ..equations.motion import copy
from ..strobes.extrapolation import ORBITS, reduced_rank
from ..strobes.periodicity import (
    LONGEST_PERIOD,
    ROUNDING,
    SETTLED_DISTANCE,
    change_between,
    detect_period,
    shortest,
    window_of,
    write_scale,
)
from .begin import (
    CHECK_DECAY,
    CHECK_DISTANCE,
    CHECK_PERIOD,
    COARSE_ERROR_LEFT,
    FINE_CONTRACTION,
    FINE_EXTRAPOLATIONS,
    FINE_FORCES,
    FINE_GREW,
    FINE_ORBITS_BETWEEN,
    FINE_PERIOD,
    begin_finer_run,
    begin_member,
)
from .record import largest_force, move_member, undo_extrapolation

#: [period n] A batch: most strobes on which a period is looked for.
MOST_STROBES_SEARCHED = 4 * LONGEST_PERIOD + 1
#: [period n] A batch: an approach is extrapolated if more than this many orbits are left to run.
_FEWEST_ORBITS_LEFT = 4.0
#: [period n] A batch: fewest drive periods from an extrapolation that was out of reach to the next one.
_PERIODS_AFTER_FAILURE = 8
#: [period n] A batch: an extrapolation reaches at most this many times as far as change/(1 − decay), the distance
#: before the last change.
FARTHEST_EXTRAPOLATION = 3.0
#: [period n] A batch: fewest orbits of the finer run in which changes must shrink, else multipliers are computed.
_ORBITS_TO_GROW = 4
#: [period n] A batch: most extrapolations of the finer run.
_MOST_EXTRAPOLATIONS = 6
#: [period n] A batch: an orbit found by extrapolation is disturbed by this part of the motion.
_DISTURBANCE = 1e-4
#: [period n] A batch: orbits in the test of that disturbance.
_TEST_ORBITS = 16
#: [no threshold] Orbits from the second quarter of that test to the last, which are compared.
_ORBITS_BETWEEN_QUARTERS = _TEST_ORBITS // 2
#: [period n] A batch: largest part of the disturbance that may be left at the end of the test, relative to its first
#: quarter.
_PART_LEFT = 0.97
#: [period n] A batch: drive periods without extrapolation after a disturbance that did not decay.
_PAUSE_AFTER_FAILED_TEST = 400
#: [period n] A batch: slowest decay per orbit that is reported for a disturbance that shrank. Up to 100 beads,
#: multipliers are then computed.
_SLOWEST_REPORTED_DECAY = 0.9999
#: [period n] A batch: slowest decay per drive period that is assumed after an extrapolation. Slower ones are not
#: measured well enough.
_SLOWEST_ASSUMED_DECAY = 0.98


@internal
def extrapolate_member(state, member, n, decay, change):
    """Move a member to the limit of its last strobes, n periods apart; returns whether that was within reach.

    `change` is the last change over n periods, `decay` its factor per n periods, as `detect_period` returns them.
    """
    record = state.strobes[member, state.first_strobe[0, member] : state.strobe_count[member]]
    count = record.shape[0]
    if count < ORBITS * n + 1 or not 0.0 < decay < 1.0:
        return False
    limit, record = state.limit, record[count - 1 - ORBITS * n :]
    reduced_rank(record[::n], state.basis, state.triangle, limit)
    write_scale(record, state.scale)
    reach = FARTHEST_EXTRAPOLATION * change / (1.0 - decay)
    for q in range(2):
        for i in range(limit.shape[1]):
            if not abs(limit[q, i] - record[ORBITS * n, q, i]) <= reach * state.scale[q]:
                return False
    move_member(state, member, limit)
    return True


@internal
def check_coarse(state, member):
    """Whether a member's last strobes are periodic; if they only approach an orbit, the transient is extrapolated."""
    record = state.strobes[member, state.first_strobe[0, member] : state.strobe_count[member]]
    periods = state.periods[member]
    count = record.shape[0]
    period, decay, distance, n, approach_decay, change = detect_period(  # an int64, as from Python: one version serves
        record[max(0, count - MOST_STROBES_SEARCHED) :], np.int64(LONGEST_PERIOD), ROUNDING, SETTLED_DISTANCE,
        state.slowest_decay[member], state.scale, state.change)
    last_check = state.last_check[member]
    last_check[CHECK_PERIOD], last_check[CHECK_DECAY], last_check[CHECK_DISTANCE] = period, decay, distance
    if period > 0 and state.slowest_decay[member] > 0.0:
        disturb(state, member, period)
        return False
    if period > 0:
        return True
    if state.change_before_extrapolation[member] > 0.0:
        proved = n > 0 and change < state.change_before_extrapolation[member]
        state.change_before_extrapolation[member] = 0.0
        if not proved:
            undo_extrapolation(state, member)
            state.slowest_decay[member] = state.slowest_decay_before[member]
            periods = state.periods[member]
            state.wait_after_undo[member] *= 2
            state.extrapolate_from[member] = periods + state.wait_after_undo[member]
            state.next_check[member] = periods + periods_to_next_check(state, member)
            return False
    left = change * approach_decay / (1.0 - approach_decay) if n > 0 else 0.0
    if periods < state.extrapolate_from[member] or left <= SETTLED_DISTANCE:
        return False
    if log(SETTLED_DISTANCE / left) > _FEWEST_ORBITS_LEFT * log(approach_decay):
        return False  # it settles sooner without extrapolation
    copy(record[count - 1, 0], state.state_before[member, 0])
    copy(record[count - 1, 1], state.state_before[member, 1])
    if extrapolate_member(state, member, n, approach_decay, change):
        state.change_before_extrapolation[member] = change
        state.slowest_decay_before[member] = state.slowest_decay[member]
        slowest = max(state.slowest_decay[member], approach_decay ** (1.0 / n))
        state.slowest_decay[member] = min(_SLOWEST_ASSUMED_DECAY, slowest)
        state.next_check[member] = periods + window_of(n) + n + 1
        state.extrapolate_from[member] = periods + ORBITS * n
    else:
        state.extrapolate_from[member] = periods + max(_PERIODS_AFTER_FAILURE, count // 4)
    return False


@inline_numba
def disturb(state, member, period):
    """Disturb a member that seems to be on an orbit, keeping the orbit's state and forces."""
    bodies, last = state.limit.shape[1], state.strobe_count[member] - 1
    for q in range(2):
        copy(state.strobes[member, last, q], state.state_before[member, q])
        for i in range(bodies):
            state.limit[q, i] = state.state_before[member, q, i] + (1 - 2 * (i % 2)) * _DISTURBANCE * state.scale[q]
    for q in range(3):
        state.fine_record[member, FINE_FORCES + q] = largest_force(state, member, period, q)
    move_member(state, member, state.limit)
    state.tested_period[member] = period
    state.next_check[member] = state.periods[member] + _TEST_ORBITS * period


@inline_numba
def judge_disturbance(state, member):
    """Whether a member's disturbance has decayed, at the end of the test.

    The member then goes back to its orbit, and the decay is recorded; else extrapolation pauses.
    """
    n, bodies = state.tested_period[member], state.limit.shape[1]
    record = state.strobes[member, state.first_strobe[0, member] : state.strobe_count[member]]
    state.tested_period[member] = 0
    write_scale(record[: _TEST_ORBITS * n + 1], state.scale)  # other members have used it since
    first, middle, late, last = 0.0, 0.0, 0.0, 0.0
    for k in range(_TEST_ORBITS + 1):
        there, whole = 0.0, 0.0
        for q in range(2):
            for i in range(bodies):
                offset = (record[k * n, q, i] - state.state_before[member, q, i]) / state.scale[q]
                there, whole = max(there, abs(offset)), whole + offset**2
        quarter = 4 * k // (_TEST_ORBITS + 1)
        first = max(first, there) if quarter == 0 else first
        middle += whole if quarter == 1 else 0.0
        late += whole if quarter == 3 else 0.0
        last = there
    if last <= _PART_LEFT * first:
        move_member(state, member, state.state_before[member])
        decay = (late / middle) ** (0.5 / _ORBITS_BETWEEN_QUARTERS) if middle > 0.0 else 0.0  # of squares
        decay = min(decay, _SLOWEST_REPORTED_DECAY)
        state.last_check[member, CHECK_DECAY] = max(state.last_check[member, CHECK_DECAY], decay)
        return True
    state.slowest_decay[member], state.change_before_extrapolation[member] = 0.0, 0.0
    state.last_check[member, CHECK_PERIOD] = 0.0  # this member does not stay on the orbit that was found
    state.extrapolate_from[member] = state.periods[member] + _PAUSE_AFTER_FAILED_TEST
    return False


@inline_numba
def check_fine(state, member):
    """Whether the coarse orbit's error has decayed in a fine member; if not, its transient is extrapolated.

    If changes are not smaller after an extrapolation, it is undone, and the member is not extrapolated again.
    """
    fine, count, last_check = state.fine_record[member], state.strobe_count[member], state.last_check[member]
    n, contraction = int(fine[FINE_PERIOD]), fine[FINE_CONTRACTION]
    record = state.strobes[member, count - 1 - n : count]
    write_scale(record, state.scale)
    change = change_between(record, state.scale, n, 0)
    last_check[CHECK_PERIOD], last_check[CHECK_DECAY] = n, contraction
    last_check[CHECK_DISTANCE] = change * contraction / (1.0 - contraction)
    proved = change < state.change_before_extrapolation[member] or state.change_before_extrapolation[member] == 0.0
    state.change_before_extrapolation[member] = 0.0
    if not proved:
        undo_extrapolation(state, member)
        state.next_check[member] = state.periods[member] + n * int(fine[FINE_ORBITS_BETWEEN])
        fine[FINE_EXTRAPOLATIONS] = _MOST_EXTRAPOLATIONS
        return False
    moved = 0.0
    for q in range(1, 3):  # the forces on the wall, the last to come to rest
        largest = largest_force(state, member, n, q)
        moved = max(moved, abs(largest - fine[FINE_FORCES + q]) / largest if largest > 0.0 else 0.0)
    close = last_check[CHECK_DISTANCE] <= max(SETTLED_DISTANCE, COARSE_ERROR_LEFT * moved)
    if close or fine[FINE_EXTRAPOLATIONS] >= _MOST_EXTRAPOLATIONS:
        last_check[CHECK_PERIOD] = period_of_finer_run(state, member, n)
        return True
    first = state.first_strobe[0, member]
    if count - first > _ORBITS_TO_GROW * n:
        earliest = state.strobes[member, first : first + n + 1]
        fine[FINE_GREW] = max(fine[FINE_GREW], 1.0 if change > change_between(earliest, state.scale, n, 0) else 0.0)
    fine[FINE_EXTRAPOLATIONS] += 1.0
    copy(state.strobes[member, count - 1, 0], state.state_before[member, 0])
    copy(state.strobes[member, count - 1, 1], state.state_before[member, 1])
    if extrapolate_member(state, member, n, contraction, change):
        state.change_before_extrapolation[member] = change
    state.next_check[member] = state.periods[member] + n * int(fine[FINE_ORBITS_BETWEEN])
    return False


@inline_numba
def period_of_finer_run(state, member, n):
    """Period of the finer run's orbit: n or a divisor of n, since an orbit may double with coarse steps alone.

    It is n where the record has fewer than two orbits.
    """
    record = state.strobes[member, state.first_strobe[0, member] : state.strobe_count[member]]
    if record.shape[0] < 2 * n:
        return n
    return shortest(record, state.scale, n, state.last_check[member, CHECK_DISTANCE], SETTLED_DISTANCE)


@internal
def periods_to_next_check(state, member):
    """Periods until a member's record is checked again: about a sixth of its length."""
    return max(3, (state.strobe_count[member] - state.first_strobe[0, member]) // 6)


@kernel
def check_member(state, member):
    """Begin a member that is new, or check its regime, or what is left of its disturbance.

    Returns whether the member is due. A coarse member whose orbit is found begins its finer run instead, if one is
    wanted. If nothing is decided, the next check is set.
    """
    if state.begins[member] != 0:
        state.begins[member] = 0
        begin_member(state, member)
        return False
    state.next_check[member] = state.periods[member] + periods_to_next_check(state, member)
    if state.fine_record[member, FINE_PERIOD] > 0.0:
        return check_fine(state, member)
    found = judge_disturbance(state, member) if state.tested_period[member] > 0 else check_coarse(state, member)
    if found and state.finer_steps[member] > 0:
        begin_finer_run(state, member)
        return False
    return found
