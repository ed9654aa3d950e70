"""The n-period stroboscopic map with its derivative, by the certified method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..integrate import Engine, Setting
from ..kernels.dop853_tableau import STAGES
from ..kernels.tangent import Tangent, run_tangent
from ..scene import Scene

#: Tolerance of one step: the map is then smooth to about 1e-12, and Newton's method ends there.
TOLERANCE = 1e-14


@dataclass(frozen=True, eq=False)
class Flow:
    """Where n periods lead: end (2N,) of displacements then w in scaled units, derivative (2N, 2N), log determinant.

    `log_determinant` is ∫ trace along the way, to be compared with the derivative's own (Liouville).
    """

    end: np.ndarray
    derivative: np.ndarray
    log_determinant: float


class StroboscopicMap:
    """x → the state n drive periods later, for scaled x = (u, w) at phase 0."""

    def __init__(self, scene: Scene, periods: int, stop: np.ndarray | None = None) -> None:
        self.engine = Engine(scene, Setting("dop853", tolerance=TOLERANCE), 1, stop=stop)
        self.periods = periods

    def inner(self, y: np.ndarray) -> np.ndarray:
        """The beads' part of a whole state array."""
        row = self.engine.lowered.row
        return np.concatenate([y[1 : row - 1], y[row + 1 : 2 * row - 1]])

    def __call__(self, x: np.ndarray, observer: bool = False) -> Flow:
        """The flow from x; with `observer` the tangents are those of a chain pushed by the recorded input force."""
        engine, row = self.engine, self.engine.lowered.row
        n = row - 2
        engine.start_scaled(x)
        contacts = row - 1
        tangent = Tangent(np.eye(2 * n), np.zeros((STAGES, 2 * n, 2 * n)), np.zeros((2 * n, 2 * n)),
                          np.zeros(contacts), np.zeros(contacts))
        lo = engine.lowered
        status, done, trace = run_tangent(engine.method, lo.slots, lo.beta, lo.period, self.periods, engine.y,
                                          engine.work, engine.clock, tangent, 1 if observer else 0,
                                          engine.counts.array, engine.stop)
        engine.raise_for(status, done)
        return Flow(self.inner(engine.y), tangent.matrix, trace)
