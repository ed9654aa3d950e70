"""Many steady states at once by lanes: settle coarsely, then finely, and let the difference be the error.

Every scene starts in a lane at a coarse step. When its regime is decided its place is filled with the next one; a
periodic scene comes back once more at a third of the step, from where it settled, for as many periods as its decay
needs to forget the coarse orbit. The forces of the finer run are given, with their change as error estimate. What is
not periodic within the budget is told apart by its Lyapunov exponent, as everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..integrate import Engine, Setting, State
from ..integrate.engine import rest
from ..integrate.lane_block import NEVER, LaneBlock, scaled_state, state_of
from ..kernels.lanes import LANES
from ..lower import Lowered, lower
from ..scene import Scene
from .lyapunov import exponents
from .regime import Regime, changes, find_period, irregular, normalised, slowing
from .settle import MOST_PERIODS, MOST_STEPS, SLOW_PERIODS

#: Looks at a slow lane, every so many periods; and blocks and periods a block for the Lyapunov exponent.
_SLOW_CHECK, _BLOCKS, _BLOCK = 400, 10, 20
#: The finer run's steps for one of the coarse run: its force errors are then a tenth of the change between the two,
#: which is what is claimed.
_FINER = 3
#: The coarse orbit's difference is forgotten to this fraction in the finer run.
_FORGET = 0.01
#: The method's order is uneven at contact events, so its error is not taken for less than this times the change.
_CAUTION = 2.0
#: Fewest and most periods of the finer run, in periods of the orbit and of the drive.
_FEWEST, _MOST_FINE = 2, 800
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
class _Job:
    """A scene on its way: `coarse` holds regime and forces of the coarse run while the finer one runs."""

    scene: Scene
    lowered: Lowered
    y: np.ndarray
    coarse: tuple[Regime, np.ndarray] | None = None


def lane_results(scenes: Iterator[Scene], stop: np.ndarray) -> Iterator[LaneResult]:
    """Steady states from rest of scenes of one structure and one N, as they are finished, by one thread."""
    first = next(scenes, None)
    if first is None:
        return
    block = LaneBlock(first, stop)
    waiting: list[_Job] = [_new_job(first)]
    jobs: dict[int, _Job] = {}
    while True:
        for lane in range(LANES):
            if lane not in jobs:
                job = waiting.pop() if waiting else _job_or_none(scenes)
                if job is not None:
                    jobs[lane] = job
                    _start(block, lane, job)
        if not jobs:
            return
        lane, finite = block.run()
        job = jobs[lane]
        if not finite:
            del jobs[lane]
            _idle(block, lane, job)
            yield _failed(job)
            continue
        outcome = _look(block, lane, job)
        if outcome is None:
            continue
        del jobs[lane]
        _idle(block, lane, job)
        if isinstance(outcome, _Job):
            waiting.append(outcome)
        else:
            yield outcome


def _new_job(scene: Scene) -> _Job:
    lowered = lower(scene)
    return _Job(scene, lowered, scaled_state(lowered, rest(scene)))


def _job_or_none(scenes: Iterator[Scene]) -> _Job | None:
    scene = next(scenes, None)
    return None if scene is None else _new_job(scene)


def _start(block: LaneBlock, lane: int, job: _Job) -> None:
    """Put a job into a lane: the coarse run to be looked at when it may have settled, the finer one at its end."""
    if job.coarse is None:
        block.put(lane, job.lowered, job.y, 1, min(MOST_PERIODS, _affordable_periods(job)))
        return
    block.put(lane, job.lowered, job.y, _FINER, _fine_periods(job.coarse[0]), NEVER)


def _affordable_periods(job: _Job) -> int:
    """Periods of the coarse run that the budget of steps allows."""
    return max(2, MOST_STEPS // job.lowered.steps_per_period())


def _idle(block: LaneBlock, lane: int, job: _Job) -> None:
    """Leave a lane at rest with nothing to look at until it is filled again."""
    block.put(lane, job.lowered, np.zeros_like(job.y), 1, NEVER, NEVER)


def _fine_periods(regime: Regime) -> int:
    """Periods until the coarse orbit is forgotten: whole orbits, by the decay rate seen."""
    assert regime.period is not None
    rate = min(0.999, max(1e-3, regime.multiplier or 0.5))
    orbits = max(_FEWEST, math.ceil(math.log(_FORGET) / math.log(rate)))
    return min(orbits, max(_FEWEST, _MOST_FINE // regime.period)) * regime.period


def _look(block: LaneBlock, lane: int, job: _Job) -> LaneResult | _Job | None:
    """A result, the job for the finer run, or None where the lane goes on."""
    run = int(block.state.periods[lane])
    if job.coarse is not None:
        return _finer_result(block, lane, job)
    regime = replace(find_period(block.strobes(lane)), periods_run=run)
    if regime.name == "periodic":
        assert regime.period is not None
        return replace_job(job, block, lane, (regime, block.tops(lane, regime.period)))
    if run >= _affordable_periods(job):
        return _unsettled_result(block, lane, job)
    if run >= MOST_PERIODS and (run >= SLOW_PERIODS or not slowing(block.strobes(lane))):
        return _irregular_result(block, lane, job)
    if run >= block.state.look[lane]:
        block.state.look[lane] = min(run + _SLOW_CHECK, _affordable_periods(job))
    block.state.earliest[lane] = run + max(2, run // 8)
    return None


def replace_job(job: _Job, block: LaneBlock, lane: int, coarse: tuple[Regime, np.ndarray]) -> _Job:
    """The same scene for the finer run, from where the lane is."""
    return _Job(job.scene, job.lowered, block.state.y[:, lane].copy(), coarse)


def _finer_result(block: LaneBlock, lane: int, job: _Job) -> LaneResult:
    assert job.coarse is not None
    regime, before = job.coarse
    assert regime.period is not None and regime.distance is not None
    n, tops = regime.period, block.tops(lane, regime.period)
    change = float(np.abs(tops[1:] - before[1:]).max() / tops[1]) if tops[1] > 0.0 else 0.0
    rate = min(0.999, regime.multiplier or 0.5)
    distance = float(changes(normalised(block.strobes(lane)[-n - 1 :]), n)[-1]) * rate / (1.0 - rate)
    state = state_of(job.lowered, block.state.y[:, lane])
    # F ∝ δ^{3/2}: a relative change of the overlap is half as much again in the force
    error = _CAUTION * change + 1.5 * max(distance, regime.distance)
    return LaneResult(job.scene, tops * job.lowered.scales.force, replace(regime, distance=distance), error, state)


def _irregular_result(block: LaneBlock, lane: int, job: _Job) -> LaneResult | None:
    """Chaotic, quasi-periodic or unsettled, by the live method from where the lane is; None if it should go on."""
    strobes, run = block.strobes(lane), int(block.state.periods[lane])
    engine = Engine(job.scene, Setting("rk4-split"), 1, stop=block.stop)
    engine.start(state_of(job.lowered, block.state.y[:, lane]))
    found, later = exponents(engine, _BLOCKS, _BLOCK)
    regime = find_period(later)
    if regime.name != "periodic":
        regime = irregular(found, strobes, run + len(later))
        if regime.name == "unsettled" and found.mean() < 0.0 and run + _SLOW_CHECK < SLOW_PERIODS:
            block.state.look[lane] = run + 2 * _SLOW_CHECK  # neighbours come closer: give it time
            block.state.earliest[lane] = run + _SLOW_CHECK // 4
            return None
    tops = block.tops(lane, _IRREGULAR_PERIODS) * job.lowered.scales.force
    return LaneResult(job.scene, tops, regime, None, engine.state)


def _unsettled_result(block: LaneBlock, lane: int, job: _Job) -> LaneResult:
    """What a lane has come to when its budget of steps is spent."""
    run = int(block.state.periods[lane])
    tops = block.tops(lane, min(run, _IRREGULAR_PERIODS)) * job.lowered.scales.force
    state = state_of(job.lowered, block.state.y[:, lane])
    return LaneResult(job.scene, tops, Regime("unsettled", None, None, None, run), None, state)


def _failed(job: _Job) -> LaneResult:
    nothing = Regime("unsettled", None, None, None, 0)
    sentence = f"At {job.scene.f:g} Hz the motion stopped being finite; lower the damping or ask for higher accuracy."
    return LaneResult(job.scene, np.full(3, np.nan), nothing, None, rest(job.scene), sentence)
