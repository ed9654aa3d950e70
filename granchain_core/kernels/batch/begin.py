"""The beginning of a batch member: at a state set by the caller, or with fine steps on its coarse run's orbit."""

from __future__ import annotations

from math import ceil, cos, log, pi, sin

from ..compiling.jit import inline_numba, internal
from ..equations.motion import copy
from ..strobes.extrapolation import ORBITS
from ..strobes.periodicity import assumed_contraction
from .record import append_strobe, forget_last_step, largest_force

#: [no threshold] A period that no member reaches.
NEVER = 2**63 - 1
#: [period n] A batch: drive periods without extrapolation after the first extrapolation that did not help; doubled
#: after each further one. The record of strobes and the count of periods then continue from the state before the
#: extrapolation (`undo_extrapolation` in kernels/batch/record.py).
_FIRST_PAUSE = 16
#: [period n] A batch: fewest orbits between two checks of the fine run.
_FEWEST_ORBITS = 2
#: [period n] A batch: largest part of the coarse orbit's error that may remain in the fine run.
COARSE_ERROR_LEFT = 0.02
#: [period n] A batch: lower bound of the factor by which the coarse orbit's error is assumed to shrink per orbit.
_LEAST_CONTRACTION = 1e-3
#: Columns of `last_check`: period in drive periods, contraction factor per orbit, remaining distance to the orbit. The
#: last name is the number of columns.
CHECK_PERIOD, CHECK_CONTRACTION, CHECK_DISTANCE, CHECK_COLUMNS = range(4)
#: Columns of `fine_record`: the orbit's period and contraction factor, the coarse run's three largest forces (from
#: FINE_FORCES on), orbits between two extrapolations, extrapolations so far, 1 if changes grew before one.
FINE_PERIOD, FINE_CONTRACTION, FINE_FORCES, FINE_ORBITS_BETWEEN, FINE_EXTRAPOLATIONS, FINE_GREW = 0, 1, 2, 5, 6, 7
#: [no threshold] Number of columns of `fine_record`.
FINE_COLUMNS = 8
#: Columns of `coarse_orbit` after those of `last_check`: slowest contraction before an extrapolation (0 without one),
#: number of drive periods run. The last name is the number of columns.
ORBIT_SLOWEST_CONTRACTION, ORBIT_PERIODS, ORBIT_COLUMNS = CHECK_COLUMNS, CHECK_COLUMNS + 1, CHECK_COLUMNS + 2


@internal
def begin_member(state, member):
    """Begin at the member's `y`, at phase 0, with `steps` steps per period and an empty record.

    Arrays that are always written before they are read are not cleared: `record.maxima`, `record.strobes`,
    `search.state_before`, `search.coarse_orbit`, `pairs.distance`, `pairs.growth`. The caller, `Batch.put`, sets the
    rest of `schedule`, y and the overlaps at rest, `search.fine_record` and `pairs.neighbour`.
    """
    motion, schedule, record, search = state.motion, state.schedule, state.record, state.search
    half = pi / schedule.steps[member]
    motion.half_step[0, member], motion.half_step[1, member] = sin(half), cos(half)
    motion.h[0, member] = schedule.drive_period[member] / schedule.steps[member]
    motion.phase[0, member], motion.phase[1, member] = 0.0, 1.0
    for row in range(motion.peaks.shape[0]):
        motion.peaks[row, member] = 0.0
    forget_last_step(motion, member)
    schedule.steps_left[member], schedule.due[member] = schedule.steps[member], 0
    record.periods[member], record.strobe_count[member] = 0, 0
    record.first_strobe[0, member], record.first_strobe[1, member] = 0, 0
    append_strobe(record, motion.y, member)
    search.extrapolate_from[member], search.wait_after_undo[member] = 0, _FIRST_PAUSE
    search.slowest_contraction[member], search.contraction_before[member] = 0.0, 0.0
    search.change_before[member], search.tested_period[member] = 0.0, 0
    for column in range(CHECK_COLUMNS):
        search.last_check[member, column] = 0.0


@inline_numba
def begin_fine_run(state, member):
    """Continue with fine steps from the orbit that the coarse run found; its results are kept in `coarse_orbit`.

    The fine run is checked once the difference from the coarse orbit has decayed.
    """
    schedule, search = state.schedule, state.search
    orbit, fine = search.coarse_orbit[member], search.fine_record[member]
    copy(search.last_check[member], orbit)
    orbit[ORBIT_SLOWEST_CONTRACTION] = search.slowest_contraction[member]
    orbit[ORBIT_PERIODS] = state.record.periods[member]
    period = int(orbit[CHECK_PERIOD])
    if search.slowest_contraction[member] == 0.0:  # otherwise they were kept when the orbit was perturbed
        for q in range(3):
            fine[FINE_FORCES + q] = largest_force(state.record, member, period, q)
    contraction = coarse_contraction(orbit[CHECK_CONTRACTION])
    orbits = orbits_until_checked(contraction)
    schedule.steps[member], schedule.fine_steps[member] = schedule.fine_steps[member], 0
    begin_member(state, member)
    schedule.return_at[member], schedule.next_check[member] = NEVER, orbits * period
    fine[FINE_PERIOD], fine[FINE_CONTRACTION], fine[FINE_ORBITS_BETWEEN] = period, contraction, orbits
    fine[FINE_EXTRAPOLATIONS], fine[FINE_GREW] = 0.0, 0.0


@internal
def coarse_contraction(observed):
    """Factor by which the coarse orbit's error is assumed to shrink per orbit, from the observed factor."""
    return max(_LEAST_CONTRACTION, assumed_contraction(observed))


@internal
def orbits_until_checked(contraction):
    """Orbits until a fine run is checked: at most `COARSE_ERROR_LEFT` of the coarse orbit's error remains then."""
    return min(ORBITS, max(_FEWEST_ORBITS, ceil(log(COARSE_ERROR_LEFT) / log(contraction))))
