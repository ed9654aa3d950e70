"""Newton's method for one orbit of a branch: for the walk with a derivative at each point, between two orbits with few.

Equation   J Δz = −F,  F = (P(x; p) − x, (z − z0)·n),  J as in equations.py;  after a step J is corrected by Broyden's
           rank-one update, J ← J + F(z + Δz) Δzᵀ/|Δz|²
Source     Broyden 1965; Dennis & Schnabel 1983, Numerical Methods for Unconstrained Optimization, chapter 8
Note       Between two orbits J begins with derivatives known there. A map costs 0.4 times the map with its derivative,
           a rough one half of an exact one. So a derivative is computed only where steps without one converge too
           slowly, and the exact one only at the orbit itself, for its multipliers.
           The walk has a derivative at each point: how many it needs decides the length of its steps, and with fewer
           of them it was seen to step onto another branch (docs/branches.md).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ...errors import NumbersFailed
from ...steady.returns import relative_change
from ..flow import TOLERANCE, Flow, StroboscopicMap

#: Tolerance of the rough map.
ROUGH = 1e-10
#: Its tolerance while residuals are above `_COARSE`: it is then good to 1e-6 (measured: 7e-7 on sec2's branch over f).
_ROUGHEST, _COARSE = 1e-7, 1e-3
#: Relative residual at which Newton's method stops.
GOOD = 1e-11
#: Largest residual that is accepted where rounding does not let it fall that far.
ACCEPTED = 1e-10
#: The rough map is left where its next residual should be below this: its fixed point is up to 1e-9 from the exact one.
ENOUGH = 1e-9
#: A derivative from elsewhere is used up to this residual.
_FAR = 3e-3
#: A step that does not lower the residual to this part of it is followed by a derivative.
_SLOW = 0.4
#: A step with its own derivative that does not lower the residual to this part of it fails: a shorter step along the
#: branch is safer than a way that may lead to another branch (Deuflhard 2004, Newton Methods for Nonlinear Problems).
_FAILED = 0.5
#: The exact map with its derivative is computed where its residual should be below this part of `GOOD`.
_SURE = 0.3
#: Most derivatives of the rough and of the exact map.
_MOST = 6
#: Each step of `follow` that began above this residual is followed by one that reuses its derivative,
_LAST = 1e-6
#: which is taken if it begins below this residual.
_NEAR = 1e-4
#: Most steps of `follow`.
_MOST_STEPS = 8


@dataclass(frozen=True, eq=False)
class Near:
    """P_x (2N, 2N) and P_p (2N,) of an orbit nearby."""

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
        """P_p at z, where the map leads to `end`."""

    def reused_map(self, value: float, tolerance: float) -> StroboscopicMap:
        """The map at a knob value."""


class Newton:
    """The iteration from one start: the point `z` it has come to, J, and the residuals of all maps.

    The rough map is left where its next residual should be below `enough`; `z` goes at most `farthest`.
    `changes` are the contact events of the last map without derivative, as in `Flow`.
    """

    def __init__(self, equations: Equations, z: np.ndarray, normal: np.ndarray,
                 farthest: float = np.inf, enough: float = ENOUGH) -> None:
        self.equations, self.start, self.normal = equations, z, normal
        self.farthest, self.enough = farthest, enough
        self.z, self.residuals = z, list[float]()
        self.matrix, self.changes = np.empty(0), np.empty((0, 2))

    def approach(self, near: Near) -> np.ndarray:
        """Come so near the orbit that one more step by the rough map is the last; returns that map's end."""
        end = self._borrowed(near)
        for _ in range(_MOST):
            if end is not None:
                break
            flow = self.flow(self._tolerance)
            before = self.residuals[-1]
            self.matrix = self.equations.matrix(flow.derivative, near.slope, self.normal)
            end = flow.end if before <= self.enough else self._steps(flow.end)
            if end is None and not self.residuals[-1] <= _FAILED * before:
                raise self._failure()
        if end is None:
            raise self._failure()
        return end

    def slope(self, end: np.ndarray) -> np.ndarray:
        """P_p where the rough map leads to `end`; J has it from then on."""
        slope = self.equations.knob_slope(self.z, end, ROUGH)
        self.matrix[:-1, -1] = slope
        return slope

    def finish(self, end: np.ndarray, slope: np.ndarray) -> Flow:
        """Go on by the exact map to the orbit itself; returns the map with its derivative there."""
        ratio, moved = self._ratio, None
        self.step(end)
        for _ in range(_MOST):
            end = self._end(TOLERANCE)
            if moved is not None:
                self._update(end, moved)
                ratio = self._ratio
            moved = self.step(end)
            if self.residuals[-1] * ratio <= _SURE * GOOD:
                break
        for number in range(_MOST):
            flow = self.flow(TOLERANCE)
            if self.residuals[-1] <= GOOD or (number and self.residuals[-1] > 0.3 * self.residuals[-2]):
                break
            self.matrix = self.equations.matrix(flow.derivative, slope, self.normal)
            self.step(flow.end)
        if not self.residuals[-1] <= ACCEPTED:
            raise self._failure()
        return flow

    def follow(self, slope: np.ndarray | None = None) -> Flow:
        """The orbit itself by steps with derivatives; `residuals` has one for each. `slope` is P_p nearby.

        Each step but the last is followed by one that reuses its derivative. The first map is a rough one, the last
        never. The length of the walk's next step depends on how many residuals there are.
        """
        rough = slope is not None
        for _ in range(_MOST_STEPS):
            flow = self.flow(ROUGH if rough else TOLERANCE)
            residual = self.residuals[-1]
            if not rough and (residual <= GOOD or (len(self.residuals) > 2 and residual > 0.3 * self.residuals[-2])):
                break
            slope = self.equations.knob_slope(self.z, flow.end, TOLERANCE) if slope is None else slope
            self.matrix = self.equations.matrix(flow.derivative, slope, self.normal)
            self.step(flow.end)
            if rough or residual > _LAST:
                again = self._end(TOLERANCE)
                if self.residuals.pop() < _NEAR:
                    self._move(again)
            rough = False
        if not self.residuals[-1] <= ACCEPTED:
            raise self._failure()
        return flow

    def _borrowed(self, near: Near) -> np.ndarray | None:
        """The end of the rough map where the steps with a derivative from nearby lead; None where they do not."""
        try:
            end = self._end(ROUGH)
            if self.residuals[-1] > _FAR:
                return None
            self.matrix = self.equations.matrix(near.derivative, near.slope, self.normal)
            first = self.residuals[-1]
            found = self._steps(end)
            if found is None and not self.residuals[-1] < first:
                self.z = self.start
            return found
        except NumbersFailed:
            self.z = self.start
            return None

    def _steps(self, end: np.ndarray) -> np.ndarray | None:
        """Steps without a derivative; the rough map's end where its residual is low enough, None where they fail."""
        while True:
            before = self.residuals[-1]
            tolerance = self._tolerance
            moved = self.step(end)
            end = self._end(tolerance)
            residual = self.residuals[-1]
            if residual > self.enough and not residual <= _SLOW * before:
                return None
            self._update(end, moved)
            if tolerance == ROUGH and residual * residual <= self.enough * before:
                return end

    def _update(self, end: np.ndarray, moved: np.ndarray) -> None:
        """Broyden's update of J after a step."""
        self.matrix[:-1] += np.outer(end - self.equations.state(self.z), moved) / (moved @ moved)

    @property
    def _tolerance(self) -> float:
        """The rough map's tolerance after the last residual."""
        return _ROUGHEST if self.residuals and self.residuals[-1] > _COARSE else ROUGH

    @property
    def _ratio(self) -> float:
        """The last residual over the one before; 1 where there is none."""
        return min(1.0, self.residuals[-1] / self.residuals[-2]) if len(self.residuals) > 1 else 1.0

    def step(self, end: np.ndarray) -> np.ndarray:
        """Newton's step with the present matrix, where the map leads to `end`; it is refused if it goes too far."""
        moved = self._move(end)
        far = float(np.linalg.norm(self.z - self.start))
        if not far <= self.farthest:
            raise NumbersFailed(f"Newton's method went {far:.1e} away after residuals {formatted(self.residuals)}.",
                                "no-convergence")
        return moved

    def _move(self, end: np.ndarray) -> np.ndarray:
        change = np.append(end - self.equations.state(self.z), (self.z - self.start) @ self.normal)
        moved = -np.linalg.solve(self.matrix, change)
        self.z = self.z + moved
        return moved

    def _end(self, tolerance: float) -> np.ndarray:
        x = self.equations.state(self.z)
        stroboscopic_map = self.equations.reused_map(self.equations.value(self.z), tolerance)
        end, self.changes = stroboscopic_map.end(x), stroboscopic_map.changes
        self.residuals.append(relative_change(end - x, x))
        return end

    def flow(self, tolerance: float) -> Flow:
        """The map at z with its derivative."""
        x = self.equations.state(self.z)
        flow = self.equations.reused_map(self.equations.value(self.z), tolerance)(x)
        self.residuals.append(relative_change(flow.end - x, x))
        return flow

    def _failure(self) -> NumbersFailed:
        return NumbersFailed(f"Newton's residuals were {formatted(self.residuals)}.", "no-convergence")


def formatted(residuals: list[float] | tuple[float, ...]) -> str:
    """Residuals in words."""
    return ", ".join(f"{r:.1e}" for r in residuals)
