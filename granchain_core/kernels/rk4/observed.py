"""A chain pushed by a sampled force, or by a driver with a given motion, from sample to sample.

Fixed steps in w, split where a contact opens or closes. Between two samples the force is one cubic, or the driver's
displacement one quadratic, so that steps that end at the samples see a smooth right-hand side.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..effects.driver import Moved, driver_displacement, driver_velocity
from ..effects.given_force import Sampled
from ..equations.motion import Trajectory, motion
from ..forces.largest import watch_state
from ..jit import by_slot, kernel
from ..samples import first_not_finite, keep
from ..status import CANCELLED, DONE, NOT_FINITE, STEPS_BETWEEN_STOP_CHECKS
from .step import DriveTable, step


class SampledForce(NamedTuple):
    """A force or a motion between its samples: interval i lasts spans[i] and is taken in substeps[i] steps.

    `pieces` (I, 4) are the coefficients of the force's cubics, (I, 3) those of the displacement's quadratics, constant
    term first.
    """

    spans: np.ndarray
    pieces: np.ndarray
    substeps: np.ndarray


@by_slot
def begin_piece(driver, slots, y, stages):
    """Take the slope anew where the driver's acceleration jumps, which the account needs. Absent: nothing jumps."""


@begin_piece.of(Sampled)
def _(driver, slots, y, stages):
    pass


@begin_piece.of(Moved)
def _(driver, slots, y, stages):
    motion(slots, driver_displacement(driver, 0.0), driver_velocity(driver, 0.0), y, stages.k[0], stages.forces)


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
        for q in range(force.pieces.shape[1]):
            slots.driver.piece[q] = force.pieces[i, q]
        begin_piece(slots.driver, slots, y, stages)
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
