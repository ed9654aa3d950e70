"""The record of a run: samples, strobes, forces and cost counters; also the check for numbers that are not finite."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .compiling.dispatch import by_slot
from .compiling.jit import brief_kernel, internal
from .effects.energy_account import DRIVER_WORK, LOST_ENERGY, EnergyAccount, account_ends
from .equations.motion import contact_force, stored_energy
from .forces.largest import ForceLog


class Samples(NamedTuple):
    """Recorded motion in scaled units: displacement and velocity (T, N), force (T, N+1), energy (T, 3) or None.

    The energy columns are stored energy, work of the driver, energy lost.
    """

    displacement: np.ndarray
    velocity: np.ndarray
    force: np.ndarray
    energy: Any


class KernelIO(NamedTuple):
    """Arrays that a kernel writes besides its result, and its stop flag (1,); `counts` (4,) as in status.py."""

    log: ForceLog
    counts: np.ndarray
    stop: np.ndarray


@internal
def write_sample(slots, row, y, dy, e, samples):
    """Write one sample of state y, whose slope is dy and whose forces are in e."""
    n = samples.displacement.shape[1]
    for i in range(n):
        samples.displacement[row, i] = y[i + 1]
        samples.velocity[row, i] = dy[i + 1]
    for c in range(n + 1):
        samples.force[row, c] = contact_force(slots, y, dy, e, c)
    write_account(slots.account, slots, row, y, dy, samples)


@by_slot
def write_account(account, slots, row, y, dy, samples):
    """Write stored energy, work and loss of one sample. Effect absent: nothing, since there is no array for them."""


@write_account.of(EnergyAccount)
def _(account, slots, row, y, dy, samples):
    samples.energy[row, 0] = stored_energy(slots, y, dy)
    work, lost = account_ends(slots, y, dy)
    samples.energy[row, 1] = y[DRIVER_WORK] + work
    samples.energy[row, 2] = y[LOST_ENERGY] + lost


@brief_kernel
def first_not_finite(y, bodies):
    """Return the number of the first bead whose displacement or w is not finite, or 0."""
    for i in range(1, bodies - 1):
        if not (np.isfinite(y[i]) and np.isfinite(y[bodies + i])):
            return i
    return 0


@internal
def write_strobe(y, dy, strobe):
    """Write the beads' displacements and velocities at one instant; those of driver and wall stay zero."""
    for i in range(1, strobe.shape[1] - 1):
        strobe[0, i] = y[i]
        strobe[1, i] = dy[i]
