"""The interface of an integration method, as the engine uses it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from ..execution.stop import Stop
from ..kernels.equations.motion import Trajectory
from ..kernels.samples import KernelIO, Samples
from .scaling import ScaledChain

#: The start of a call: state and slope (M,), and the grid index.
CallStart = tuple[np.ndarray, np.ndarray, int]


class ErrorControl(Protocol):
    """The part of the workspace of a method with error control that a checkpoint saves.

    `next_step` (1,) is the next step to try; `scale` (2,) are the displacement and the w to which the tolerance is
    relative.
    """

    @property
    def next_step(self) -> np.ndarray:
        """The next step to try (1,), in scaled time."""

    @property
    def scale(self) -> np.ndarray:
        """Scales of displacements and of w (2,)."""


class Stepper(Protocol):
    """A method with its arrays. `grid` is the number of grid points per drive period; calls may end at these points.

    A method that divides long calls into parts calls `pause` between them. `method` is the slot, and `work` the
    workspace, that its kernels take; with error control, the workspace has the parts of `ErrorControl`.
    """

    scaled: ScaledChain
    grid: int
    pause: Callable[[], None]

    @property
    def method(self) -> Any:
        """The method's slot."""

    @property
    def work(self) -> Any:
        """The workspace of its kernels."""

    @property
    def slope(self) -> np.ndarray:
        """The slope dy/dt (M,) at the present state: a view, which a caller may write into."""

    def use(self, scaled: ScaledChain) -> None:
        """Continue with other values in the same slots, or with other effects."""

    def prepare(self, y: np.ndarray) -> None:
        """Start from a new state."""

    def trajectory(self, y: np.ndarray) -> Trajectory:
        """Return the state y with everything that the method's kernels need."""

    def evaluate_at_phase(self, theta: float, y: np.ndarray, from_velocity: bool) -> None:
        """Recompute the driver's state and dy/dt for y at drive phase `theta`."""

    def samples(self, y: np.ndarray, first: int, samples: Samples, out: KernelIO) -> tuple[int, int]:
        """Advance from grid index `first` and fill the samples; return status and number of rows filled."""

    def periods(self, y: np.ndarray, strobes: np.ndarray, maxima: np.ndarray, watch: bool,
                out: KernelIO) -> tuple[int, int]:
        """Advance by whole periods; fill strobes and, with `watch`, largest forces; return status and periods done."""

    def step_at(self, grid_index: int) -> int | None:
        """Return the number, in its period, of the step that begins at this index; None if steps are not counted."""

    def locate_failure(self, y: np.ndarray, start: CallStart | None, done: float,
                       stop: Stop) -> tuple[int, int | None]:
        """Return bead and step in which the numbers failed, after `done` periods of a call from `start`, if known.

        Raises `Cancelled`, since the call may be repeated.
        """


def empty_samples(scaled: ScaledChain, rows: int) -> Samples:
    """Return arrays for `rows` samples in scaled units."""
    n = scaled.beads
    energy = np.zeros((rows, 3)) if scaled.slots.account is not None else None
    return Samples(np.zeros((rows, n)), np.zeros((rows, n)), np.zeros((rows, n + 1)), energy)
