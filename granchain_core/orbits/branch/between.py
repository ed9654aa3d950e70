"""Orbits between two neighbours of a branch, from the cubic through both and the derivatives of the map at both."""

from __future__ import annotations

from bisect import insort

import numpy as np

from ..orbit import sorted_multipliers
from ..stroboscopic_map import TOLERANCE
from .equations import BranchEquations, Solved
from .newton import ROUGH_TOLERANCE, Near, Newton
from .point import BranchPoint, branch_point, rough_point


class Between:
    """The orbits between neighbours a and b. Each computed orbit helps to compute the next.

    `near` are Φ_x and Φ_ζ at both. Only one thread may use it at a time.
    """

    def __init__(self, equations: BranchEquations, a: BranchPoint, b: BranchPoint, near: tuple[Near, Near]) -> None:
        self.equations, self.a, self.b = equations, a, b
        self._known = [(a.arclength, near[0]), (b.arclength, near[1])]
        self._exact: dict[BranchPoint, BranchPoint] = {a: a, b: b}
        self._derivatives = {a: near[0].derivative, b: near[1].derivative}
        self._contacts: dict[BranchPoint, np.ndarray] = {}
        self._way = float(np.linalg.norm(equations.point(a.x, a.knob) - equations.point(b.x, b.knob)))

    def careful(self, a: BranchPoint, b: BranchPoint, fraction: float) -> BranchPoint:
        """The orbit at a fraction of the way from a to b, near the cubic through both with their tangents."""
        guess, normal, distance = self._guess(a, b, fraction)
        solved = self.equations.solve(guess, normal, a.slope, distance)
        return self._finished(solved, a.tangent, self._arclength(a, b, fraction))

    def exact(self, a: BranchPoint, b: BranchPoint, fraction: float) -> BranchPoint:
        """Like `careful`, but mostly with derivatives that are known already, at a, b and orbits between them."""
        guess, normal, distance = self._guess(a, b, fraction)
        return self._solved(guess, normal, a.tangent, self._arclength(a, b, fraction), distance)

    def rough(self, a: BranchPoint, b: BranchPoint, fraction: float) -> BranchPoint:
        """Like `careful`, but with the quick map alone. Values that agree at a and b are copied from a."""
        guess, normal, distance = self._guess(a, b, fraction)
        arclength, newton = self._arclength(a, b, fraction), Newton(self.equations, guess, normal, distance)
        near = self._near(arclength)
        newton.solve_quick(near)
        slope, multipliers, tangent = near.slope, a.multipliers, a.tangent
        if a.knob_direction != b.knob_direction:
            slope = self.equations.quick_slope(newton.z, newton.steps)
            newton.matrix[:-1, -1] = slope
        if (a.knob_direction, a.unstable_multipliers, a.doubling_sign) \
                == (b.knob_direction, b.unstable_multipliers, b.doubling_sign):
            tangent = self.equations.tangent_by(newton.matrix, a.tangent)
        else:
            derivative = newton.flow(ROUGH_TOLERANCE).derivative
            multipliers = sorted_multipliers(derivative)
            tangent = self.equations.tangent_of(derivative, slope, a.tangent)
            self._remember(arclength, Near(derivative, slope))
        return rough_point(self.equations, newton.z, tangent, slope, multipliers, newton.residuals, arclength)

    def made_exact(self, point: BranchPoint) -> BranchPoint:
        """The exact orbit at a rough one; a second call returns the same object."""
        if point not in self._exact:
            z = self.equations.point(point.x, point.knob)
            self._exact[point] = self._solved(z, point.tangent, point.tangent, point.arclength, self._way)
        return self._exact[point]

    def derivative(self, point: BranchPoint) -> np.ndarray:
        """The exact Φ_x of an exact orbit."""
        return self._derivatives[point]

    def contacts(self, point: BranchPoint) -> np.ndarray:
        """The contacts that close and open along an exact orbit, in order: contact + 1, negative where it opens."""
        if point not in self._contacts:
            exact = self.equations.reused_map(point.knob, TOLERANCE)
            exact.end(point.x)
            self._contacts[point] = exact.contact_events[:, 0]
        return self._contacts[point]

    def _solved(self, guess: np.ndarray, normal: np.ndarray, towards: np.ndarray, arclength: float,
                farthest: float) -> BranchPoint:
        solved = self.equations.solve_near(guess, normal, self._near(arclength), farthest)
        return self._finished(solved, towards, arclength)

    def _finished(self, solved: Solved, towards: np.ndarray, arclength: float) -> BranchPoint:
        self._remember(arclength, solved.near)
        point = branch_point(self.equations, solved, self.equations.tangent(solved, towards), arclength)
        self._exact[point], self._derivatives[point] = point, solved.flow.derivative
        self._contacts[point] = solved.flow.contact_events[:, 0]
        return point

    def _arclength(self, a: BranchPoint, b: BranchPoint, fraction: float) -> float:
        return a.arclength + fraction * (b.arclength - a.arclength)

    def _remember(self, arclength: float, near: Near) -> None:
        insort(self._known, (arclength, near), key=lambda known: known[0])

    def _guess(self, a: BranchPoint, b: BranchPoint, fraction: float) -> tuple[np.ndarray, np.ndarray, float]:
        """The cubic's point in the plane of the corrected orbit, the plane's normal, and the distance from a to b."""
        za, zb = self.equations.point(a.x, a.knob), self.equations.point(b.x, b.knob)
        distance = float(np.linalg.norm(zb - za))
        normal = (zb - za) / distance
        guess = za + fraction * (zb - za)
        offset = cubic(za, zb, distance * a.tangent, distance * b.tangent, fraction) - guess
        return guess + across(offset, normal), normal, distance

    def _near(self, arclength: float) -> Near:
        """Φ_x and Φ_ζ at this arclength, interpolated between the two nearest orbits at which they are known."""
        last = len(self._known) - 1
        after = next((i for i in range(1, last) if self._known[i][0] >= arclength), last)
        (s0, before), (s1, behind) = self._known[after - 1 : after + 1]
        part = (arclength - s0) / (s1 - s0) if s1 > s0 else 0.5
        return Near((1.0 - part) * before.derivative + part * behind.derivative,
                    (1.0 - part) * before.slope + part * behind.slope)


def across(vector: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """The component of a vector perpendicular to a unit normal."""
    return vector - (vector @ normal) * normal


def cubic(za: np.ndarray, zb: np.ndarray, ta: np.ndarray, tb: np.ndarray, s: float) -> np.ndarray:
    """Hermite's cubic between two points with their derivatives."""
    r = 1.0 - s
    return (1 + 2 * s) * r * r * za + s * r * r * ta + s * s * (3 - 2 * s) * zb - s * s * r * tb
