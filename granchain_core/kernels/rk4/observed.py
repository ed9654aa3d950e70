"""A chain pushed by a sampled force: fixed steps in w from sample to sample, split where a contact opens or closes.

Between two samples the force is one cubic, so that steps that end at the samples see a smooth right-hand side.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..equations.motion import Trajectory
from ..forces.largest import watch_state
from ..jit import kernel
from ..samples import first_not_finite, keep
from ..status import CANCELLED, DONE, NOT_FINITE, STEPS_BETWEEN_STOP_CHECKS
from .step import DriveTable, step


class SampledForce(NamedTuple):
    """A force between its samples: interval i lasts spans[i], is taken in substeps[i] steps, and has a cubic.

    `pieces` (I, 4) are the cubics' coefficients, constant term first.
    """

    spans: np.ndarray
    pieces: np.ndarray
    substeps: np.ndarray


@kernel
def run_observed(method, trajectory, force, samples, out):
    """Run through all intervals and keep the state at every sample, the first one included.

    The trajectory's drive table is empty, so that the force is evaluated at every stage; its step is that of each
    interval. Returns (status, rows filled).
    """
    slots, drive, y, stages = trajectory
    m = slots.chain.inverse_mass.size
    taken = 0
    watch_state(slots, y, stages.k[0], stages.forces.e, 0.0, out.log)
    keep(slots, 0, y, stages.k[0], stages.forces.e, samples)
    for i in range(force.spans.size):
        for q in range(4):
            slots.driver.piece[q] = force.pieces[i, q]
        h = force.spans[i] / force.substeps[i]
        here = Trajectory(slots, DriveTable(drive.values, h, h), y, stages)
        for j in range(force.substeps[i]):
            left = step(method, here, j, out)
            watch_state(slots, y, stages.k[0], stages.forces.e, left, out.log)
            taken += 1
            if taken % STEPS_BETWEEN_STOP_CHECKS == 0 and out.stop[0] != 0:
                return CANCELLED, i + 1
        if first_not_finite(y, m) != 0:
            return NOT_FINITE, i + 1
        keep(slots, i + 1, y, stages.k[0], stages.forces.e, samples)
    return DONE, force.spans.size + 1
