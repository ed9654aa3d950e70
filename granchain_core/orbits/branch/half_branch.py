"""Continuation of a branch: predictor along the tangent with the branch's curvature, Newton corrector, special points.

A failed step is halved. Below the shortest step the branch ends, and the last residuals are reported.

Other threads record the forces and contacts of an orbit and look for the special points before it, while the
continuation runs a few orbits ahead. An orbit is added once all orbits before it are known, so that the branch is
identical to the last bit with and without threads.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np

from ...errors import Cancelled, ComputationError
from ...execution.cores import usable_cores
from ...steady.residuals import formatted
from .between import Between
from .criticality import with_normal_forms
from .ends import Ending, Ends
from .equations import BranchEquations, Solved
from .newton import Near
from .point import BranchPoint, recorded, unrecorded
from .special import SpecialPoint
from .special_search import special_between
from .steps import FIRST_STEP, LARGEST_CORRECTION, LEAST_COSINE, SHORTEST_STEP, next_step, predicted

#: [branch] Fewest points, including the starting orbit, before the branch may close on itself.
_POINTS_BEFORE_CLOSING = 4
#: [branch] An orbit that returns to within this relative distance after a fraction of its period is refused. Where the
#: branches of both periods meet, an orbit of the shorter period is found with an error far above its residual.
_SHORTER_PERIOD_DISTANCE = 1e-6
#: [no threshold] Maximum number of orbits that the continuation is ahead of the search for special points.
_ORBITS_AHEAD = 4
#: [no threshold] Maximum number of threads that search; never more than usable cores.
_THREADS = 2


@dataclass
class HalfBranch:
    """One direction of a branch from its starting orbit: points (the starting orbit first), special points, and end.

    `ended` is "" while the half-branch can grow, otherwise "reached", "returned", "closed", "merged" or "lost";
    `reason` is a sentence. `step` is the next step in arclength: from it and the last point, the continuation resumes
    as if it had never stopped.
    """

    direction: int
    points: list[BranchPoint]
    special: list[SpecialPoint] = field(default_factory=list)
    step: float = FIRST_STEP
    ended: str = ""
    reason: str = ""


@dataclass(frozen=True)
class _Ahead:
    """An orbit ahead of the half-branch, with the step that was `tried` to reach it and the next `step`.

    `found` is the future orbit with its forces and contacts, and the special points before it.
    """

    ending: Ending
    tried: float
    step: float
    found: Future[tuple[BranchPoint, list[SpecialPoint]]]


class HalfContinuation(Iterator[BranchPoint]):
    """The points of one half-branch, one after the other; each `next` adds one, with the special points before it.

    Between iterations it is paused. If its stop flag is set, it raises `Cancelled` and can be resumed later.
    """

    def __init__(self, equations: BranchEquations, half: HalfBranch) -> None:
        self.equations, self.half = equations, half
        self._ends = Ends(equations, half.points[0])
        self._pool = ThreadPoolExecutor(min(_THREADS, usable_cores()))
        self._known: tuple[BranchPoint, Near] | None = None
        self._go_back(half.step)

    def __next__(self) -> BranchPoint:
        half = self.half
        while not half.ended:
            try:
                while len(self._ahead) < _ORBITS_AHEAD and self._goes_on:
                    self._advance()
                if not self._ahead:
                    self._lose()
                    break
                ahead = self._ahead.popleft()
                try:
                    point, special = ahead.found.result()
                except (ComputationError, np.linalg.LinAlgError) as problem:
                    self._go_back(0.5 * ahead.tried, problem)
                    continue
            except Cancelled:
                self._go_back(half.step)
                raise
            self._add(ahead, point, special)
            return half.points[-1]
        raise StopIteration

    # --- ahead of the half-branch --------------------------------------------------------------------------

    def _go_back(self, step: float, failure: Exception | None = None) -> None:
        """Drop all orbits ahead, and continue from the half-branch's last orbit with this step."""
        self._ahead: deque[_Ahead] = deque()
        self._step, self._failure = step, failure

    @property
    def _goes_on(self) -> bool:
        return self._step >= SHORTEST_STEP and not (self._ahead and self._ahead[-1].ending.ended)

    @property
    def _last_two(self) -> list[BranchPoint]:
        """The last two orbits, or the starting orbit alone."""
        return [*self.half.points[-2:], *(ahead.ending.point for ahead in self._ahead)][-2:]

    def _advance(self) -> None:
        """Compute the next orbit ahead; halve the step if it is too long."""
        last, tried = Ending(self._last_two[-1], self._near_last), self._step
        try:
            ending, contact_events = self._next_orbit(last)
        except (ComputationError, np.linalg.LinAlgError) as problem:
            self._step, self._failure = 0.5 * tried, problem
            return
        before = self._ahead[-1].found if self._ahead else last.point
        completed = self._pool.submit(self._completed, before, ending.point, contact_events, (last.near, ending.near))
        self._ahead.append(_Ahead(ending, tried, self._step, completed))

    def _completed(self, before: BranchPoint | Future[tuple[BranchPoint, list[SpecialPoint]]], point: BranchPoint,
                   contact_events: np.ndarray | None,
                   near: tuple[Near, Near]) -> tuple[BranchPoint, list[SpecialPoint]]:
        """The orbit with its forces and contacts, and the special points between the orbit before and this one."""
        last = before.result()[0] if isinstance(before, Future) else before
        if contact_events is not None:
            point = recorded(self.equations, point, contact_events)
        between = Between(self.equations, last, point, near)
        return point, with_normal_forms(special_between(between), between)

    @property
    def _near_last(self) -> Near:
        """Φ_x and Φ_ζ at the last orbit. Where Φ_x is not known, it is computed again, bit for bit the same."""
        if self._ahead:
            return self._ahead[-1].ending.near
        last = self.half.points[-1]
        if self._known is None or self._known[0] is not last:
            self._known = last, Near(self.equations.stroboscopic_map(last.knob)(last.x).derivative, last.slope)
        return self._known[1]

    def _next_orbit(self, last: Ending) -> tuple[Ending, np.ndarray | None]:
        """Compute the next orbit (with the reason, if the branch ends there) and its contact events; set the next step.

        The contact events are None if the orbit's forces and contacts are already known. Raises `ComputationError` if
        the step is too long.
        """
        equations, step, before = self.equations, self._step, last.point
        guess = predicted(step, self._z(before), before.tangent, self._before_last)
        solved = equations.solve_near(guess, before.tangent, last.near, LARGEST_CORRECTION * step)
        self._refuse_shorter(solved)
        tangent = equations.tangent(solved, before.tangent)
        cosine = float(tangent @ before.tangent)
        if cosine < LEAST_COSINE:
            turn = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
            raise ComputationError(f"the branch turns by {turn:.0f}° in one step", "no-convergence")
        chord = float(np.linalg.norm(solved.z - self._z(before)))
        beyond = Ending(unrecorded(equations, solved, tangent, before.arclength + chord), solved.near)
        may_close = len(self.half.points) + len(self._ahead) >= _POINTS_BEFORE_CLOSING
        ending = self._ends.of_step(last, beyond, solved.z, may_close)
        off = float(np.linalg.norm(solved.z - guess))
        self._step, self._failure = next_step(step, off, cosine, self._failure is not None), None
        return ending, solved.flow.contact_events if ending is beyond else None

    @property
    def _before_last(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Point and tangent of the last orbit but one; None at the starting orbit."""
        before = self._last_two[:-1]
        return (self._z(before[0]), before[0].tangent) if before else None

    # --- the half-branch -----------------------------------------------------------------------------------

    def _add(self, ahead: _Ahead, point: BranchPoint, special: list[SpecialPoint]) -> None:
        """Add an orbit and the special points before it to the half-branch, and end it at a merging."""
        half, ended, reason = self.half, ahead.ending.ended, ahead.ending.reason
        merging = self._ends.merging(special)
        if merging is not None:
            special, point = special[: merging + 1], special[merging].before
            special[merging] = replace(special[merging], kind="period_doubling", normal_form=None)
            ended = "merged"
            reason = (f"merged with the branch of period {self.equations.period // 2}, whose period doubles at "
                      f"{self.equations.axis.text(special[merging].knob)}: beyond it are the same orbits, half a "
                      "period later")
        half.special.extend(special)
        if point is not half.points[-1]:
            half.points.append(point)
            self._known = point, ahead.ending.near
        half.step, half.ended, half.reason = ahead.step, ended, reason

    def _lose(self) -> None:
        last, half = self.half.points[-1], self.half
        singular = isinstance(self._failure, np.linalg.LinAlgError)
        failure = ("the equations became singular" if singular else
                   "it bends ever more sharply" if self._failure is None else str(self._failure))
        half.step, half.ended = self._step, "lost"
        half.reason = (f"the branch could not be followed beyond {self.equations.axis.text(last.knob)} although "
                      f"steps were shortened to {SHORTEST_STEP:g}: {failure.rstrip('.')}; residuals at the last orbit: "
                      f"{formatted(last.residuals)}")

    def _refuse_shorter(self, solved: Solved) -> None:
        """Raise `ComputationError` for an orbit of another branch, whose period is a fraction of this one's."""
        n = self.equations.period
        x, value = self.equations.state(solved.z), self.equations.value(solved.z)
        least_period = self.equations.least_period(x, value, _SHORTER_PERIOD_DISTANCE)
        if least_period < n:
            raise ComputationError(f"the step leads to an orbit that repeats after {least_period} of {n} drive periods",
                                   "no-convergence")

    def _z(self, point: BranchPoint) -> np.ndarray:
        return self.equations.point(point.x, point.knob)
