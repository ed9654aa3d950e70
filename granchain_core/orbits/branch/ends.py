"""The ends of a branch: at an end of the axis, at its own start, or where it merges with one of half its period."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from .between import Between, cubic
from .equations import BranchEquations
from .newton import Near
from .point import BranchPoint, branch_point
from .special import SpecialPoint

#: [branch] Distance of the starting orbit from a step, relative to the step's length, within which the step passes it.
_PASSING_DISTANCE = 0.2
#: [branch] Distance of the corrected point from the starting orbit within which the branch has closed.
_CLOSING_DISTANCE = 1e-7


@dataclass(frozen=True, eq=False)
class Ending:
    """The last orbit of a step with Φ_x and Φ_ζ. `ended` and `reason` are "" unless the branch ends there."""

    point: BranchPoint
    near: Near
    ended: str = ""
    reason: str = ""


class Ends:
    """The ends of the branch that begins at `start`."""

    def __init__(self, equations: BranchEquations, start: BranchPoint) -> None:
        self.equations, self.start = equations, start
        self._starts = _images(equations, start)

    def of_step(self, last: Ending, beyond: Ending, z: np.ndarray, may_close: bool) -> Ending:
        """The end of a step from `last` to `beyond`, at z: an earlier orbit if it passes the start or an axis end.

        z shows whether the axis end is passed. The knob's value does not, because it is limited to the allowed range.
        """
        axis = self.equations.axis
        closing = self._closing(last, beyond) if may_close else None
        if closing is not None:
            reason = (f"closed on itself at {axis.text(closing.knob)} after {closing.arclength:.3g} of arclength: the "
                      "orbit there is the starting one")
            return Ending(closing, beyond.near, "closed", reason)
        low, high = axis.coordinate(axis.low), axis.coordinate(axis.high)
        if low <= z[-1] <= high:
            return beyond
        point, near = self._landed(last.point, beyond.point, z, axis.high if z[-1] > high else axis.low)
        if point.knob == self.start.knob:
            return Ending(point, near, "returned", f"came back to {axis.text(point.knob)}")
        return Ending(point, near, "reached", f"reached {axis.text(point.knob)}")

    def merging(self, special: list[SpecialPoint]) -> int | None:
        """Index of the merging: the passage through +1 at which the difference of the orbit's halves changes sign."""
        if self.equations.period % 2:
            return None
        for place, point in enumerate(special):
            if (point.kind in ("fold", "multiplier_one")
                    and self._halves(point.before) @ self._halves(point.after) < 0.0):
                return place
        return None

    def _landed(self, last: BranchPoint, beyond: BranchPoint, zb: np.ndarray, end: float) -> tuple[BranchPoint, Near]:
        """The orbit exactly at the axis end that was passed on the way to `beyond`, which is at zb."""
        axis, za = self.equations.axis, self._z(last)
        fraction = (axis.coordinate(end) - za[-1]) / (zb[-1] - za[-1])
        distance = float(np.linalg.norm(zb - za))
        guess = cubic(za, zb, distance * last.tangent, distance * beyond.tangent, fraction)
        guess[-1] = axis.coordinate(end)
        fixed = np.zeros(len(guess))
        fixed[-1] = 1.0
        solved = self.equations.solve(guess, fixed, last.slope)
        point = branch_point(self.equations, solved, self.equations.tangent(solved, last.tangent),
                             last.arclength + fraction * (beyond.arclength - last.arclength))
        return replace(point, knob=end, damped=axis.damped_at(end)), solved.near

    def _halves(self, point: BranchPoint) -> np.ndarray:
        """Change of the state over half of the orbit."""
        return self.equations.stroboscopic_map(point.knob, self.equations.period // 2).end(point.x) - point.x

    def _closing(self, last: Ending, beyond: Ending) -> BranchPoint | None:
        """The starting orbit again, if the step from `last` to `beyond` passed it and Newton's method leads there."""
        za, zb = self._z(last.point), self._z(beyond.point)
        step = zb - za
        length = float(np.linalg.norm(step))
        for start in self._starts:
            along = float((start - za) @ step) / length**2
            if 0.0 < along <= 1.0 and np.linalg.norm(start - za - along * step) < _PASSING_DISTANCE * length:
                between = Between(self.equations, last.point, beyond.point, (last.near, beyond.near))
                point = between.careful(last.point, beyond.point, along)
                if np.linalg.norm(self._z(point) - start) < _CLOSING_DISTANCE:
                    return point
        return None

    def _z(self, point: BranchPoint) -> np.ndarray:
        return self.equations.point(point.x, point.knob)


def _images(equations: BranchEquations, start: BranchPoint) -> list[np.ndarray]:
    """The starting orbit at the beginning of each of its drive periods."""
    x, images = start.x, []
    for _ in range(equations.period):
        images.append(equations.point(x, start.knob))
        x = equations.stroboscopic_map(start.knob, 1).end(x)
    return images
