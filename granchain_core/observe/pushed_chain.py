"""A scaled chain with a force or motion given by samples, ready for the kernel that steps from sample to sample.

It is pushed by a measured force, model (3) of Zhang et al. 2016, or by a driver with a given motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import BadInput, Cancelled, NumbersFailed
from ..integrate import Counts, State
from ..integrate.stepper import empty_samples
from ..kernels.contact_cubic import ENDS
from ..kernels.effects.driver import Moved
from ..kernels.effects.given_force import Sampled
from ..kernels.equations.motion import Trajectory, place
from ..kernels.forces.largest import new_log
from ..kernels.forces.peaks import largest_forces, largest_jumps, reset_peaks
from ..kernels.rk4.piecewise import DrivePieces, run_pieces
from ..kernels.rk4.step import DriveTable, Rk4Split, Rk4Workspace
from ..kernels.samples import Output, Samples, first_not_finite
from ..kernels.status import CANCELLED, NOT_FINITE
from ..scaling import ScaledChain, scale_chain
from ..scene import Scene
from ..stop import Stop
from .record import ForceRecord
from .signal import Signal

#: More steps than this are refused: minutes of computing.
MOST_STEPS = 200_000_000


class ChainInPieces:
    """A scaled chain whose driver has one polynomial (T − 1, k) between two times [s]; `counts` adds up over its runs.

    `pieces` are scaled, constant term first. `overlap` is the expected size of overlaps in scaled units: the default
    step of the fixed-step method is for 1, and larger overlaps make contacts stiffer.
    """

    def __init__(self, scaled: ScaledChain, time: np.ndarray, pieces: np.ndarray, overlap: float, stop: Stop,
                 counts: Counts | None = None) -> None:
        self.scaled = scaled
        self.counts = Counts() if counts is None else counts
        self._time = time
        self._stop = stop
        self._log = new_log()
        self._spans = np.diff(time) * scaled.scales.rate
        self._pieces = pieces
        self._substeps = np.ceil(self._spans * max(1.0, overlap) ** 0.25 / scaled.step).astype(np.int64)

    @property
    def maxima(self) -> np.ndarray:
        """Largest input, output and elastic output force of the last run, in scaled units."""
        return largest_forces(self._log.peaks).copy()

    @property
    def jumps(self) -> np.ndarray:
        """The largest jumps of input and output force (2,) in the same time, in scaled units."""
        return largest_jumps(self._log.peaks).copy()

    def steps(self, halvings: int) -> int:
        """Steps of a run whose steps are halved `halvings` times."""
        return int(self._substeps.sum()) * 2**halvings

    def longest_step(self, halvings: int) -> float:
        """The longest of them, in scaled units."""
        return float((self._spans / self._substeps).max()) / 2**halvings

    def run(self, start: State, halvings: int) -> Samples:
        """The motion from `start` with steps halved `halvings` times; one row per sample, in scaled units."""
        scaled, n, row = self.scaled, self.scaled.beads, self.scaled.bodies
        if len(start.displacement) != n:
            raise BadInput(f"The start has {len(start.displacement)} beads; the chain has {n}.")
        if self.steps(halvings) > MOST_STEPS:
            raise BadInput(f"The record needs {self.steps(halvings):.1e} steps; at most {MOST_STEPS:.0e} are allowed: "
                           "give a shorter record or ask for less accuracy.")
        y = np.zeros(scaled.size)
        displacement, velocity = scaled.rows(y)
        displacement[:] = start.displacement / scaled.scales.length
        velocity[:] = start.velocity / scaled.scales.velocity
        workspace = Rk4Workspace(np.zeros((4, scaled.size)), np.zeros(scaled.size), np.zeros(scaled.size),
                                 np.zeros((ENDS, row - 1)), scaled.forces(), None)
        scaled.slots.driver.piece[:] = self._pieces[0]
        place(scaled.slots, 0.0, y, workspace.k[0], workspace.forces, True)
        reset_peaks(self._log.peaks)
        samples = empty_samples(scaled, len(self._spans) + 1)
        nothing = DriveTable(np.zeros((0, 2)), 0.0, 0.0)
        status, done = run_pieces(Rk4Split(0), Trajectory(scaled.slots, nothing, y, workspace),
                                  DrivePieces(self._spans, self._pieces, self._substeps * 2**halvings), samples,
                                  Output(self._log, self.counts.array, self._stop.flag))
        if status == CANCELLED:
            raise Cancelled
        if status == NOT_FINITE:
            bead = max(1, first_not_finite(y, row))
            raise NumbersFailed(f"The motion of bead {bead} stopped being a finite number at about "
                                f"{self._time[done - 1]:.6g} s; look at the force there, or lower the damping.",
                                "not-finite")
        return samples


class PushedChain(ChainInPieces):
    """A scene's chain without its driver, pushed by a record's force."""

    def __init__(self, scene: Scene, record: ForceRecord, stop: Stop, counts: Counts | None = None) -> None:
        driven = scale_chain(scene)
        scales = driven.scales
        scaled = replace(driven, slots=driven.slots._replace(driver=Sampled(np.zeros(4))))
        pieces = record.cubics() / scales.force / scales.rate ** np.arange(4)
        overlap = (float(np.abs(record.force).max()) / scales.force) ** (2.0 / 3.0)
        super().__init__(scaled, record.time, pieces, overlap, stop, counts)


class MovedChain(ChainInPieces):
    """A scene's chain whose driver moves as a signal says, with the energy account."""

    def __init__(self, scene: Scene, signal: Signal, stop: Stop) -> None:
        driven = scale_chain(scene, balance=True)
        scaled = replace(driven, slots=driven.slots._replace(driver=Moved(np.zeros(3))))
        pieces = signal.quadratics() / driven.scales.length / driven.scales.rate ** np.arange(3)
        overlap = float(np.ptp(signal.displacement)) / driven.scales.length
        super().__init__(scaled, signal.time, pieces, overlap, stop)
