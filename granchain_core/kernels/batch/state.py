"""What a batch knows of its L members (BATCH_SIZE), one in each SIMD lane: arrays with an axis of L.

The state of a chain with N beads are the displacements of driver, beads and wall, then w of the same: 2(N + 2) numbers.
An axis of length 2 holds the displacements, then w. R is STROBES_KEPT (record.py): there is room for 2R strobes, of
which the older half is dropped when all places are taken.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

#: `Pairs.neighbour` of a member without a neighbouring trajectory, and of one that is a neighbouring trajectory itself.
NO_NEIGHBOUR, IS_NEIGHBOUR = -1, -2


class Members(NamedTuple):
    """Values of the members' scenes.

    `wall` (1, L) is the wall's stiffness; the effects' `slots` hold arrays (1, L) or (rows, L), or are None. `beta`
    (1, L) is the scaled drive rate. `unequal` holds masses and stiffnesses (unequal.py), or is None.
    """

    wall: np.ndarray
    unequal: Any
    slots: Any
    beta: np.ndarray


class Motion(NamedTuple):
    """What a step reads and changes (step.py, contact_correction.py).

    Written by the steps, by begin.py and record.py where a member begins or is moved, and by `Batch.put`.

    y (2(N+2), L)            state
    h (1, L)                 step
    phase (2, L)             sine and cosine of the drive phase
    half_step (2, L)         sine and cosine of the drive phase that half a step takes
    overlaps (N+1, L)        overlaps of the contacts after the last step, corrected
    static_overlap (N+1, L)  overlaps of the contacts at rest, 0 without preload
    end_contacts (4, L)      one step ago: overlap and rate of the first contact, overlap and rate of the last
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
    drive_period  scaled period of the drive
    steps         steps in a period
    steps_left    how many of them are left in this period
    fine_steps    steps in a period of the fine run that follows once an orbit is found; 0 for no fine run
    next_check    next period at which the strobes are checked
    return_at     period at which the member is due at the latest
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
    """What is kept of each member's periods.

    Written by record.py and period_end.py.

    periods (L,)             periods run
    strobes (L, 2R, 2, N+2)  states at the ends of periods
    strobe_count (L,)        strobes kept
    first_strobe (2, L)      row of the first strobe since the member was last moved to another state, and of the first
                             since the time before that
    maxima (L, R, MAXIMA)    of the last R periods, a ring: three largest forces (input, output, elastic output), then
                             of the input and output force the largest jumps and the largest unresolved peaks
    """

    periods: np.ndarray
    strobes: np.ndarray
    strobe_count: np.ndarray
    first_strobe: np.ndarray
    maxima: np.ndarray


class Search(NamedTuple):
    """How far the search for each member's orbit has come.

    Written by checks.py and begin.py; `fine_record` also by `Batch.put` and `Batch.put_fine`.

    extrapolate_from (L,)    period from which a transient may be extrapolated
    wait_after_undo (L,)     periods without extrapolation after the next one that is undone
    slowest_contraction (L,)  contraction factor per drive period of the slowest transient that an extrapolation ended,
                             0 without one; above 0 an orbit that is found must survive a perturbation
    contraction_before (L,)  the same before the last extrapolation, which may be undone
    change_before (L,)       change per orbit before an extrapolation that is not confirmed yet, else 0
    tested_period (L,)       period of an orbit that is being perturbed, else 0
    state_before (L, 2, N+2)  state before the last extrapolation or perturbation
    last_check (L, CHECK_COLUMNS)  result of the last check (begin.py)
    coarse_orbit (L, ORBIT_COLUMNS)  what the coarse run found (begin.py)
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
    """Members whose neighbouring trajectory, in another lane, measures an exponent (steady/lyapunov.py).

    Written by `Batch.put_pair`; growth by `bring_back` (run.py).

    neighbour (L,)  lane of the member's neighbouring trajectory; NO_NEIGHBOUR, or IS_NEIGHBOUR
    distance (L,)   distance to which the neighbour is brought back after each period
    growth (L, R)   logarithm of the factor by which that distance has grown in each period; NaN if a state of the pair
                    is not finite
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
    """All of a batch but the values of its scenes."""

    motion: Motion
    schedule: Schedule
    record: Record
    search: Search
    pairs: Pairs
    work: Work
