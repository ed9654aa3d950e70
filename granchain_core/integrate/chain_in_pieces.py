"""A scaled chain with a given force, or a given motion of its driver, in pieces: one polynomial between two samples.

A measured force acts on the chain (observers/force_driven_chain.py), or its driver follows a signal
(prescribed_drive/moved_chain.py).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..errors import BadInput, Cancelled, ComputationError
from ..execution.stop import Stop
from ..kernels.equations.motion import Trajectory, evaluate_at_phase
from ..kernels.forces.largest import new_log
from ..kernels.forces.peaks import largest_forces, largest_jumps, reset_peaks
from ..kernels.rk4.piecewise import DrivePieces, run_pieces
from ..kernels.rk4.step import DriveTable, Rk4Split, Rk4Workspace
from ..kernels.samples import KernelIO, Samples, first_not_finite
from ..kernels.status import CANCELLED, NOT_FINITE
from ..kernels.step_ends import END_ROWS
from ..scene.hertz import RATE_POWER
from ..scene.state import State
from .counts import Counts
from .failure import not_finite
from .methods import fixed_step_setting
from .scaling import ScaledChain
from .stated import StatedErrors, force_differences, least_errors, relative_difference
from .stepper import empty_samples

#: Records with more steps than this are refused: they would take minutes.
MOST_RECORD_STEPS = 200_000_000
#: Most halvings of the steps: beyond this, rounding and the error of the events dominate.
MOST_HALVINGS = 7


class ChainInPieces:
    """A scaled chain with a drive of one polynomial (T − 1, k) between two times [s]; `counts` adds up over its runs.

    `pieces` are scaled, constant term first. `overlap` is the expected size of overlaps in scaled units: the default
    step of the fixed-step method is meant for 1, and larger overlaps make contacts stiffer.
    """

    def __init__(self, scaled: ScaledChain, time: np.ndarray, pieces: np.ndarray, overlap: float, stop: Stop,
                 counts: Counts | None = None) -> None:
        self.scaled = scaled
        self.counts = Counts() if counts is None else counts
        self._time = time
        self._stop = stop
        self._log = new_log()
        self._spans = np.diff(time) * scaled.scales.phi
        self._pieces = pieces
        self._substeps = np.ceil(self._spans * max(1.0, overlap) ** RATE_POWER / scaled.step).astype(np.int64)

    @property
    def maxima(self) -> np.ndarray:
        """Largest input, output and elastic output force of the last run, in scaled units."""
        return largest_forces(self._log.peaks).copy()

    @property
    def jumps(self) -> np.ndarray:
        """The largest jumps of input and output force (2,) in the last run, in scaled units."""
        return largest_jumps(self._log.peaks).copy()

    def steps(self, halvings: int) -> int:
        """Return the number of steps of a run whose steps are halved `halvings` times."""
        return int(self._substeps.sum()) * 2**halvings

    def longest_step(self, halvings: int) -> float:
        """Return the longest of these steps, in scaled units."""
        return float((self._spans / self._substeps).max()) / 2**halvings

    def run(self, start: State, halvings: int) -> Samples:
        """Compute the motion from `start` with steps halved `halvings` times: one row per sample, in scaled units."""
        scaled, row = self.scaled, self.scaled.bodies
        if self.steps(halvings) > MOST_RECORD_STEPS:
            raise BadInput(f"The record needs {self.steps(halvings):.1e} steps; at most {MOST_RECORD_STEPS:.0e} are "
                           "allowed: give a shorter record or ask for less accuracy.")
        y = np.zeros(scaled.size)
        displacement, velocity = scaled.rows(y)
        displacement[:] = scaled.scales.scaled_displacements(start.displacement)
        velocity[:] = scaled.scales.scaled_velocities(start.velocity)
        workspace = Rk4Workspace(np.zeros((4, scaled.size)), np.zeros(scaled.size), np.zeros(scaled.size),
                                 np.zeros((END_ROWS, row - 1)), scaled.forces(), None)
        scaled.slots.driver.piece[:] = self._pieces[0]
        evaluate_at_phase(scaled.slots, 0.0, y, workspace.k[0], workspace.forces, True)
        reset_peaks(self._log.peaks)
        samples = empty_samples(scaled, len(self._spans) + 1)
        nothing = DriveTable(np.zeros((0, 2)), 0.0, 0.0)
        status, done = run_pieces(Rk4Split(0), Trajectory(scaled.slots, nothing, y, workspace),
                                  DrivePieces(self._spans, self._pieces, self._substeps * 2**halvings), samples,
                                  KernelIO(self._log, self.counts.array, self._stop.flag))
        if status == CANCELLED:
            raise Cancelled
        if status == NOT_FINITE:
            bead = first_not_finite(y, row)
            raise ComputationError(not_finite(f"at about {self._time[done - 1]:.6g} s", bead,
                                              "look at the force there, or lower the damping"),
                                   "not-finite", bead or None)
        return samples


class Refined(NamedTuple):
    """The run with the finest steps: samples, largest forces, number of halvings of its steps, growth of errors.

    `errors` (4,) are the stated relative errors due to the steps: of displacements, then of the largest forces.
    """

    samples: Samples
    maxima: np.ndarray
    halvings: int
    errors: np.ndarray
    growth: float


def refined(chain: ChainInPieces, start: State, tell: Callable[[int], None]) -> Refined:
    """Run with steps halved until the error is as small as the scene requires, or finer steps would not help.

    `tell` is called with the number of halvings after each run.
    """
    scene, computations = chain.scaled.scene, StatedErrors(chain.scaled.scene.cuts_tension)
    computations.begin(fixed_step_setting())
    before, maxima_before = chain.run(start, 0), chain.maxima
    for halvings in range(1, MOST_HALVINGS + 1):
        setting = fixed_step_setting(2**halvings)
        now, maxima = chain.run(start, halvings), chain.maxima
        differences = [relative_difference(now.displacement, before.displacement),
                       *force_differences(maxima, maxima_before, scene.forces_jump)]
        typical = least_errors(setting, chain.scaled, chain.longest_step(halvings), chain.jumps, maxima)
        computations.add(setting, chain.steps(halvings), np.array(differences), typical)
        tell(halvings)
        done = bool(computations.stated[0] <= scene.accuracy)
        if done or computations.rounded:
            break
        before, maxima_before = now, maxima
    return Refined(now, maxima, halvings, computations.final(done), computations.growth)
