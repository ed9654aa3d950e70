"""Newton's method for one orbit of a branch, with few derivatives of the map.

Equation   J Δz = −F,  F = (Φ(x; ζ) − x, (z − z0)·n),  J as in equations.py;  after a step J is corrected by Broyden's
           rank-one update, J ← J + F(z + Δz) Δzᵀ/|Δz|²
Source     Broyden 1965; Dennis & Schnabel 1983, Numerical Methods for Unconstrained Optimization, chapter 8
Note       With eleven beads, the accurate map (the flow at 1e-13) takes 2 ms, or 5 ms with its derivative; the quick
           map (quick.py) takes 0.3 ms. So J starts as a derivative known nearby, and the quick map is solved first.
           Then the accurate map is computed once. Its difference from the quick one, the defect, hardly changes over
           the remaining distance, so the steps to the orbit itself use the quick map with the defect added (deferred
           correction). The accurate map's derivative is computed only at the orbit, for the multipliers; its residual
           there decides whether the orbit is accepted.
           A derivative of the rough map is computed where steps without one converge too slowly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...errors import ComputationError
from ...steady.residuals import ACCEPTED_RESIDUAL, RESIDUAL_GOAL, formatted, orbit_change
from ..stroboscopic_map import TOLERANCE, Flow, StroboscopicMap

#: [branch] Tolerance of the rough map, which is the flow where full accuracy is not needed.
ROUGH_TOLERANCE = 1e-10
#: [branch] Residual above which the rough map is computed with the tolerance `_ROUGHEST_TOLERANCE`.
_ROUGHEST_ABOVE = 1e-3
#: [branch] Tolerance of the rough map where the residual is large. The map is then accurate to 1e-6 (measured: 7e-7 on
#: the branch of sec2 over f).
_ROUGHEST_TOLERANCE = 1e-7
#: [branch] Residual at which steps by the quick map end. Its own error is as large.
QUICK_RESIDUAL = 1e-8
#: [branch] Largest residual at which a derivative from nearby is used.
_LARGEST_WITH_REUSED = 3e-3
#: [branch] After a step that does not lower the residual to this fraction, a derivative is computed.
_SLOW_DECREASE = 0.4
#: [branch] A step with its own derivative that does not lower the residual to this fraction has failed. A shorter step
#: along the branch is safer than iterations that may lead to another branch (Deuflhard 2004, Newton Methods for
#: Nonlinear Problems).
_FAILED_DECREASE = 0.5
#: [branch] A step with the derivative of the accurate map that does not lower the residual to this fraction has reached
#: the level of rounding.
_STALLED_DECREASE = 0.3
#: [branch] The accurate map with its derivative is computed once its residual is expected to be below this fraction of
#: `RESIDUAL_GOAL`.
_SAFETY = 0.3
#: [branch] Maximum number of derivatives of the rough map, and of the accurate map.
_MOST_DERIVATIVES = 6
#: [branch] Least residual before a step of `solve_with_derivatives` that may be followed by one that reuses its
#: derivative.
_LEAST_BEFORE_REUSE = 1e-6
#: [branch] Largest residual before a step that reuses the derivative of the step before it.
_LARGEST_REUSE = 1e-4
#: [branch] Maximum number of steps of `solve_with_derivatives`.
_MOST_STEPS = 8
#: [branch] Maximum number of steps by the quick map with the defect added.
_MOST_CORRECTED_STEPS = 6


@dataclass(frozen=True, eq=False)
class Near:
    """Φ_x (2N, 2N) and Φ_ζ (2N,) of an orbit nearby."""

    derivative: np.ndarray
    slope: np.ndarray


class Equations(Protocol):
    """What Newton's method needs of the equations (equations.py)."""

    def state(self, z: np.ndarray) -> np.ndarray:
        """The scaled state in z."""

    def value(self, z: np.ndarray) -> float:
        """The knob's value in z."""

    def matrix(self, derivative: np.ndarray, slope: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """The bordered matrix."""

    def knob_slope(self, z: np.ndarray, end: np.ndarray, tolerance: float) -> np.ndarray:
        """Φ_ζ at z, from where the map leads to `end`."""

    def reused_map(self, value: float, tolerance: float) -> StroboscopicMap:
        """The map at a knob value."""

    def drive_rate(self, z: np.ndarray) -> float:
        """The scaled drive frequency β near z."""

    def quick_steps(self, z: np.ndarray) -> int:
        """Steps per period of the quick map near z."""

    def quick_end(self, x: np.ndarray, value: float, steps: int) -> np.ndarray:
        """The end of the quick map from x."""


class Newton:
    """The iteration from one start: the current point `z`, J, and the residuals of all maps so far.

    `z` moves at most `farthest` from the start. `steps` is the number of steps per period of the quick map.
    """

    def __init__(self, equations: Equations, z: np.ndarray, normal: np.ndarray, farthest: float = np.inf) -> None:
        self.equations, self.start, self.normal, self.farthest = equations, z, normal, farthest
        self.z, self.residuals = z, list[float]()
        self.matrix, self.steps, self._beta = np.empty(0), equations.quick_steps(z), equations.drive_rate(z)
        self._quick_end_here: np.ndarray | None = None

    def solve_quick(self, near: Near) -> None:
        """Solve for the orbit of the quick map, to within the error of that map."""
        if self._reuse_derivative(near):
            return
        for _ in range(_MOST_DERIVATIVES):
            coarse = not self.residuals or self.residuals[-1] > _ROUGHEST_ABOVE
            flow = self.flow(_ROUGHEST_TOLERANCE if coarse else ROUGH_TOLERANCE)
            before = self.residuals[-1]
            self.matrix = self.equations.matrix(flow.derivative, near.slope, self.normal)
            if before <= QUICK_RESIDUAL or self._steps_without_derivative(flow.end):
                return
            if not self.residuals[-1] <= _FAILED_DECREASE * before:
                break
        raise self._failure()

    def solve_exact(self) -> Flow:
        """Solve for the orbit of the accurate map from that of the quick one; return its flow with the derivative."""
        quick = self._quick_end() if self._quick_end_here is None else self._quick_end_here
        end, ratio = self._exact_end(TOLERANCE), 1.0
        self._record(end)
        defect = end - quick
        for _ in range(_MOST_CORRECTED_STEPS):
            before = self.residuals[-1]
            if before <= _SAFETY * RESIDUAL_GOAL:
                break
            moved = self._checked_step(end)
            if before * ratio <= _SAFETY * RESIDUAL_GOAL:
                break
            end = self._quick_end() + defect
            self._record(end)
            ratio = self.residuals[-1] / before
            if not ratio <= _SLOW_DECREASE:
                break
            self._broyden_update(end, moved)
        for number in range(_MOST_DERIVATIVES):
            flow = self.flow(TOLERANCE)
            if self.residuals[-1] <= RESIDUAL_GOAL or (number and self._stalled()):
                break
            self.matrix = self.equations.matrix(flow.derivative, self.matrix[:-1, -1], self.normal)
            self._checked_step(flow.end)
        if not self.residuals[-1] <= ACCEPTED_RESIDUAL:
            raise self._failure()
        return flow

    def solve_with_derivatives(self, slope: np.ndarray | None = None) -> Flow:
        """Solve for the orbit itself by steps with derivatives; `residuals` has one entry each. `slope` is Φ_ζ nearby.

        This is for orbits near which no derivative is known, and for those where fewer derivatives have failed. Each
        step but the last is followed by one that reuses its derivative. With `slope`, the first map is computed at the
        rough tolerance; the accepted one never is.
        """
        rough = slope is not None
        for _ in range(_MOST_STEPS):
            flow = self.flow(ROUGH_TOLERANCE if rough else TOLERANCE)
            residual = self.residuals[-1]
            stalled = len(self.residuals) > 2 and self._stalled()
            if not rough and (residual <= RESIDUAL_GOAL or stalled):
                break
            slope = self.equations.knob_slope(self.z, flow.end, TOLERANCE) if slope is None else slope
            self.matrix = self.equations.matrix(flow.derivative, slope, self.normal)
            self._checked_step(flow.end)
            if rough or residual > _LEAST_BEFORE_REUSE:
                again = self._exact_end(TOLERANCE)
                if self._residual(again) < _LARGEST_REUSE:
                    self._step(again)
            rough = False
        if not self.residuals[-1] <= ACCEPTED_RESIDUAL:
            raise self._failure()
        return flow

    def _reuse_derivative(self, near: Near) -> bool:
        """Try steps with a derivative from nearby; return True if they lead to the orbit.

        If they lead away from it, z is reset to the start.
        """
        try:
            end = self._quick_end()
            first = self._record(end)
            if first > _LARGEST_WITH_REUSED:
                return False
            self.matrix = self.equations.matrix(near.derivative, near.slope, self.normal)
            enough = first <= QUICK_RESIDUAL or self._steps_without_derivative(end)
            if not enough and not self.residuals[-1] < first:
                self.z, self._quick_end_here = self.start, None
            return enough
        except ComputationError:
            self.z, self._quick_end_here = self.start, None
            return False

    def _steps_without_derivative(self, end: np.ndarray) -> bool:
        """Take steps without a derivative, after a map that led to `end`; return True if they come near enough."""
        while True:
            before = self.residuals[-1]
            moved = self._checked_step(end)
            end = self._quick_end()
            residual = self._record(end)
            if residual > QUICK_RESIDUAL and not residual <= _SLOW_DECREASE * before:
                return False
            self._broyden_update(end, moved)
            if residual <= QUICK_RESIDUAL:
                return True

    def _broyden_update(self, end: np.ndarray, moved: np.ndarray) -> None:
        """Apply Broyden's update to J after the step `moved`."""
        self.matrix[:-1] += np.outer(end - self.equations.state(self.z), moved) / (moved @ moved)

    def _checked_step(self, end: np.ndarray) -> np.ndarray:
        """Take Newton's step with the current matrix, after a map that led to `end`; refuse one that goes too far."""
        moved = self._step(end)
        far = float(np.linalg.norm(self.z - self.start))
        if not far <= self.farthest:
            raise ComputationError(f"Newton's method went {far:.1e} away after residuals {formatted(self.residuals)}.",
                                   "no-convergence")
        return moved

    def _step(self, end: np.ndarray) -> np.ndarray:
        change = np.append(end - self.equations.state(self.z), (self.z - self.start) @ self.normal)
        moved = -np.linalg.solve(self.matrix, change)
        self.z, self._quick_end_here = self.z + moved, None
        return moved

    def _exact_end(self, tolerance: float) -> np.ndarray:
        """The end of the accurate map from z."""
        return self.equations.reused_map(self.equations.value(self.z), tolerance).end(self.equations.state(self.z))

    def _quick_end(self) -> np.ndarray:
        """The end of the quick map from z, kept until the next step."""
        self._quick_end_here = self.equations.quick_end(self.equations.state(self.z), self.equations.value(self.z),
                                                        self.steps)
        return self._quick_end_here

    def _residual(self, end: np.ndarray) -> float:
        """Relative residual of z, from where a map leads to `end`."""
        x = self.equations.state(self.z)
        return orbit_change(end - x, x, self._beta)

    def _record(self, end: np.ndarray) -> float:
        """Like `_residual`, but also append it to `residuals`."""
        self.residuals.append(self._residual(end))
        return self.residuals[-1]

    def _stalled(self) -> bool:
        """Whether the last step lowered the residual too little."""
        return self.residuals[-1] > _STALLED_DECREASE * self.residuals[-2]

    def flow(self, tolerance: float) -> Flow:
        """Compute the flow from z with its derivative, and append its residual to `residuals`."""
        flow = self.equations.reused_map(self.equations.value(self.z), tolerance)(self.equations.state(self.z))
        self._record(flow.end)
        return flow

    def _failure(self) -> ComputationError:
        return ComputationError(f"Newton's residuals were {formatted(self.residuals)}.", "no-convergence")
