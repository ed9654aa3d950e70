"""Branches of periodic orbits as results: orbits over a knob, stable or not, with their special points.

    branch = continue_branch(scene("sec2"), "f", 340.0, 60.0)

Fixed points of the n-period stroboscopic map are continued by pseudo-arclength (Keller 1977). A `Continuation` yields
the points one by one. It can be paused at any time, saved, and continued as if it had never stopped.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from ...errors import BadInput
from ...execution.stop import Stop
from ...former_names import with_former_names
from ...inputs.checks import whole_number
from ...scene import Amplitude, Scene
from ...scene.state import State
from ...tables import Labelled, Table, amplitude_attribute, provenance
from ...tables.provenance import Attribute
from ..find_orbit import periodic_orbit
from ..stroboscopic_map import FLOW_METHOD
from ..unit_circle import ON_CIRCLE
from .axis import STATIC_OVERLAP, KnobAxis
from .equations import BranchEquations
from .half_branch import HalfBranch, HalfContinuation
from .point import BranchPoint, branch_point, state_at
from .special import SpecialPoint
from .tables import branch_tables

#: Maximum number of points of one half-branch: a branch that folds without end has to stop somewhere.
MOST_POINTS = 20_000


@with_former_names
@dataclass(frozen=True, eq=False, repr=False)
class Branch(Labelled):
    """A branch of periodic orbits over one knob.

    Attributes
    ----------
    axis : KnobAxis
        The knob, where it starts and where it ends.
    period : int
        Period of its orbits in drive periods.
    half_branches : tuple of HalfBranch
        One or two directions from the same starting orbit; `ended` and `reason` say how each ended.
    period_note : str
        Why period 1 was assumed (`Orbit.period_note`); empty if a period was given or found, and in a branch from a
        file.
    points : list of BranchPoint
        All orbits in their order along the branch.
    special : list of SpecialPoint
        Folds, period doublings, Neimark–Sacker points and grazings, each with the interval that contains it.

    Examples
    --------
    >>> from granchain_core import branch, scene
    >>> found = branch(scene("sec2").evolve(N=2), "f", 2000.0, 2020.0)
    >>> found.half_branches[0].ended, len(found.points) == len(found.column("knob"))
    ('reached', True)
    """

    axis: KnobAxis
    period: int
    half_branches: tuple[HalfBranch, ...]
    period_note: str = ""

    @property
    def scene(self) -> Scene:
        """The chain."""
        return self.axis.scene

    @property
    def varied(self) -> tuple[str, ...]:
        """The knob, and the drive amplitude where it follows the frequency."""
        return (self.axis.knob,) if self.axis.amplitude is None else (self.axis.knob, "A0")

    @property
    def points(self) -> list[BranchPoint]:
        """All orbits in their order along the branch, from the end of the second half-branch to that of the first."""
        first = self.half_branches[0].points
        return first if len(self.half_branches) == 1 else [*reversed(self.half_branches[1].points[1:]), *first]

    @property
    def special(self) -> list[SpecialPoint]:
        """All special points in their order along the branch."""
        first = self.half_branches[0].special
        return first if len(self.half_branches) == 1 else [*reversed(self.half_branches[1].special), *first]

    def column(self, name: str) -> np.ndarray:
        """One attribute of every point as an array, for example "knob" or "stable"."""
        return np.array([getattr(point, name) for point in self.points])

    def state(self, point: BranchPoint) -> State:
        """The state of one of its orbits at drive phase 0 in SI."""
        return state_at(self.axis.scene_at(point.knob), point.x)

    def tables(self) -> tuple[Table, ...]:
        """`branch`, one row per orbit; `special` points; `special_before` and `special_after`, their neighbours."""
        return branch_tables(self.axis, self.half_branches)

    def attributes(self) -> dict[str, Attribute]:
        """Knob, ends and period as JSON, and provenance."""
        header = {"knob": self.axis.knob, "start": self.axis.start, "end": self.axis.end, "period": self.period,
                "arms": [{"direction": half.direction, "step": half.step.hex(), "ended": half.ended,
                          "reason": half.reason} for half in self.half_branches]}
        return {**provenance(self.scene, FLOW_METHOD, None), "branch": json.dumps(header),
                **amplitude_attribute(self.axis.amplitude),
                **({"coordinate": STATIC_OVERLAP} if self.axis.by_overlap else {})}

    def summary(self) -> list[str]:
        """Number of orbits, why the half-branches ended, and the special points."""
        ends = [half.reason or half.ended for half in self.half_branches if half.ended]
        kinds = [f"{point.kind_words} at {self.axis.text(point.knob)}"
                 + (f", {point.criticality_words()}" if point.normal_form and point.kind != "fold" else "")
                 for point in self.special if point.kind != "grazing"]
        grazings = sum(point.kind == "grazing" for point in self.special)
        undamped = [] if all(p.damped for p in self.points) else [
            "without damping stable orbits have their multipliers on the unit circle: a modulus up to "
            f"1 + {ON_CIRCLE:g} counts as on it, and nothing attracts"]
        return [f"{len(self.points)} orbits of period {self.period}, {sum(p.stable for p in self.points)} stable, from "
                f"{self.axis.text(self.axis.start)} towards {self.axis.text(self.axis.end)}",
                *([self.period_note] if self.period_note else []), *ends, *kinds,
                *([f"{grazings} grazings"] if grazings else []), *undamped]


class Continuation(Iterator[BranchPoint]):
    """A branch as it grows: each `next` adds one orbit; `branch` contains those found so far.

    Of two half-branches, the shorter one grows, so they take turns; `run` continues both at once. Iteration may be
    interrupted and resumed at any time. If the stop flag is set, `Cancelled` ends only the current step.

    A half-branch that closes on itself is the whole branch. The other one is dropped once it is as long: only then is
    it certain that it could not have closed with fewer orbits. So the timing of threads does not decide which is kept.
    """

    def __init__(self, branch: Branch, stop: Stop | None = None) -> None:
        self.branch = branch
        self.stop = Stop() if stop is None else stop
        self._continuations = [HalfContinuation(BranchEquations(branch.axis, branch.period, self.stop), half)
                       for half in branch.half_branches]

    def __next__(self) -> BranchPoint:
        while left := [continuation for continuation in self._continuations if self._grows(continuation)]:
            shorter: HalfContinuation = min(left, key=lambda continuation: len(continuation.half.points))
            point = next(shorter, None)
            if point is not None:
                self._drop_double()
                return point
        raise StopIteration

    def run(self, most_points: int = MOST_POINTS, on_point: Callable[[HalfBranch], None] | None = None) -> Branch:
        """Continue all half-branches, each in a thread, to its end or to `most_points` orbits."""

        def follow(continuation: HalfContinuation) -> None:
            while (self._grows(continuation) and len(continuation.half.points) < most_points
                   and next(continuation, None) is not None):
                if on_point is not None:
                    on_point(continuation.half)

        with ThreadPoolExecutor(len(self._continuations)) as pool:
            for future in [pool.submit(follow, continuation) for continuation in self._continuations]:
                future.result()
        self._drop_double()
        return self.branch

    def _grows(self, continuation: HalfContinuation) -> bool:
        """Whether a half-branch grows: it has not ended, and is shorter than every half-branch that has closed."""
        half = continuation.half
        return not half.ended and len(half.points) < min(map(len, self._closed), default=math.inf)

    @property
    def _closed(self) -> list[list[BranchPoint]]:
        return [continuation.half.points for continuation in self._continuations if continuation.half.ended == "closed"]

    def _drop_double(self) -> None:
        """Keep only the half-branch that closed with the fewest orbits (the first if equal), once no other can grow."""
        closed = [half for half in self.branch.half_branches if half.ended == "closed"]
        if closed and not any(self._grows(continuation) for continuation in self._continuations):
            self.branch = replace(self.branch, half_branches=(min(closed, key=lambda half: len(half.points)),))


def begin_branch(scene: Scene, knob: str, start: float, end: float, period: int | None = None,
                 start_state: State | None = None, both: bool = False, stop: Stop | None = None,
                 amplitude: Amplitude | None = None) -> Branch:
    """Find the starting orbit of a branch, from which a `Continuation` can proceed.

    It is the orbit of `period` drive periods at knob = `start` near `start_state`, or near the steady state from
    rest. With `both`, it is the orbit at the scene's own value of the knob, and the branch goes both ways, to `start`
    and to `end`. With `amplitude`, A0 follows f. Raises `BadInput`, `ComputationError` where there is no such orbit,
    and `Cancelled`.
    """
    axis = KnobAxis.of(scene, knob, start, end, amplitude)
    seed_at = float(scene.knobs[knob]) if both else axis.start
    if not axis.contains(seed_at):
        nearest = min(max(seed_at, axis.low), axis.high)
        raise BadInput(f"Both ways begin at the scene's own {axis.text(seed_at)}, which is outside {axis.low:g} to "
                       f"{axis.high:g}; the nearest valid value is {nearest:g}.")
    # refuse a scene whose orbits cannot be computed before it settles
    BranchEquations(axis, 1).stroboscopic_map(seed_at)
    orbit = periodic_orbit(axis.scene_at(seed_at), period, start_state, stop=stop)
    equations = BranchEquations(axis, orbit.period, stop)
    stroboscopic_map = equations.stroboscopic_map(seed_at)
    x = stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(orbit.state))
    _refuse_shorter(equations, x, seed_at)
    return Branch(axis, orbit.period, half_branches_from(equations, x, seed_at, (1, -1) if both else (axis.direction,)),
                  orbit.period_note)


def half_branches_from(equations: BranchEquations, x: np.ndarray, value: float,
                       directions: tuple[int, ...]) -> tuple[HalfBranch, ...]:
    """Half-branches with only their starting orbit, which is the one at the knob's `value` near the scaled state x."""
    fixed = np.zeros(equations.size + 1)
    fixed[-1] = 1.0
    solved = equations.solve(equations.point(x, value), fixed)
    return tuple(
        HalfBranch(direction, [branch_point(equations, solved, equations.tangent(solved, direction * fixed), 0.0)])
        for direction in directions)


def continue_branch(scene: Scene, knob: str, start: float, end: float, period: int | None = None,
                    start_state: State | None = None, both: bool = False, most_points: int = MOST_POINTS,
                    on_point: Callable[[HalfBranch], None] | None = None, stop: Stop | None = None,
                    amplitude: Amplitude | None = None) -> Branch:
    """Continue a periodic orbit over one knob by pseudo-arclength.

    A half-branch ends when the knob reaches `end` or returns to `start`, when the branch closes on itself or merges
    with one of half the period, or when it cannot be continued; `branch.half_branches[0].reason` says which
    (docs/branches.md).

    Parameters
    ----------
    scene : Scene
        The chain; its tension must not be cut.
    knob : str
        A continuous knob, one of `granchain_core.orbits.CONTINUOUS`.
    start, end : float
        Values of the knob in SI between which the branch is followed; the first orbit is at `start`.
    period : int, optional
        Period of the orbits in drive periods. By default that of the steady state at `start`; 1 if that is not
        periodic, or if `start_state` is given. `Branch.period_note` then says why.
    start_state : State, optional
        A state near the first orbit; by default the steady state reached from rest.
    both : bool
        Begin at the scene's own value of the knob and follow both ways, to `start` and to `end`.
    most_points : int
        Maximum number of points per half-branch.
    on_point : callable, optional
        Called with a half-branch each time it has grown.
    stop : Stop, optional
        Ends the computation when another thread sets it.
    amplitude : Amplitude, optional
        The drive amplitude over the frequency, where the knob is "f"; the scene's A0 if not given.

    Returns
    -------
    Branch
        Orbits, multipliers, largest forces and special points.

    Raises
    ------
    BadInput
        The knob is not continuous, or a value is out of range.
    ComputationError
        No starting orbit was found.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import branch, scene
    >>> found = branch(scene("sec2").evolve(N=2), "f", 2000.0, 2020.0)
    >>> found.column("knob")[[0, -1]]
    array([2000., 2020.])
    >>> bool(found.column("stable").all())
    True
    """
    most_points = whole_number("most_points =", most_points, 2, MOST_POINTS)
    begun = begin_branch(scene, knob, start, end, period, start_state, both, stop, amplitude)
    return Continuation(begun, stop).run(most_points, on_point)


def _refuse_shorter(equations: BranchEquations, x: np.ndarray, value: float) -> None:
    """Raise `BadInput` if the orbit has a shorter period than the requested one."""
    n, least_period = equations.period, equations.least_period(x, value)
    if least_period < n:
        raise BadInput(f"The orbit of {n} drive periods found at {equations.axis.text(value)} repeats after "
                       f"only {least_period}; give period {least_period}.")
