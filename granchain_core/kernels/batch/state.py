"""The data of a batch of L members (L = BATCH_SIZE), one per SIMD lane: arrays with an axis of length L.

The state of a chain with N beads consists of the displacements of driver, beads and wall, then their w: 2(N + 2)
numbers. An axis of length 2 has the displacements, then w. R is STROBES_KEPT (record.py): there is room for 2R strobes,
of which the older half is dropped when the record is full.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

#: `Pairs.neighbour` of a member without a neighbouring trajectory, and of one that is itself a neighbouring trajectory.
NO_NEIGHBOUR, IS_NEIGHBOUR = -1, -2


class Members(NamedTuple):
    """Values of the members' scenes.

    `wall` (1, L) is the wall's stiffness; the effects' `slots` contain arrays (1, L) or (rows, L), or are None. `beta`
    (1, L) is the scaled drive frequency. `unequal` contains masses and stiffnesses (unequal.py), or is None.
    """

    wall: np.ndarray
    unequal: Any
    slots: Any
    beta: np.ndarray


class Motion(NamedTuple):
    """The data that a step reads and changes (step.py, contact_correction.py).

    Written by the steps, by begin.py and record.py when a member begins or is moved, and by `Batch.put`.

    y (2(N+2), L)            state
    h (1, L)                 step size
    phase (2, L)             sine and cosine of the drive phase
    half_step (2, L)         sine and cosine of the drive phase's increase in half a step
    overlaps (N+1, L)        corrected overlaps of the contacts after the last step
    static_overlap (N+1, L)  overlaps of the contacts at rest, 0 without preload
    end_contacts (4, L)      one step ago: overlap and rate of the first contact, then of the last
    peaks (BATCH_PEAKS, L)   largest forces, jumps and unresolved peaks of the period so far, and the last four values
                             of each force (forces/peaks.py)
    stages                   workspace: three states, (2(N+2), L) each
    """

    y: np.ndarray
    h: np.ndarray
    phase: np.ndarray
    half_step: np.ndarray
    overlaps: np.ndarray
    static_overlap: np.ndarray
    end_contacts: np.ndarray
    peaks: np.ndarray
    stages: tuple[np.ndarray, np.ndarray, np.ndarray]


class Schedule(NamedTuple):
    """When each member begins, is checked, and is returned to the caller; arrays (L,).

    Written by `Batch.put`, begin.py, checks.py, run.py and period_end.py.

    begins        1 for a new member, which begins at the kernel's next call (begin.py)
    drive_period  scaled drive period
    steps         steps per period
    steps_left    number of steps left in this period
    fine_steps    steps per period of the fine run that follows once an orbit is found; 0 for no fine run
    next_check    next period at which the strobes are checked
    return_at     period at which the member becomes due at the latest
    due           1 for a member that is to be returned to the caller
    """

    begins: np.ndarray
    drive_period: np.ndarray
    steps: np.ndarray
    steps_left: np.ndarray
    fine_steps: np.ndarray
    next_check: np.ndarray
    return_at: np.ndarray
    due: np.ndarray


class Record(NamedTuple):
    """The record of each member's periods.

    Written by record.py and period_end.py.

    periods (L,)             number of periods run
    strobes (L, 2R, 2, N+2)  states at the ends of periods
    strobe_count (L,)        number of strobes kept
    first_strobe (2, L)      row of the first strobe since the member's last move to another state, and since the move
                             before that
    maxima (L, R, MAXIMA)    ring buffer of the last R periods: three largest forces (input, output, elastic output),
                             then the largest jumps and the largest unresolved peaks of input and output force
    """

    periods: np.ndarray
    strobes: np.ndarray
    strobe_count: np.ndarray
    first_strobe: np.ndarray
    maxima: np.ndarray


class Search(NamedTuple):
    """The progress of the search for each member's orbit.

    Written by checks.py and begin.py; `fine_record` also by `Batch.put` and `Batch.put_fine`.

    extrapolate_from (L,)    period from which a transient may be extrapolated
    wait_after_undo (L,)     periods without extrapolation after the next one that is undone
    slowest_contraction (L,)  contraction factor per drive period of the slowest transient that an extrapolation ended,
                              0 without one; if above 0, an orbit that is found must survive a perturbation
    contraction_before (L,)  the same before the last extrapolation, which may be undone
    change_before (L,)       change per orbit before an extrapolation that is not yet confirmed, otherwise 0
    tested_period (L,)       period of an orbit whose perturbation is being tested, otherwise 0
    state_before (L, 2, N+2)  state before the last extrapolation or perturbation
    last_check (L, CHECK_COLUMNS)  result of the last check (begin.py)
    coarse_orbit (L, ORBIT_COLUMNS)  results of the coarse run (begin.py)
    fine_record (L, FINE_COLUMNS)  record of a fine run (begin.py); its period is 0 in a coarse one
    """

    extrapolate_from: np.ndarray
    wait_after_undo: np.ndarray
    slowest_contraction: np.ndarray
    contraction_before: np.ndarray
    change_before: np.ndarray
    tested_period: np.ndarray
    state_before: np.ndarray
    last_check: np.ndarray
    coarse_orbit: np.ndarray
    fine_record: np.ndarray


class Pairs(NamedTuple):
    """Members with a neighbouring trajectory in another lane, for measuring an exponent (steady/lyapunov.py).

    Written by `Batch.put_pair`; `growth` by `bring_back` (run.py).

    neighbour (L,)  lane of the member's neighbouring trajectory; NO_NEIGHBOUR, or IS_NEIGHBOUR
    distance (L,)   distance to which the neighbour is brought back after each period
    growth (L, R)   logarithm of the factor by which that distance grew in each period; NaN if a state of the pair is
                    not finite
    """

    neighbour: np.ndarray
    distance: np.ndarray
    growth: np.ndarray


class Work(NamedTuple):
    """Workspaces of checks.py, with ORBITS of strobes/extrapolation.py.

    scale (2,), change (3·LONGEST_PERIOD or more,), limit (2, N+2), basis (ORBITS, 2(N+2)), triangle (ORBITS, ORBITS).
    """

    scale: np.ndarray
    change: np.ndarray
    limit: np.ndarray
    basis: np.ndarray
    triangle: np.ndarray


class BatchState(NamedTuple):
    """The whole state of a batch, without the values of its scenes."""

    motion: Motion
    schedule: Schedule
    record: Record
    search: Search
    pairs: Pairs
    work: Work
