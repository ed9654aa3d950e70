"""SciPy's solvers on the same compiled equations, as a user would otherwise have had them: w-variables, scaled."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from ..integrate.engine import Counts, rest
from ..integrate.lane_block import scaled_state
from ..kernels.dop853 import evaluate
from ..lower import lower
from ..scene import Scene

SOLVERS = ("LSODA", "RK45", "DOP853")


def solve(scene: Scene, solver: str, tolerance: float, periods: int, samples: int) -> tuple[np.ndarray, Counts]:
    """Scaled displacements (rows, N) from rest at `samples` a period, both ends; atol = rtol = tolerance.

    Solved period by period, so that the drive phase stays exact. Rows after a failure are NaN.
    """
    lowered, counts = lower(scene), Counts()
    forces, row = lowered.forces(), lowered.row
    y, whole = scaled_state(lowered, rest(scene)), np.zeros(lowered.size)

    def slope(t: float, inner: np.ndarray) -> np.ndarray:
        dy = np.zeros(lowered.size)
        whole[1 : row - 1], whole[row + 1 : 2 * row - 1] = inner[: row - 2], inner[row - 2 :]
        evaluate(lowered.slots, lowered.beta, t, whole, dy, forces)
        return np.concatenate([dy[1 : row - 1], dy[row + 1 : 2 * row - 1]])

    inner = np.concatenate([y[1 : row - 1], y[row + 1 : 2 * row - 1]])
    out = np.full((periods * samples + 1, scene.N), np.nan)
    out[0] = inner[: row - 2]
    times = lowered.period * np.arange(samples + 1) / samples
    for p in range(periods):
        found = solve_ivp(slope, (0.0, lowered.period), inner, solver, times, rtol=max(tolerance, 3e-14),
                          atol=tolerance, max_step=lowered.period / 16)
        counts.array[1] += found.nfev
        if not found.success or found.y.shape[1] != samples + 1:
            break
        out[p * samples + 1 : (p + 1) * samples + 1] = found.y[: row - 2, 1:].T
        inner = found.y[:, -1]
    return out, counts
