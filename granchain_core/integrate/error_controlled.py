"""The common part of methods with error control: steps in (u, w) from one grid point to the next."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from ..execution.stop import Stop
from ..kernels.compiling.entry import Entries, types_of
from ..kernels.equations.motion import Trajectory, evaluate_at_phase
from ..kernels.error_control.run import SampleRange, run_error_controlled
from ..kernels.error_control.step import DriveCycle
from ..kernels.forces.peaks import largest_forces, next_period
from ..kernels.samples import KernelIO, Samples, first_not_finite
from ..kernels.status import DONE
from .scaling import ScaledChain
from .stepper import CallStart, empty_samples

#: [step size] Error control: fewest steps per drive period, so that no step skips the driver's motion.
LEAST_STEPS_PER_PERIOD = 16
#: [step size] Error control: first step to try, in scaled time, if the drive period is long enough.
_INITIAL_STEP = 0.01
#: [step size] Error control: smallest scale of displacements and of w to which a tolerance is relative.
_LEAST_SCALE = 1e-3
# Kernels that are called once a period.
_EVALUATE_AT_PHASE = Entries(evaluate_at_phase)
RUN_ERROR_CONTROLLED = Entries(run_error_controlled)


def largest_step(scaled: ScaledChain) -> float:
    """Return the largest step of a method with error control, in scaled time."""
    return scaled.period / LEAST_STEPS_PER_PERIOD


def initial_step(scaled: ScaledChain) -> float:
    """Return the first step that such a method tries, in scaled time."""
    return min(_INITIAL_STEP, largest_step(scaled))


class ErrorControlledStepper(ABC):
    """Steps of a method in (u, w) with error control: a `Stepper` without its workspace and kernel.

    `method` is the slot that the kernel takes. Its workspace is as `kernels/error_control/step.py` describes it.
    """

    def __init__(self, method: Any, scaled: ScaledChain, samples: int) -> None:
        self.method = method
        self.scaled = scaled
        self.grid = samples
        self.pause: Callable[[], None] = Stop().pause
        self.work: Any = self.new_workspace()
        self.type_key = self.new_type_key()

    @abstractmethod
    def new_workspace(self) -> Any:
        """Return the workspace of the method's kernel, a named tuple."""

    def run_range(self, y: np.ndarray, first: int, points: int, stride: int, samples: Samples,
                  out: KernelIO) -> tuple[int, int]:
        """Call the kernel once over `points` grid points from `first` on; return status and rows filled.

        Every `stride`-th point is kept as a sample, and the largest forces are searched for; with `stride` = 0, neither
        is done.
        """
        wanted = SampleRange(first, points, self.grid, stride)
        status, rows = RUN_ERROR_CONTROLLED(self.type_key, self.method, self.trajectory(y), wanted, samples, out)
        return status, rows

    def new_type_key(self) -> Any:
        """Return a key for the types of slots, method and workspace, by which the kernels' specializations are found.

        The arrays of a call are not part of it: `Engine` makes all of them, C-ordered and of one type each.
        """
        return types_of((self.method, self.scaled.slots, self.work))

    @property
    def slope(self) -> np.ndarray:
        """The slope dy/dt at the present state."""
        return np.asarray(self.work.k[0])

    def use(self, scaled: ScaledChain) -> None:
        """Continue with other values in the same slots, or with other effects."""
        self.scaled = scaled
        self.work = self.work._replace(forces=scaled.forces())
        self.type_key = self.new_type_key()

    def prepare(self, y: np.ndarray) -> None:
        """Start from a new state: set the first step to try, and the scale on which errors are measured."""
        self.work.next_step[0] = initial_step(self.scaled)
        for i, values in enumerate(self.scaled.rows(y)):
            self.work.scale[i] = max(_LEAST_SCALE, float(np.abs(values).max()))

    def trajectory(self, y: np.ndarray) -> Trajectory:
        """Return the state y with everything that its kernels need."""
        scaled = self.scaled
        return Trajectory(scaled.slots, DriveCycle(scaled.beta, scaled.period), y, self.work)

    def evaluate_at_phase(self, theta: float, y: np.ndarray, from_velocity: bool) -> None:
        """Recompute the driver's state and dy/dt for y."""
        slots, work = self.scaled.slots, self.work
        _EVALUATE_AT_PHASE(self.type_key, slots, theta, y, work.k[0], work.forces, from_velocity)

    def samples(self, y: np.ndarray, first: int, samples: Samples, out: KernelIO) -> tuple[int, int]:
        """Advance from sample `first` and fill the samples; return status and number of rows filled."""
        return self.run_range(y, first, len(samples.displacement) - 1, 1, samples, out)

    def periods(self, y: np.ndarray, strobes: np.ndarray, maxima: np.ndarray, watch: bool,
                out: KernelIO) -> tuple[int, int]:
        """Advance by whole periods; fill strobes and, with `watch`, largest forces; return status and periods done."""
        keep, bodies = empty_samples(self.scaled, 2), self.scaled.bodies
        strobes[0] = y[:bodies], self.work.k[0, :bodies]
        for p in range(len(maxima)):
            next_period(out.log.peaks)
            status, _ = self.run_range(y, 0, self.grid, self.grid if watch else 0, keep, out)
            if status != DONE:
                return status, p
            strobes[p + 1] = y[:bodies], self.work.k[0, :bodies]
            self.pause()
            if watch:
                maxima[p] = largest_forces(out.log.peaks)
        return DONE, len(maxima)

    def step_at(self, grid_index: int) -> int | None:
        """Return None: steps have no number within their period."""
        return None

    def locate_failure(self, y: np.ndarray, start: CallStart | None, done: float,
                       stop: Stop) -> tuple[int, int | None]:
        """Find the bead stage by stage: within one stage, a failure only spreads to the adjacent beads."""
        bodies = self.scaled.bodies
        first = next((bead for bead in (first_not_finite(slope, bodies) for slope in self.work.k) if bead), 0)
        return first or first_not_finite(y, bodies), None
