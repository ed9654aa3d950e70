"""Continuation of a branch: tangent predictor, Newton corrector, and the search for special points in between.

The step grows while Newton's method needs few iterations and the tangent hardly turns, and shrinks otherwise. A
failed step is halved; at the smallest step the branch ends, and the last residuals are reported.

Other threads record the forces and contacts of an orbit and look for the special points before it, while the walk goes
some orbits ahead; an orbit is added when all before it are known, so that the branch is the same as without threads, to
the last bit.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np

from ...errors import Cancelled, NumbersFailed
from .between import Between, across, cubic
from .equations import BranchEquations, Solved
from .newton import Near, formatted
from .point import BranchPoint, branch_point, recorded, unrecorded
from .special import SpecialPoint, special_between

#: First step in arclength.
FIRST = 0.02
#: Longest step.
LONGEST = 0.4
#: Shortest step.
SHORTEST = 1e-7
#: The step grows after at most this many Newton iterations.
_EASY = 3
#: The step shrinks after at least this many.
_HARD = 5
#: Cosine of the tangent's turn up to which a step grows.
_STRAIGHT = np.cos(np.radians(10.0))
#: Cosine of the turn beyond which a step is rejected.
_BENT = np.cos(np.radians(30.0))
#: Factors by which a step grows and shrinks.
_GROW = 2.0
_SHRINK = 0.6
#: Largest distance from the predicted to the corrected point, as a fraction of the step.
_OFF = 0.3
#: A step passes the seed if the seed lies this near to it, relative to its length.
_PASSES = 0.2
#: The branch has closed if the corrected point is this near to the seed.
_CLOSED = 1e-7
#: Points from the seed on before the branch may close on itself.
_AWAY = 4
#: Orbits that the walk is ahead of the search for special points, and threads that search.
_AHEAD, _THREADS = 4, 2


@dataclass
class Arm:
    """One direction of a branch from its seed: points (the seed first), special points, and how it ended.

    `ended` is "" while there is more to come, else "reached", "returned", "closed", "merged" or "lost"; `reason` is
    a sentence. `step` is the next step in arclength: with it and the last point the walk goes on as if it had
    never stopped.
    """

    direction: int
    points: list[BranchPoint]
    special: list[SpecialPoint] = field(default_factory=list)
    step: float = FIRST
    ended: str = ""
    reason: str = ""


@dataclass(frozen=True)
class _Ahead:
    """An orbit whose special points are still looked for: how the branch ends there, and the steps to and from it.

    `found` will be the orbit with its forces and contacts, and the special points before it.
    """

    point: BranchPoint
    near: Near
    ended: str
    reason: str
    tried: float
    step: float
    found: Future[tuple[BranchPoint, list[SpecialPoint]]]


class Walk(Iterator[BranchPoint]):
    """The points of one arm, one after the other; each `next` adds one to the arm, with the special points before it.

    A walk that is not iterated is paused; one whose stop flag is set raises `Cancelled` and can go on later.
    """

    def __init__(self, equations: BranchEquations, arm: Arm) -> None:
        self.equations, self.arm = equations, arm
        self._seeds = _images(equations, arm.points[0])
        self._pool = ThreadPoolExecutor(min(_THREADS, os.cpu_count() or 1))
        self._known: tuple[BranchPoint, Near] | None = None
        self._go_back(arm.step)

    def __next__(self) -> BranchPoint:
        arm = self.arm
        while not arm.ended:
            try:
                while len(self._ahead) < _AHEAD and self._goes_on:
                    self._advance()
                if not self._ahead:
                    self._lose()
                    break
                one = self._ahead.popleft()
                try:
                    point, special = one.found.result()
                except (NumbersFailed, np.linalg.LinAlgError) as problem:
                    self._go_back(0.5 * one.tried, problem)
                    continue
            except Cancelled:
                self._go_back(arm.step)
                raise
            self._add(one, point, special)
            return arm.points[-1]
        raise StopIteration

    # --- ahead of the arm ----------------------------------------------------------------------------------

    def _go_back(self, step: float, failure: Exception | None = None) -> None:
        """Forget what is ahead, and go on from the arm's last orbit with this step."""
        self._ahead: deque[_Ahead] = deque()
        self._step, self._failure = step, failure

    @property
    def _goes_on(self) -> bool:
        return self._step >= SHORTEST and not (self._ahead and self._ahead[-1].ended)

    @property
    def _last_two(self) -> list[BranchPoint]:
        """The last two orbits, or the seed alone."""
        return [*self.arm.points[-2:], *(one.point for one in self._ahead)][-2:]

    def _advance(self) -> None:
        """Compute the next orbit ahead; halve the step where it is too long."""
        last, tried, near = self._last_two[-1], self._step, self._near_last
        try:
            point, changes, derivatives, ended, reason = self._next_orbit(last, near)
        except (NumbersFailed, np.linalg.LinAlgError) as problem:
            self._step, self._failure = 0.5 * tried, problem
            return
        before = self._ahead[-1].found if self._ahead else last
        found = self._pool.submit(self._completed, before, point, changes, (near, derivatives))
        self._ahead.append(_Ahead(point, derivatives, ended, reason, tried, self._step, found))

    def _completed(self, before: BranchPoint | Future[tuple[BranchPoint, list[SpecialPoint]]], point: BranchPoint,
                   changes: np.ndarray | None, near: tuple[Near, Near]) -> tuple[BranchPoint, list[SpecialPoint]]:
        """The orbit with its forces and contacts, and the special points between the one before and itself."""
        last = before.result()[0] if isinstance(before, Future) else before
        if changes is not None:
            point = recorded(self.equations, point, changes)
        return point, special_between(Between(self.equations, last, point, near))

    @property
    def _near_last(self) -> Near:
        """P_x and P_p at the last orbit. Where P_x is not known it is computed again, to the same bits."""
        if self._ahead:
            return self._ahead[-1].near
        last = self.arm.points[-1]
        if self._known is None or self._known[0] is not last:
            self._known = last, Near(self.equations.stroboscopic_map(last.knob)(last.x).derivative, last.slope)
        return self._known[1]

    def _next_orbit(self, last: BranchPoint, near: Near) -> tuple[BranchPoint, np.ndarray | None, Near, str, str]:
        """The next orbit, and how and why the branch ends there; `NumbersFailed` where the step is too long.

        It comes with its contact events where forces and contacts are still to be found, and with P_x and P_p.
        """
        equations = self.equations
        solved = equations.solve(self._predicted(last), last.tangent, last.slope, _OFF * self._step)
        self._refuse_shorter(solved)
        tangent = equations.tangent(solved, last.tangent)
        cosine = float(tangent @ last.tangent)
        if cosine < _BENT:
            raise NumbersFailed(f"the branch turns by {np.degrees(np.arccos(np.clip(cosine, -1, 1))):.0f}° in one step",
                                "no-convergence")
        chord = float(np.linalg.norm(solved.z - self._z(last)))
        point = unrecorded(equations, solved, tangent, last.arclength + chord)
        ending, derivatives, ended, reason = self._end(last, near, point, solved.near)
        self._adapt(solved, cosine)
        return ending, solved.flow.changes if ending is point else None, derivatives, ended, reason

    # --- the arm -------------------------------------------------------------------------------------------

    def _add(self, one: _Ahead, point: BranchPoint, special: list[SpecialPoint]) -> None:
        """Add an orbit and the special points before it to the arm, which ends at a merging."""
        arm, ended, reason = self.arm, one.ended, one.reason
        merging = self._merging(special)
        if merging is not None:
            special, point = special[: merging + 1], special[merging].before
            special[merging] = replace(special[merging], kind="period_doubling")
            ended = "merged"
            reason = (f"merged with the branch of period {self.equations.period // 2}, whose period doubles at "
                      f"{self.equations.axis.text(special[merging].knob)}: beyond it are the same orbits, half a "
                      "period later")
        arm.special.extend(special)
        if point is not arm.points[-1]:
            arm.points.append(point)
            self._known = point, one.near
        arm.step, arm.ended, arm.reason = one.step, ended, reason

    def _lose(self) -> None:
        last, arm = self.arm.points[-1], self.arm
        singular = isinstance(self._failure, np.linalg.LinAlgError)
        failure = "the equations became singular" if singular else str(self._failure)
        arm.step, arm.ended = self._step, "lost"
        arm.reason = (f"the branch could not be followed beyond {self.equations.axis.text(last.knob)} although "
                      f"steps were shortened to {SHORTEST:g}: {failure.rstrip('.')}; residuals at the last orbit: "
                      f"{formatted(last.residuals)}")

    def _refuse_shorter(self, solved: Solved) -> None:
        """Raise `NumbersFailed` where a step fell onto another branch, whose orbits have a part of the period."""
        n = self.equations.period
        least = self.equations.least_period(self.equations.state(solved.z), self.equations.value(solved.z))
        if least < n:
            raise NumbersFailed(f"the step leads to an orbit that repeats after {least} of {n} drive periods",
                                "no-convergence")

    def _predicted(self, last: BranchPoint) -> np.ndarray:
        """A step along the tangent, bent as the branch has bent since the point before."""
        step, z = self._step, self._z(last)
        guess = z + step * last.tangent
        if len(self._last_two) > 1:
            before = self._last_two[0]
            bend = across(last.tangent - before.tangent, last.tangent) / (last.arclength - before.arclength)
            sideways = 0.5 * step**2 * bend
            if np.linalg.norm(sideways) < _OFF * step:
                guess += sideways
        return guess

    def _adapt(self, solved: Solved, cosine: float) -> None:
        iterations = len(solved.residuals) - 1
        if iterations <= _EASY and cosine >= _STRAIGHT:
            self._step = min(LONGEST, _GROW * self._step)
        elif iterations >= _HARD or cosine < _STRAIGHT:
            self._step *= _SHRINK

    def _z(self, point: BranchPoint) -> np.ndarray:
        return self.equations.point(point.x, point.knob)

    # --- ends ----------------------------------------------------------------------------------------------

    def _end(self, last: BranchPoint, near: Near, point: BranchPoint,
             derivatives: Near) -> tuple[BranchPoint, Near, str, str]:
        """The step's last point, and how and why the branch ends there, if it does."""
        axis = self.equations.axis
        closing = self._closing(last, near, point, derivatives)
        if closing is not None:
            return closing, derivatives, "closed", (f"closed on itself at {axis.text(closing.knob)} after "
                                            f"{closing.arclength:.3g} of arclength: the orbit there is the seed's")
        if axis.contains(point.knob):
            return point, derivatives, "", ""
        (landed, near_landed), first = self._landed(last, point), self.arm.points[0].knob
        if landed.knob == first:
            return landed, near_landed, "returned", f"came back to {axis.text(first)}"
        return landed, near_landed, "reached", f"reached {axis.text(landed.knob)}"

    def _landed(self, last: BranchPoint, beyond: BranchPoint) -> tuple[BranchPoint, Near]:
        """The orbit exactly at the end of the axis that was passed."""
        axis = self.equations.axis
        end = axis.high if beyond.knob > axis.high else axis.low
        za, zb = self._z(last), self._z(beyond)
        fraction = (axis.coordinate(end) - za[-1]) / (zb[-1] - za[-1])
        way = float(np.linalg.norm(zb - za))
        guess = cubic(za, zb, way * last.tangent, way * beyond.tangent, fraction)
        guess[-1] = axis.coordinate(end)
        fixed = np.zeros(len(guess))
        fixed[-1] = 1.0
        solved = self.equations.solve(guess, fixed, last.slope)
        point = branch_point(self.equations, solved, self.equations.tangent(solved, last.tangent),
                             last.arclength + fraction * (beyond.arclength - last.arclength))
        return replace(point, knob=end), solved.near

    def _merging(self, special: list[SpecialPoint]) -> int | None:
        """Index of a fold that is a merging: the difference of the orbit's two halves changes sign there."""
        if self.equations.period % 2:
            return None
        for place, one in enumerate(special):
            if one.kind == "fold" and self._halves(one.before) @ self._halves(one.after) < 0.0:
                return place
        return None

    def _halves(self, point: BranchPoint) -> np.ndarray:
        """Difference of the state half an orbit later from the state now."""
        return self.equations.stroboscopic_map(point.knob, self.equations.period // 2).end(point.x) - point.x

    def _closing(self, last: BranchPoint, near: Near, point: BranchPoint, derivatives: Near) -> BranchPoint | None:
        """The seed again, if the step from `last` to `point` passed it and Newton's method leads there."""
        if len(self.arm.points) + len(self._ahead) < _AWAY:
            return None
        za, zb = self._z(last), self._z(point)
        way = zb - za
        length = float(np.linalg.norm(way))
        for seed in self._seeds:
            along = float((seed - za) @ way) / length**2
            if 0.0 < along <= 1.0 and np.linalg.norm(seed - za - along * way) < _PASSES * length:
                found = Between(self.equations, last, point, (near, derivatives)).careful(last, point, along)
                if np.linalg.norm(self._z(found) - seed) < _CLOSED:
                    return found
        return None


def _images(equations: BranchEquations, seed: BranchPoint) -> list[np.ndarray]:
    """The seed's orbit started at each of its drive periods."""
    x, images = seed.x, []
    for _ in range(equations.period):
        images.append(equations.point(x, seed.knob))
        x = equations.stroboscopic_map(seed.knob, 1).end(x)
    return images
