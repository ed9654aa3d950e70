"""A batch member's beginning: at a state that the caller set, or, with finer steps, on the orbit of its coarse run."""

from __future__ import annotations

from math import ceil, cos, log, pi, sin

from ..compiling.jit import inline_numba, internal
from ..equations.motion import copy
from ..strobes.extrapolation import ORBITS
from ..strobes.periodicity import assumed_decay
from .record import append_strobe, forget_last_step, largest_force

#: [no threshold] A period that no member reaches.
NEVER = 2**63 - 1
#: [period n] A batch: drive periods without extrapolation after the first one that did not help; doubled at each
#: further one. The record of strobes and the count of periods then go on from the state before the attempt
#: (`undo_extrapolation` in kernels/batch/record.py).
_FIRST_PAUSE = 16
#: [period n] A batch: fewest orbits between two checks of the finer run.
_FEWEST_ORBITS = 2
#: [period n] A batch: largest part of the coarse orbit's error that may be left in the finer run.
COARSE_ERROR_LEFT = 0.02
#: [period n] A batch: lower bound of the factor by which the coarse orbit's error is assumed to shrink per orbit.
_LEAST_CONTRACTION = 1e-3
#: Columns of `last_check`: period in drive periods, decay per orbit, distance left to the orbit; and their number.
CHECK_PERIOD, CHECK_DECAY, CHECK_DISTANCE, CHECK_COLUMNS = range(4)
#: Columns of `fine_record`: the orbit's period and contraction, the coarse run's three largest forces (from FINE_FORCES
#: on), orbits between two extrapolations, extrapolations so far, 1 if changes grew before one.
FINE_PERIOD, FINE_CONTRACTION, FINE_FORCES, FINE_ORBITS_BETWEEN, FINE_EXTRAPOLATIONS, FINE_GREW = 0, 1, 2, 5, 6, 7
#: [no threshold] Their number.
FINE_COLUMNS = 8
#: Columns of `coarse_orbit`: those of `last_check`, slowest decay before an extrapolation (0 without one), drive
#: periods run; and their number.
ORBIT_SLOWEST_DECAY, ORBIT_PERIODS, ORBIT_COLUMNS = CHECK_COLUMNS, CHECK_COLUMNS + 1, CHECK_COLUMNS + 2


@internal
def begin_member(state, member):
    """Begin at the member's `y`, at phase 0, with `steps` steps a period and an empty record."""
    half = pi / state.steps[member]
    state.turn[0, member], state.turn[1, member] = cos(half), sin(half)
    state.h[0, member] = state.drive_period[member] / state.steps[member]
    state.phase[0, member], state.phase[1, member] = 0.0, 1.0
    for row in range(state.peaks.shape[0]):
        state.peaks[row, member] = 0.0
    forget_last_step(state, member)
    state.steps_left[member], state.periods[member], state.due[member] = state.steps[member], 0, 0
    state.strobe_count[member], state.first_strobe[0, member], state.first_strobe[1, member] = 0, 0, 0
    append_strobe(state.strobes, state.strobe_count, state.first_strobe, state.y, member)
    state.extrapolate_from[member], state.wait_after_undo[member] = 0, _FIRST_PAUSE
    state.slowest_decay[member], state.slowest_decay_before[member] = 0.0, 0.0
    state.change_before_extrapolation[member], state.tested_period[member] = 0.0, 0
    for column in range(CHECK_COLUMNS):
        state.last_check[member, column] = 0.0


@inline_numba
def begin_finer_run(state, member):
    """Go on from the orbit that the coarse run found, with finer steps; `coarse_orbit` keeps what it found.

    The finer run is checked once the difference from the coarse orbit has decayed.
    """
    found, fine = state.coarse_orbit[member], state.fine_record[member]
    copy(state.last_check[member], found)
    found[ORBIT_SLOWEST_DECAY], found[ORBIT_PERIODS] = state.slowest_decay[member], state.periods[member]
    period = int(found[CHECK_PERIOD])
    if state.slowest_decay[member] == 0.0:  # else they were kept when the orbit was disturbed
        for q in range(3):
            fine[FINE_FORCES + q] = largest_force(state, member, period, q)
    contraction = coarse_contraction(found[CHECK_DECAY])
    orbits = orbits_until_checked(contraction)
    state.steps[member], state.finer_steps[member] = state.finer_steps[member], 0
    begin_member(state, member)
    state.return_at[member], state.next_check[member] = NEVER, orbits * period
    fine[FINE_PERIOD], fine[FINE_CONTRACTION], fine[FINE_ORBITS_BETWEEN] = period, contraction, orbits
    fine[FINE_EXTRAPOLATIONS], fine[FINE_GREW] = 0.0, 0.0


@internal
def coarse_contraction(decay):
    """Factor by which the coarse orbit's error is taken to shrink per orbit, from an observed decay."""
    return max(_LEAST_CONTRACTION, assumed_decay(decay))


@internal
def orbits_until_checked(contraction):
    """Orbits until a finer run is checked: then `COARSE_ERROR_LEFT` of the coarse orbit's error is left, at most."""
    return min(ORBITS, max(_FEWEST_ORBITS, ceil(log(COARSE_ERROR_LEFT) / log(contraction))))
