"""The equations of continuation, P(x; p) − x = 0 and a condition on the step, solved by Newton's method.

Jacobian   [[(P_x − 1)√(2N), P_p], [nᵀ]] in z = (x/√(2N), p): P_x is the exact derivative of the stroboscopic map, P_p
           a difference of the map in the knob. n is the normal of the plane in which z is sought: the bordered matrix
           stays regular at folds (Keller 1977).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import NumbersFailed
from ...steady.returns import least_period, relative_change
from ...stop import Stop
from ..flow import BACK, TOLERANCE, Flow, StroboscopicMap
from .axis import KnobAxis

#: Relative residual at which Newton's method stops.
GOOD = 1e-11
#: Largest residual that is accepted where rounding does not let it fall that far.
ACCEPTED = 1e-10
#: Newton's iterations at most.
_MOST = 8
#: Each Newton step that began above this residual is followed by one that reuses its derivative.
_LAST = 1e-6
#: Such a step is taken if the residual is below this.
_NEAR = 1e-4
#: Tolerance of the first map, from which a Newton step begins that is not the last: half the work of the final one.
_ROUGH = 1e-10
#: Difference in p: between the curvature of the map and its rounding (1e-13).
_DIFFERENCE = 1e-6


@dataclass(frozen=True, eq=False)
class Solved:
    """A point z on the branch, its monodromy matrix, knob derivative P_p and the residuals on the way there."""

    z: np.ndarray
    flow: Flow
    knob_slope: np.ndarray
    residuals: tuple[float, ...]


class BranchEquations:
    """The n-period map along one axis: values, derivatives and Newton's method."""

    def __init__(self, axis: KnobAxis, period: int, stop: Stop | None = None) -> None:
        self.axis, self.period, self.stop = axis, period, stop
        self.size = 2 * axis.scene.N
        self.weight = np.sqrt(self.size)

    def point(self, x: np.ndarray, value: float) -> np.ndarray:
        """z of a scaled state and a knob value."""
        return np.append(x / self.weight, self.axis.coordinate(value))

    def state(self, z: np.ndarray) -> np.ndarray:
        """The scaled state in z."""
        return z[:-1] * self.weight

    def value(self, z: np.ndarray) -> float:
        """The knob's value in z."""
        return self.axis.value(float(z[-1]))

    def stroboscopic_map(self, value: float, periods: int | None = None,
                         tolerance: float = TOLERANCE) -> StroboscopicMap:
        """The map at a knob value, always a new one, so that equal calls give equal bits."""
        return StroboscopicMap(self.axis.scene_at(value), periods or self.period, self.stop, tolerance)

    def least_period(self, x: np.ndarray, value: float) -> int:
        """The drive periods after which the orbit through x repeats, at most `period`."""
        return least_period(lambda periods: self.stroboscopic_map(value, periods).end(x), x, self.period, BACK)

    def solve(self, z: np.ndarray, normal: np.ndarray, slope: np.ndarray | None = None,
              farthest: float = np.inf) -> Solved:
        """The branch's point in the plane through z across `normal`, at most `farthest` from z.

        `slope` is P_p nearby, where it is known. Each Newton step but the last is followed by one that reuses its
        derivative, since the map alone is cheaper. The first map is a rough one, the last never. Raises
        `NumbersFailed` with the residuals where the method does not converge.
        """
        start, residuals = z, list[float]()
        for number in range(_MOST):
            value, x = self.value(z), self.state(z)
            rough = number == 0 and slope is not None
            flow = self.stroboscopic_map(value, tolerance=_ROUGH if rough else TOLERANCE)(x)
            residuals.append(relative_change(flow.end - x, x))
            if not rough and (residuals[-1] <= GOOD or (len(residuals) > 2 and residuals[-1] > 0.3 * residuals[-2])):
                break
            slope = self._knob_slope(x, value, flow) if slope is None else slope
            matrix = self._matrix(flow, slope, normal)
            z = z - np.linalg.solve(matrix, np.append(flow.end - x, (z - start) @ normal))
            if not np.linalg.norm(z - start) <= farthest:
                raise NumbersFailed(f"Newton's method went {np.linalg.norm(z - start):.1e} away after residuals "
                                    f"{formatted(residuals)}.", "no-convergence")
            if rough or residuals[-1] > _LAST:
                change = self.stroboscopic_map(self.value(z)).end(self.state(z)) - self.state(z)
                if relative_change(change, self.state(z)) < _NEAR:
                    z = z - np.linalg.solve(matrix, np.append(change, (z - start) @ normal))
        if not residuals[-1] <= ACCEPTED:
            raise NumbersFailed(f"Newton's residuals were {formatted(residuals)}.", "no-convergence")
        return Solved(z, flow, self._knob_slope(self.state(z), self.value(z), flow), tuple(residuals))

    def tangent(self, solved: Solved, towards: np.ndarray) -> np.ndarray:
        """Unit tangent of the branch, on the side of `towards`."""
        found = np.linalg.solve(self._matrix(solved.flow, solved.knob_slope, towards),
                                np.append(np.zeros(self.size), 1.0))
        found /= np.linalg.norm(found)
        return found if found @ towards > 0.0 else -found

    def _matrix(self, flow: Flow, slope: np.ndarray, normal: np.ndarray) -> np.ndarray:
        n = self.size
        matrix = np.empty((n + 1, n + 1))
        matrix[:n, :n] = (flow.derivative - np.eye(n)) * self.weight
        matrix[:n, n] = slope
        matrix[n] = normal
        return matrix

    def _knob_slope(self, x: np.ndarray, value: float, flow: Flow) -> np.ndarray:
        p = self.axis.coordinate(value)
        moved = self.axis.value(p + _DIFFERENCE)
        if moved == value:  # at the knob's largest value the difference is taken downwards
            moved = self.axis.value(p - _DIFFERENCE)
        return (self.stroboscopic_map(moved).end(x) - flow.end) / (self.axis.coordinate(moved) - p)


def formatted(residuals: list[float] | tuple[float, ...]) -> str:
    """Residuals in words."""
    return ", ".join(f"{r:.1e}" for r in residuals)
