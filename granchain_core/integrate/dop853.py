"""Stepping with error control by DOP853: contact events are located, and steps end at them."""

from __future__ import annotations

import numpy as np

from ..kernels.dop853.step import ALL_STAGES, Dop853, Dop853Workspace
from .error_controlled import ErrorControlledStepper, initial_step, largest_step
from .scaling import ScaledChain


def dop853_workspace(scaled: ScaledChain) -> Dop853Workspace:
    """Return the workspace of DOP853, with its slopes and dense output."""
    size = scaled.size
    return Dop853Workspace(
        k=np.zeros((ALL_STAGES, size)), stage=np.zeros(size), end=np.zeros(size), probe=np.zeros(size),
        slope=np.zeros(size), dense=np.zeros((7, size)), scale=np.zeros(2), next_step=np.array([initial_step(scaled)]),
        forces=scaled.forces())


class Dop853Stepper(ErrorControlledStepper):
    """DOP853 in (u, w) at a relative tolerance per step."""

    def __init__(self, tolerance: float, scaled: ScaledChain, samples: int) -> None:
        super().__init__(Dop853(tolerance, largest_step(scaled)), scaled, samples)

    def new_workspace(self) -> Dop853Workspace:
        """Return the workspace of DOP853."""
        return dop853_workspace(self.scaled)
