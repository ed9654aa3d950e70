"""Checks of a batch member's regime between its periods: is its motion periodic, may its transient be extrapolated?

Coarse run. An extrapolation reaches at most three times the distance that the contraction factor predicts
(`FARTHEST_EXTRAPOLATION`). If the change per orbit is not smaller afterwards, the extrapolation is undone, and the
record continues from the state before it. A chain may approach an unstable orbit before leaving it, and an
extrapolation could end on that orbit. So an orbit found by extrapolation is perturbed, and accepted only if the
perturbation decays. If it decays slowly, multipliers decide (steady/batch/job.py).

Fine run. It starts on the orbit of the coarse run and is extrapolated to its own orbit. Each extrapolation is checked
in the same way.

`begin_or_check_member` is the same for every structure. It takes longer to compile than the steps of a batch, so it is
a kernel of its own, which `run_batch` calls by address.
"""

from __future__ import annotations

from math import log

import numpy as np

from ..compiling.jit import inline_numba, internal, kernel
from ..equations.motion import copy
from ..strobes.extrapolation import ORBITS, reduced_rank
from ..strobes.periodicity import (
    LARGEST_TRUSTED_CONTRACTION,
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
    CHECK_CONTRACTION,
    CHECK_DISTANCE,
    CHECK_PERIOD,
    COARSE_ERROR_LEFT,
    FINE_CONTRACTION,
    FINE_EXTRAPOLATIONS,
    FINE_FORCES,
    FINE_GREW,
    FINE_ORBITS_BETWEEN,
    FINE_PERIOD,
    begin_fine_run,
    begin_member,
)
from .record import largest_force, move_member, undo_extrapolation

#: [period n] A batch: most strobes that are searched for a period.
MOST_STROBES_SEARCHED = 4 * LONGEST_PERIOD + 1
#: [period n] A batch: an approach is extrapolated if it would take more than this many further orbits.
_FEWEST_ORBITS_LEFT = 4.0
#: [period n] A batch: fewest drive periods from an extrapolation out of reach to the next attempt.
_PERIODS_AFTER_FAILURE = 8
#: [period n] A batch: an extrapolation reaches at most this many times change/(1 − contraction factor), the distance
#: before the last change.
FARTHEST_EXTRAPOLATION = 3.0
#: [period n] A batch: fewest orbits of the fine run over which changes must shrink; otherwise multipliers are computed.
_ORBITS_TO_GROW = 4
#: [period n] A batch: most extrapolations of the fine run.
_MOST_EXTRAPOLATIONS = 6
#: [period n] A batch: an orbit found by extrapolation is perturbed by this part of the motion.
_PERTURBATION = 1e-4
#: [period n] A batch: number of orbits in the test of that perturbation.
_TEST_ORBITS = 16
#: [no threshold] Number of orbits from the second to the last quarter of that test; these two are compared.
_ORBITS_BETWEEN_QUARTERS = _TEST_ORBITS // 2
#: [period n] A batch: largest part of the perturbation that may remain at the end of the test, relative to its first
#: quarter.
_PART_LEFT = 0.97
#: [period n] A batch: drive periods without extrapolation after a perturbation that did not decay.
_PAUSE_AFTER_FAILED_TEST = 400
#: [period n] A batch: upper limit of the reported contraction factor per orbit of a perturbation that has shrunk. Up to
#: 100 beads, multipliers are then computed.
_LARGEST_REPORTED_CONTRACTION = LARGEST_TRUSTED_CONTRACTION
#: [period n] A batch: largest contraction factor per drive period that is assumed after an extrapolation. Larger
#: factors are not measured accurately enough.
_LARGEST_ASSUMED_CONTRACTION = 0.98


@internal
def extrapolate_member(state, member, n, contraction, change):
    """Move a member to the limit of its last strobes, n periods apart; return whether that was within reach.

    `change` is the last change over n periods, `contraction` the factor per n periods, both from `detect_period`.
    """
    record, work, limit = state.record, state.work, state.work.limit
    last = record.strobe_count[member] - 1
    if last - record.first_strobe[0, member] < ORBITS * n or not 0.0 < contraction < 1.0:
        return False
    strobes = record.strobes[member, last - ORBITS * n : last + 1]
    reduced_rank(strobes[::n], work.basis, work.triangle, limit)
    write_scale(strobes, work.scale)
    reach = FARTHEST_EXTRAPOLATION * change / (1.0 - contraction)
    for q in range(2):
        for i in range(limit.shape[1]):
            if not abs(limit[q, i] - strobes[ORBITS * n, q, i]) <= reach * work.scale[q]:
                return False
    move_member(state, member, limit)
    return True


@internal
def check_coarse(state, member):
    """Check whether a member's last strobes are periodic; if they only approach an orbit, extrapolate the transient.

    Returns whether its regime is decided.
    """
    search, schedule, record = state.search, state.schedule, state.record
    strobes = record.strobes[member, record.first_strobe[0, member] : record.strobe_count[member]]
    periods, count = record.periods[member], strobes.shape[0]
    detected = detect_period(  # int64, as from Python: one specialization
        strobes[max(0, count - MOST_STROBES_SEARCHED) :], np.int64(LONGEST_PERIOD), ROUNDING, SETTLED_DISTANCE,
        search.slowest_contraction[member], state.work.scale, state.work.change)
    n, contraction, change = detected.approached, detected.approach_contraction, detected.approach_change
    last_check = search.last_check[member]
    last_check[CHECK_PERIOD], last_check[CHECK_CONTRACTION] = detected.period, detected.contraction
    last_check[CHECK_DISTANCE] = detected.distance
    if detected.period > 0 and search.slowest_contraction[member] > 0.0:
        perturb(state, member, detected.period)
        return False
    if detected.period > 0:
        return True
    if search.change_before[member] > 0.0:
        confirmed = n > 0 and change < search.change_before[member]
        search.change_before[member] = 0.0
        if not confirmed:
            go_back_and_wait(state, member)
            return False
    left = change * contraction / (1.0 - contraction) if n > 0 else 0.0
    if periods < search.extrapolate_from[member] or left <= SETTLED_DISTANCE:
        return False
    if log(SETTLED_DISTANCE / left) > _FEWEST_ORBITS_LEFT * log(contraction):
        return False  # it will settle sooner without extrapolation
    keep_state_before(search, strobes[count - 1], member)
    if extrapolate_member(state, member, n, contraction, change):
        search.change_before[member] = change
        search.contraction_before[member] = search.slowest_contraction[member]
        slowest = max(search.slowest_contraction[member], contraction ** (1.0 / n))
        search.slowest_contraction[member] = min(_LARGEST_ASSUMED_CONTRACTION, slowest)
        schedule.next_check[member] = periods + window_of(n) + n + 1
        search.extrapolate_from[member] = periods + ORBITS * n
    else:
        search.extrapolate_from[member] = periods + max(_PERIODS_AFTER_FAILURE, count // 4)
    return False


@inline_numba
def go_back_and_wait(state, member):
    """Undo a coarse member's extrapolation, and wait twice as long as last time before the next."""
    search, periods = state.search, state.record.periods
    undo_extrapolation(state, member)
    search.slowest_contraction[member] = search.contraction_before[member]
    search.wait_after_undo[member] *= 2
    search.extrapolate_from[member] = periods[member] + search.wait_after_undo[member]
    state.schedule.next_check[member] = periods[member] + periods_to_next_check(state.record, member)


@internal
def keep_state_before(search, strobe, member):
    """Keep the state to which a member returns if an extrapolation is undone or a perturbation has decayed."""
    copy(strobe[0], search.state_before[member, 0])
    copy(strobe[1], search.state_before[member, 1])


@inline_numba
def perturb(state, member, period):
    """Perturb a member that seems to be on an orbit; keep the orbit's state and forces."""
    record, search, work = state.record, state.search, state.work
    keep_state_before(search, record.strobes[member, record.strobe_count[member] - 1], member)
    for q in range(2):
        for i in range(work.limit.shape[1]):
            offset = (1 - 2 * (i % 2)) * _PERTURBATION * work.scale[q]
            work.limit[q, i] = search.state_before[member, q, i] + offset
    for q in range(3):
        search.fine_record[member, FINE_FORCES + q] = largest_force(record, member, period, q)
    move_member(state, member, work.limit)
    search.tested_period[member] = period
    state.schedule.next_check[member] = record.periods[member] + _TEST_ORBITS * period


@inline_numba
def judge_perturbation(state, member):
    """Check whether a member's perturbation has decayed, at the end of the test.

    If so, the member returns to its orbit, and the contraction factor is recorded. Otherwise extrapolation pauses.
    Returns whether its regime is decided, which is whether the perturbation has decayed.
    """
    search, record, scale = state.search, state.record, state.work.scale
    n, bodies = search.tested_period[member], state.work.limit.shape[1]
    strobes = record.strobes[member, record.first_strobe[0, member] : record.strobe_count[member]]
    search.tested_period[member] = 0
    write_scale(strobes[: _TEST_ORBITS * n + 1], scale)  # other members have used it in the meantime
    first, middle, late, last = 0.0, 0.0, 0.0, 0.0
    for k in range(_TEST_ORBITS + 1):
        largest, squares = 0.0, 0.0
        for q in range(2):
            for i in range(bodies):
                offset = (strobes[k * n, q, i] - search.state_before[member, q, i]) / scale[q]
                largest, squares = max(largest, abs(offset)), squares + offset**2
        quarter = 4 * k // (_TEST_ORBITS + 1)
        first = max(first, largest) if quarter == 0 else first
        middle += squares if quarter == 1 else 0.0
        late += squares if quarter == 3 else 0.0
        last = largest
    if last <= _PART_LEFT * first:
        move_member(state, member, search.state_before[member])
        contraction = (late / middle) ** (0.5 / _ORBITS_BETWEEN_QUARTERS) if middle > 0.0 else 0.0  # of squares
        contraction = min(contraction, _LARGEST_REPORTED_CONTRACTION)
        search.last_check[member, CHECK_CONTRACTION] = max(search.last_check[member, CHECK_CONTRACTION], contraction)
        return True
    search.slowest_contraction[member], search.change_before[member] = 0.0, 0.0
    search.last_check[member, CHECK_PERIOD] = 0.0  # this member leaves the orbit that was found
    search.extrapolate_from[member] = record.periods[member] + _PAUSE_AFTER_FAILED_TEST
    return False


@inline_numba
def check_fine(state, member):
    """Check whether the coarse orbit's error has decayed in a fine member; if not, extrapolate its transient.

    If changes are not smaller after an extrapolation, it is undone, and the member is not extrapolated again. Returns
    whether the fine run is at its end, and the member therefore due.
    """
    record, search, schedule, scale = state.record, state.search, state.schedule, state.work.scale
    fine, last_check, count = search.fine_record[member], search.last_check[member], record.strobe_count[member]
    n, contraction = int(fine[FINE_PERIOD]), fine[FINE_CONTRACTION]
    last_orbit = record.strobes[member, count - 1 - n : count]
    write_scale(last_orbit, scale)
    change = change_between(last_orbit, scale, n, 0)
    last_check[CHECK_PERIOD], last_check[CHECK_CONTRACTION] = n, contraction
    last_check[CHECK_DISTANCE] = change * contraction / (1.0 - contraction)
    confirmed = change < search.change_before[member] or search.change_before[member] == 0.0
    search.change_before[member] = 0.0
    if not confirmed:
        undo_extrapolation(state, member)
        schedule.next_check[member] = record.periods[member] + n * int(fine[FINE_ORBITS_BETWEEN])
        fine[FINE_EXTRAPOLATIONS] = _MOST_EXTRAPOLATIONS
        return False
    moved = 0.0
    for q in range(1, 3):  # the forces on the wall, the last to settle
        largest = largest_force(record, member, n, q)
        moved = max(moved, abs(largest - fine[FINE_FORCES + q]) / largest if largest > 0.0 else 0.0)
    close = last_check[CHECK_DISTANCE] <= max(SETTLED_DISTANCE, COARSE_ERROR_LEFT * moved)
    if close or fine[FINE_EXTRAPOLATIONS] >= _MOST_EXTRAPOLATIONS:
        last_check[CHECK_PERIOD] = period_of_fine_run(state, member, n)
        return True
    first = record.first_strobe[0, member]
    if count - first > _ORBITS_TO_GROW * n:
        grew = change > change_between(record.strobes[member, first : first + n + 1], scale, n, 0)
        fine[FINE_GREW] = max(fine[FINE_GREW], 1.0 if grew else 0.0)
    fine[FINE_EXTRAPOLATIONS] += 1.0
    keep_state_before(search, last_orbit[n], member)
    if extrapolate_member(state, member, n, contraction, change):
        search.change_before[member] = change
    schedule.next_check[member] = record.periods[member] + n * int(fine[FINE_ORBITS_BETWEEN])
    return False


@inline_numba
def period_of_fine_run(state, member, n):
    """Period of the fine run's orbit: n or a divisor of n, since the period may be doubled by coarse steps alone.

    It is n if the record has fewer than two orbits.
    """
    record = state.record
    strobes = record.strobes[member, record.first_strobe[0, member] : record.strobe_count[member]]
    if strobes.shape[0] < 2 * n:
        return n
    return shortest(strobes, state.work.scale, n, state.search.last_check[member, CHECK_DISTANCE], SETTLED_DISTANCE)


@internal
def periods_to_next_check(record, member):
    """Periods until a member's record is checked again: about a sixth of its length."""
    return max(3, (record.strobe_count[member] - record.first_strobe[0, member]) // 6)


@kernel
def begin_or_check_member(state, member):
    """Begin a new member; otherwise check its regime, or how much of its perturbation remains.

    Returns whether the member is due. A coarse member whose orbit has been found begins its fine run instead, if one is
    requested. If nothing is decided, the next check is scheduled. New members begin here so that this code is compiled
    once for all structures.
    """
    search, schedule, record = state.search, state.schedule, state.record
    if schedule.begins[member] != 0:
        schedule.begins[member] = 0
        begin_member(state, member)
        return False
    schedule.next_check[member] = record.periods[member] + periods_to_next_check(record, member)
    if search.fine_record[member, FINE_PERIOD] > 0.0:
        return check_fine(state, member)
    decided = judge_perturbation(state, member) if search.tested_period[member] > 0 else check_coarse(state, member)
    if decided and schedule.fine_steps[member] > 0:
        begin_fine_run(state, member)
        return False
    return decided
