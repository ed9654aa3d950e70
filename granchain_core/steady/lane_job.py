"""One scene on its way through the lanes: when it is looked at, and what is done with what is seen."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from ..integrate import State
from ..integrate.engine import rest
from ..integrate.lane_block import NEVER, LaneBlock, state_of
from ..kernels.section import window_of
from ..lower import Lowered
from ..scene import Scene
from .extrapolate import ORDER, reduced_rank, within_reach
from .regime import SETTLED_DISTANCE, SLOW_RECORD, Approach, Regime, changes, in_words, slowing
from .settle import MOST_PERIODS, MOST_STEPS, SLOW_PERIODS

#: Fewest periods between two attempts to follow an approach.
_BETWEEN = 8
#: The method's order is uneven at contact events, so its error is not taken for less than this times the change.
_CAUTION = 2.0
#: The coarse orbit's difference is forgotten to this fraction in the finer run.
_FORGET = 0.01
#: Fewest orbits of the finer run, and extrapolations of it at most.
_FEWEST, _MOST_ROUNDS = 2, 6
#: Periods over which the largest force of an irregular motion is taken.
_IRREGULAR_PERIODS = 100


@dataclass(eq=False)
class LaneResult:
    """A steady state found in a lane: largest forces [N] in the order input, output, elastic output."""

    scene: Scene
    tops: np.ndarray
    regime: Regime
    error_estimate: float | None
    state: State
    failure: str = ""


@dataclass(eq=False)
class Job:
    """A scene on its way, from the scaled state y at phase 0, after `run` periods before.

    `coarse` holds regime and forces of the coarse run while the finer one runs, which has been extrapolated `rounds`
    times. `jump` is the state and the change before the last extrapolation of the coarse run, until it has proved
    itself; `wait` is how long after one that did not the next may be tried. A job in doubt carries its record and its
    forces [N].
    """

    scene: Scene
    lowered: Lowered
    y: np.ndarray
    run: int = 0
    coarse: tuple[Regime, np.ndarray] | None = None
    rounds: int = 0
    jump: tuple[np.ndarray, float] | None = None
    wait: int = 2 * _BETWEEN
    in_doubt: bool = False
    record: np.ndarray = field(default_factory=lambda: np.zeros((0, 2, 0)))
    tops: np.ndarray = field(default_factory=lambda: np.zeros(3))

    @property
    def affordable_periods(self) -> int:
        """Periods of the coarse run that the budget of steps allows."""
        return max(2, MOST_STEPS // self.lowered.steps_per_period())

    @property
    def affordable(self) -> bool:
        """Whether the budget of steps allows another long look."""
        return self.run + MOST_PERIODS < self.affordable_periods

    def look_fine(self, block: LaneBlock, lane: int) -> LaneResult | None:
        """The result of the finer run, or None where it goes on."""
        assert self.coarse is not None
        regime, before = self.coarse
        assert regime.period is not None and regime.distance is not None
        n, rate = regime.period, min(0.999, regime.multiplier or 0.5)
        tops = block.tops(lane, n)
        change = float(np.abs(tops[1:] - before[1:]).max() / tops[1]) if tops[1] > 0.0 else 0.0
        distance = float(changes(block.strobes(lane, n + 1), n, 1)[0]) * rate / (1.0 - rate)
        if distance > max(SETTLED_DISTANCE, _FORGET * change) and self.rounds < _MOST_ROUNDS:
            self.rounds += 1
            self._extrapolate(block, lane, Approach(n, rate, distance * (1.0 - rate) / rate))
            block.state.look[lane] = block.state.periods[lane] + fine_look(self)
            block.state.earliest[lane] = NEVER
            return None
        state = state_of(self.lowered, block.state.y[:, lane])
        # F ∝ δ^{3/2}: a relative change of the overlap is half as much again in the force
        error = _CAUTION * change + 1.5 * max(distance, regime.distance)
        tops = tops * self.lowered.scales.force
        return LaneResult(self.scene, tops, replace(regime, distance=distance), error, state)

    def follow(self, block: LaneBlock, lane: int, approach: Approach) -> bool:
        """Put the coarse run where its approach leads, if that is within reach; whether it was."""
        before = block.state.y[:, lane].copy()
        if not self._extrapolate(block, lane, approach):
            return False
        self.jump = (before, approach.change)
        slowest = approach.rate ** (1.0 / approach.period)
        block.state.slowest[lane] = max(block.state.slowest[lane], slowest)
        block.state.ready[lane] = ORDER * approach.period
        return True

    def _extrapolate(self, block: LaneBlock, lane: int, approach: Approach) -> bool:
        """Put the lane where its last strobes lead, if that is within reach; whether it was."""
        n = approach.period
        strobes = block.strobes(lane, ORDER * n + 1)
        if len(strobes) < ORDER * n + 1:
            return False
        states = strobes[::n]
        there = reduced_rank(states.reshape(len(states), -1)).reshape(states.shape[1:])
        largest = np.abs(states).max(axis=(0, 2))[:, None]
        if not within_reach(states[-1] / largest, there / largest, approach.change, approach.rate):
            return False
        row, y = self.lowered.row, np.zeros(2 * self.lowered.row)
        y[1 : row - 1], y[row + 1 : 2 * row - 1] = there
        self.run += int(block.state.periods[lane])
        wait = window_of(n) + n + 1
        block.go_on(lane, y, wait, wait)
        return True


def first_look(job: Job) -> int:
    """Periods until the coarse run is looked at in any case."""
    return min(MOST_PERIODS, job.affordable_periods)


def fine_look(job: Job) -> int:
    """Periods until the coarse orbit is forgotten by the decay rate seen, or until there is enough to extrapolate."""
    assert job.coarse is not None
    regime, _ = job.coarse
    assert regime.period is not None
    rate = min(0.999, max(1e-3, regime.multiplier or 0.5))
    orbits = max(_FEWEST, math.ceil(math.log(_FORGET) / math.log(rate)))
    return min(orbits, ORDER) * regime.period


def look_coarse(job: Job, block: LaneBlock, lane: int) -> LaneResult | Job | None:
    """The job for the finer run or for the Lyapunov exponent, the end of its budget, or None where the lane goes on."""
    here = int(block.state.periods[lane])
    run = job.run + here
    regime, approach = in_words(block.state.seen[lane], run)
    if regime.name == "periodic":
        assert regime.period is not None
        return Job(job.scene, job.lowered, block.state.y[:, lane].copy(), run,
                   (regime, block.tops(lane, regime.period)))
    if job.jump is not None:
        if approach is None or approach.change >= job.jump[1]:
            _take_back(job, block, lane, run)
            return None
        job.jump = None
    if run >= job.affordable_periods:
        return unsettled(job, block, lane, run)
    if run >= MOST_PERIODS and here >= SLOW_RECORD:
        record = block.strobes(lane)
        if run >= SLOW_PERIODS or not slowing(record):
            return _in_doubt(job, block, lane, run, record.copy())
    if approach is not None and here >= block.state.ready[lane] and job.follow(block, lane, approach):
        return None
    block.state.ready[lane] = here + max(_BETWEEN, here // 4)
    if here >= block.state.look[lane]:
        block.state.look[lane] = min(here + MOST_PERIODS, job.affordable_periods - job.run)
    return None


def _take_back(job: Job, block: LaneBlock, lane: int, run: int) -> None:
    """Return to where the last extrapolation began, as it led nowhere nearer, and wait longer with the next."""
    assert job.jump is not None
    job.wait *= 2
    block.go_on(lane, job.jump[0], min(MOST_PERIODS, job.affordable_periods - run), 0)
    block.state.ready[lane] = job.wait
    job.jump, job.run = None, run


def _in_doubt(job: Job, block: LaneBlock, lane: int, run: int, record: np.ndarray) -> Job:
    """The job with what is needed to decide whether it is chaotic, quasi-periodic or on its way."""
    tops = block.tops(lane, _IRREGULAR_PERIODS) * job.lowered.scales.force
    return Job(job.scene, job.lowered, block.state.y[:, lane].copy(), run, in_doubt=True, record=record, tops=tops,
               wait=job.wait)


def unsettled(job: Job, block: LaneBlock, lane: int, run: int) -> LaneResult:
    """What a lane has come to when its budget of steps is spent."""
    tops = block.tops(lane, _IRREGULAR_PERIODS) * job.lowered.scales.force
    state = state_of(job.lowered, block.state.y[:, lane])
    return LaneResult(job.scene, tops, Regime("unsettled", None, None, None, run), None, state)


def failed(job: Job) -> LaneResult:
    """A lane whose numbers stopped being finite."""
    nothing = Regime("unsettled", None, None, None, 0)
    sentence = f"At {job.scene.f:g} Hz the motion stopped being finite; lower the damping or ask for higher accuracy."
    return LaneResult(job.scene, np.full(3, np.nan), nothing, None, rest(job.scene), sentence)
