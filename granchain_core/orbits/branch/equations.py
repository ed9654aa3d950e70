"""The equations of continuation, Φ(x; ζ) − x = 0 and a condition on the step.

Jacobian   [[(Φ_x − 1)√(2N), Φ_ζ], [nᵀ]] in z = (x/√(2N), ζ): Φ_x is the derivative of the stroboscopic map, and Φ_ζ
           a difference of the map in the knob. n is the normal of the plane in which z is sought. The bordered matrix
           stays regular at folds (Keller 1977).
"""

from __future__ import annotations

import threading
from dataclasses import dataclass

import numpy as np

from ...execution.stop import Stop
from ...integrate.scaling import scale_chain, scale_like, scales_of
from ...steady.residuals import least_displacement
from ...steady.returns import least_period
from ..stroboscopic_map import SAME_ORBIT_DISTANCE, TOLERANCE, Flow, StroboscopicMap
from .axis import KnobAxis
from .newton import ROUGH_TOLERANCE, Near, Newton
from .quick import QuickMap, quick_steps

#: One-sided difference Δζ of the accurate map. Its error from curvature is Δζ Φ_ζζ/2, that from step noise 1e-12/Δζ.
_DIFFERENCE = 1e-6
#: Half of the central difference in ζ of the quick map.
_QUICK_DIFFERENCE = 1e-5


@dataclass(frozen=True, eq=False)
class Solved:
    """A point z on the branch, its flow with the monodromy matrix, the knob derivative Φ_ζ and all residuals."""

    z: np.ndarray
    flow: Flow
    knob_slope: np.ndarray
    residuals: tuple[float, ...]

    @property
    def near(self) -> Near:
        """The derivatives, for use in the search for an orbit nearby."""
        return Near(self.flow.derivative, self.knob_slope)


class BranchEquations:
    """The n-period map along one axis: values, derivatives and Newton's method."""

    def __init__(self, axis: KnobAxis, period: int, stop: Stop | None = None) -> None:
        self.axis, self.period, self.stop = axis, period, stop
        self.size = 2 * axis.scene.N
        self.weight = np.sqrt(self.size)
        self._scaled = scale_chain(axis.scene)
        self._reused = threading.local()

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
        """The map at a knob value: a new object each time, so that equal calls give equal bits."""
        return StroboscopicMap(self.axis.scene_at(value), periods or self.period, self.stop, tolerance)

    def reused_map(self, value: float, tolerance: float) -> StroboscopicMap:
        """The map at a knob value, in an object that the same thread's next call changes."""
        kept_map: StroboscopicMap | None = getattr(self._reused, "map", None)
        if kept_map is None:
            kept_map = self._reused.map = self.stroboscopic_map(value, tolerance=tolerance)
        else:
            kept_map.move(self.axis.scene_at(value), tolerance)
        return kept_map

    def drive_rate(self, z: np.ndarray) -> float:
        """The scaled drive frequency β near z."""
        scene = self.axis.scene_at(self.value(z))
        return 2.0 * np.pi * scene.f / scales_of(scene).phi

    def quick_steps(self, z: np.ndarray) -> int:
        """Steps per period of the quick map near z; 0 where the flow is used instead."""
        return quick_steps(scale_like(self._scaled, self.axis.scene_at(self.value(z))))

    def quick_end(self, x: np.ndarray, value: float, steps: int) -> np.ndarray:
        """The end of the quick map from x, or of a rough flow if `steps` is 0."""
        if steps == 0:
            return self.reused_map(value, ROUGH_TOLERANCE).end(x)
        quick: QuickMap | None = getattr(self._reused, "quick", None)
        if quick is None:
            quick = self._reused.quick = QuickMap(self.period, self.stop)
        return quick.end(self.axis.scene_at(value), x, steps)

    def quick_slope(self, z: np.ndarray, steps: int) -> np.ndarray:
        """Φ_ζ (2N,) at z by a central difference of the quick map."""
        zeta, x = self.axis.coordinate(self.value(z)), self.state(z)
        above, below = (self.axis.value(zeta + step) for step in (_QUICK_DIFFERENCE, -_QUICK_DIFFERENCE))
        change = self.quick_end(x, above, steps) - self.quick_end(x, below, steps)
        return change / (self.axis.coordinate(above) - self.axis.coordinate(below))

    def least_period(self, x: np.ndarray, value: float, back: float = SAME_ORBIT_DISTANCE) -> int:
        """Number of drive periods, at most `period`, after which the orbit returns to x within `back`, relative."""
        smallest = least_displacement(x, self.drive_rate(self.point(x, value)))
        return least_period(lambda periods: self.stroboscopic_map(value, periods).end(x), x, self.period, back,
                            smallest)

    def solve(self, z: np.ndarray, normal: np.ndarray, slope: np.ndarray | None = None,
              farthest: float = np.inf) -> Solved:
        """Find the branch's point in the plane through z perpendicular to `normal`, at most `farthest` from z.

        `slope` is Φ_ζ nearby, if known. Raises `ComputationError` with the residuals where Newton's method does not
        converge.
        """
        newton = Newton(self, z, normal, farthest)
        flow = newton.solve_with_derivatives(slope)
        return Solved(newton.z, flow, self.knob_slope(newton.z, flow.end, TOLERANCE), tuple(newton.residuals))

    def solve_near(self, z: np.ndarray, normal: np.ndarray, near: Near, farthest: float = np.inf) -> Solved:
        """Like `solve`, with Φ_x and Φ_ζ of an orbit nearby, so that few further derivatives are needed."""
        newton = Newton(self, z, normal, farthest)
        newton.solve_quick(near)
        flow = newton.solve_exact()
        return Solved(newton.z, flow, self.quick_slope(newton.z, newton.steps), tuple(newton.residuals))

    def tangent(self, solved: Solved, towards: np.ndarray) -> np.ndarray:
        """Unit tangent of the branch, on the side of `towards`."""
        return self.tangent_of(solved.flow.derivative, solved.knob_slope, towards)

    def tangent_of(self, derivative: np.ndarray, slope: np.ndarray, towards: np.ndarray) -> np.ndarray:
        """Unit tangent of the branch for given Φ_x and Φ_ζ, on the side of `towards`."""
        return self.tangent_by(self.matrix(derivative, slope, towards), towards)

    def tangent_by(self, matrix: np.ndarray, towards: np.ndarray) -> np.ndarray:
        """Unit tangent of the branch from the bordered matrix, on the side of `towards`."""
        tangent = np.linalg.solve(matrix, np.append(np.zeros(self.size), 1.0))
        tangent /= np.linalg.norm(tangent)
        return tangent if tangent @ towards > 0.0 else -tangent

    def matrix(self, derivative: np.ndarray, slope: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """The bordered matrix of Newton's method (2N + 1, 2N + 1)."""
        n = self.size
        matrix = np.empty((n + 1, n + 1))
        matrix[:n, :n] = (derivative - np.eye(n)) * self.weight
        matrix[:n, n] = slope
        matrix[n] = normal
        return matrix

    def knob_slope(self, z: np.ndarray, end: np.ndarray, tolerance: float) -> np.ndarray:
        """Φ_ζ (2N,) at z, from where the map of this tolerance leads to `end`."""
        zeta = self.axis.coordinate(self.value(z))
        moved = self.axis.value(zeta + _DIFFERENCE)
        if moved == self.axis.value(zeta):  # at the knob's largest value, use a downward difference
            moved = self.axis.value(zeta - _DIFFERENCE)
        return (self.reused_map(moved, tolerance).end(self.state(z)) - end) / (self.axis.coordinate(moved) - zeta)
