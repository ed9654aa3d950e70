"""The n-period stroboscopic map, its derivative by finite differences, and its fixed points.

While a chain settles, claims near |μ| = 1 are tested with this map: its kernels are already compiled, and it allows cut
tension, with dop853 instead of fixed steps. `StroboscopicMap` (orbits/stroboscopic_map.py), whose derivative is the
tangent flow, is for orbits that the user requests. How far both agree is measured in docs/orbits.md ("Error of the map
with fixed steps").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import ComputationError
from ...execution.stop import Stop
from ...integrate import Engine, fixed_step_setting, following_setting
from ...scene import Scene
from ..residuals import ACCEPTED_FIXED_STEP_RESIDUAL, FIXED_STEP_RESIDUAL_GOAL, least_displacement, orbit_change
from ..returns import sizes

#: [no threshold] Number of steps that replace one default step.
_REFINEMENT = 4.0
#: [no threshold] Half the distance between the two states of a central difference, relative to the largest displacement
#: or w. The error is its square times the map's third derivative, plus the method's noise divided by it. The noise is
#: about 1e-10, in rare cases up to 5e-9: the map jumps where a contact event passes the end of a step.
_DIFFERENCE = 1e-5
#: [no threshold] Distance between the two states of a one-sided difference, relative to the largest displacement or w.
#: The error is of the order of this distance times the map's second derivative.
_ONE_SIDED_DIFFERENCE = 1e-6
#: [period n, followed] Maximum number of iterations of Newton's method.
_MOST_ITERATIONS = 10
#: [no threshold] The derivative is recomputed if an iteration leaves more than this fraction of the residual.
_RENEWAL_FRACTION = 0.1
#: [period n, followed] Maximum number of sizes tried for one Newton step, each half of the previous one.
_HALVINGS = 5


class FiniteDifferenceMap:
    """x → the state n drive periods later, for scaled x = (u, w) (2N,) at phase 0."""

    def __init__(self, scene: Scene, periods: int, stop: Stop | None = None, refine: float = _REFINEMENT) -> None:
        setting = following_setting(True) if scene.cuts_tension else fixed_step_setting(refine)
        self.engine = Engine(scene, setting, 1, stop=stop)
        self.periods = periods

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """The state n periods later."""
        self.engine.start_scaled(x)
        self.engine.periods(self.periods, watch=False)
        return self.inner(self.engine.y)

    def passed(self, x: np.ndarray, first: int, between: int) -> tuple[np.ndarray, np.ndarray]:
        """The first `first` iterates (first, 2N) from x on, and as many again after `between` more."""
        self.engine.start_scaled(x)
        early = self._next(first)
        self.engine.periods(self.periods * between, watch=False)
        return early, self._next(first)

    def _next(self, count: int) -> np.ndarray:
        states = []
        for _ in range(count):
            states.append(self.inner(self.engine.y))
            self.engine.periods(self.periods, watch=False)
        return np.array(states)

    def inner(self, y: np.ndarray) -> np.ndarray:
        """The beads' entries of a full state array."""
        return self.engine.scaled.beads_of(y)

    def relative(self, change: np.ndarray, x: np.ndarray) -> float:
        """A change of the state x (2N,), relative to the sizes of displacements and of w (steady/residuals.py)."""
        return orbit_change(change, x, self.engine.scaled.beta)

    def derivative(self, x: np.ndarray, central: bool = True) -> np.ndarray:
        """The derivative (2N, 2N) by differences; one-sided ones take half the time and are less accurate."""
        matrix, difference = np.zeros((len(x), len(x))), _DIFFERENCE if central else _ONE_SIDED_DIFFERENCE
        width = difference * sizes(x, least_displacement(x, self.engine.scaled.beta))
        middle = None if central else self(x)
        for i in range(len(x)):
            step = np.zeros(len(x))
            step[i] = width[i]
            if middle is None:
                matrix[:, i] = (self(x + step) - self(x - step)) / (2.0 * width[i])
            else:
                matrix[:, i] = (self(x + step) - middle) / width[i]
        return matrix


@dataclass(frozen=True, eq=False)
class FixedPoint:
    """A fixed point of the n-period map with the map's derivative there and the residual."""

    x: np.ndarray
    derivative: np.ndarray
    residual: float

    @property
    def modulus(self) -> float:
        """The largest |μ|."""
        return float(np.abs(np.linalg.eigvals(self.derivative)).max())


def fixed_point(stroboscopic_map: FiniteDifferenceMap, x: np.ndarray) -> FixedPoint | None:
    """Return the fixed point to which Newton's method converges from x, or None if it does not converge.

    The derivative is computed again only where the current one does not reduce the residual enough: by differences it
    costs 4N maps, by tangents (orbits/damped_newton.py) only as much as two.
    """
    try:
        return _newton(stroboscopic_map, x)
    except (ComputationError, np.linalg.LinAlgError):  # where a trial state cannot be integrated, or |μ| = 1
        return None


def _newton(stroboscopic_map: FiniteDifferenceMap, x: np.ndarray) -> FixedPoint | None:
    start, change, relative = x, stroboscopic_map(x) - x, stroboscopic_map.relative
    residual, matrix = relative(change, start), stroboscopic_map.derivative(x)
    matrix_is_current = True
    for _ in range(_MOST_ITERATIONS):
        if residual <= FIXED_STEP_RESIDUAL_GOAL:
            break
        step = np.linalg.solve(matrix - np.eye(len(x)), -change)
        for halving in range(_HALVINGS):
            trial = x + step / 2**halving
            after = stroboscopic_map(trial) - trial
            new_residual = relative(after, start)
            if new_residual < residual:
                break
        else:
            if matrix_is_current:
                break
            matrix, matrix_is_current = stroboscopic_map.derivative(x), True
            continue
        slow = new_residual > _RENEWAL_FRACTION * residual
        x, change, residual, matrix_is_current = trial, after, new_residual, False
        if slow and residual > FIXED_STEP_RESIDUAL_GOAL:
            matrix, matrix_is_current = stroboscopic_map.derivative(x), True
    if residual > ACCEPTED_FIXED_STEP_RESIDUAL:
        return None
    return FixedPoint(x, matrix if matrix_is_current else stroboscopic_map.derivative(x), residual)
