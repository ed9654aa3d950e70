"""A chain driven piece by piece: by a sampled force on bead 1, or by a driver with a given motion.

Fixed steps in w are split where a contact opens or closes. Between two samples, the force is one cubic, or the driver's
displacement one quadratic. Steps end at the samples, so that the right-hand side is smooth within each step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..compiling.jit import kernel
from ..effects.driver import PrescribedMotion, driver_displacement, driver_velocity
from ..effects.given_force import Sampled
from ..equations.motion import Trajectory, motion
from ..forces.largest import update_forces
from ..samples import first_not_finite, write_sample
from ..status import CANCELLED, DONE, NOT_FINITE, WORK_BETWEEN_STOP_CHECKS
from .step import DriveTable, step


class DrivePieces(NamedTuple):
    """A force or a motion between its samples: piece i has the duration spans[i] and is computed in substeps[i] steps.

    `coefficients` are those of the force's cubics (I, 4), or of the displacement's quadratics (I, 3), constant term
    first.
    """

    spans: np.ndarray
    coefficients: np.ndarray
    substeps: np.ndarray


@by_slot
def begin_piece(driver, slots, y, workspace):
    """Re-evaluate the slope where the driver's acceleration jumps, for the energy account.

    Effect absent: nothing, since nothing jumps.
    """


@begin_piece.of(Sampled)
def _(driver, slots, y, workspace):
    pass


@begin_piece.of(PrescribedMotion)
def _(driver, slots, y, workspace):
    motion(slots, driver_displacement(driver, 0.0), driver_velocity(driver, 0.0), y, workspace.k[0], workspace.forces)


@kernel
def run_pieces(method, trajectory, pieces, samples, out):
    """Run through all pieces and keep the state at every sample, the first one included.

    The trajectory's drive table is empty, so the force is evaluated at every stage; its step is set for each piece.
    Returns (status, rows filled).
    """
    slots, drive, y, workspace = trajectory
    bodies = slots.chain.inverse_mass.size
    work = 0
    update_forces(slots, y, workspace.k[0], workspace.forces.e, 0.0, out.log)
    write_sample(slots, 0, y, workspace.k[0], workspace.forces.e, samples)
    for i in range(pieces.spans.size):
        for q in range(pieces.coefficients.shape[1]):
            slots.driver.piece[q] = pieces.coefficients[i, q]
        begin_piece(slots.driver, slots, y, workspace)
        h = pieces.spans[i] / pieces.substeps[i]
        here = Trajectory(slots, DriveTable(drive.values, h, h), y, workspace)
        for j in range(pieces.substeps[i]):
            since = step(method, here, j, out)
            update_forces(slots, y, workspace.k[0], workspace.forces.e, since, out.log)
            work += bodies
            if work >= WORK_BETWEEN_STOP_CHECKS:
                work = 0
                if out.stop[0] != 0:
                    return CANCELLED, i + 1
        if first_not_finite(y, bodies) != 0:
            return NOT_FINITE, i + 1
        write_sample(slots, i + 1, y, workspace.k[0], workspace.forces.e, samples)
    return DONE, pieces.spans.size + 1
