"""Many steady states in batches: settle with coarse steps, then with fine ones; the difference is the error.

Every scene becomes a member of a batch, with coarse steps. Once its orbit is found, the member continues with fine
steps, without a return from the kernel. Once its regime is decided, the next scene takes its place.

In the coarse run, `check_coarse` (kernels/batch/checks.py) bounds the distance to the orbit; an orbit that was reached
by extrapolation (kernels/strobes/extrapolation.py) must survive a perturbation. The fine run (kernels/batch/begin.py)
continues with `check_fine` until the bound is small or no extrapolation is left. The remaining distance enters the
stated error, together with the change of the forces. Motions that are not periodic are classified by their Lyapunov
exponents (steady/exponent_measurements.py), measured with a neighbouring trajectory in another lane. A scene that is
still not decided is marked `undecided` and settled alone (settling/single_chain.py).
"""

from __future__ import annotations

import itertools
import math
from bisect import insort
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...execution.stop import Stop
from ...integrate.batch import Batch
from ...integrate.scaling import scale_like
from ...kernels.batch_size import BATCH_SIZE
from ...kernels.strobes.periodicity import LONGEST_PERIOD, SETTLED_DISTANCE
from ...results.regime import Regime
from ...scene import Scene
from ...scene.refusals import refuse_undriven
from ...scene.state import rest
from ..exponent_measurements import MEASURED_PERIODS
from ..lyapunov import growth_of, put_with_neighbour
from ..regime_criteria import converging, find_period
from ..settling.nearby_orbit import is_almost_periodic
from ..settling.regime_decisions import EXAMINED_AFTER, MOST_MEASUREMENTS, MOST_SETTLING_PERIODS, REMEMBERED
from ..steady_state import SteadyState
from .job import (
    FINE_STEPS_PER_COARSE,
    BatchJob,
    LocatedOrbits,
    Stage,
    Start,
    draft_result,
    failed,
    outcome_of_coarse_run,
    take_coarse_orbit,
)

#: [unsettled] Maximum number of drive periods in a draft of a curve.
_DRAFT_PERIODS = 300


class _JobsInBatch:
    """A batch and the jobs in it.

    Attributes
    ----------
    batch : Batch
        The lanes, each with a member or empty.
    draft, stop : bool, Stop
        Whether only coarse runs are wanted; the flag that ends all runs.
    example : ScaledChain
        The chain of the most recent start, from which the chain of the next start is scaled.
    rest_state : np.ndarray
        Scaled state of rest, the same for scenes that differ only in their frequency.
    orbits : LocatedOrbits
        Largest forces with located events.
    starts : iterator of Start
        Starts that are not yet jobs.
    jobs : dict of int to BatchJob
        Jobs by the lane of their member.
    neighbours : dict of int to int
        Lane of the neighbouring trajectory, by the lane of the member whose exponent is measured.
    waiting, to_measure : list of BatchJob
        Jobs that wait for one lane; jobs that wait for two.
    free, newly_free : list of int, set of int
        Free lanes; the free lanes that had a member when the batch last ran.
    """

    def __init__(self, first: Start, starts: Iterator[Start], stop: Stop, draft: bool) -> None:
        self.batch = Batch(first.scene, stop)
        self.draft = draft
        self.stop = stop
        self.example = self.batch.example
        self.rest_state = self.example.from_si(rest(first.scene))
        self.orbits = LocatedOrbits(self.example, stop)
        self.starts = itertools.chain([first], starts)
        self.waiting: list[BatchJob] = []
        self.jobs: dict[int, BatchJob] = {}
        self.free = list(reversed(range(BATCH_SIZE)))
        self.newly_free = set[int]()
        self.neighbours: dict[int, int] = {}
        self.to_measure: list[BatchJob] = []

    def fill(self) -> None:
        """Put jobs into the free lanes.

        A job to be measured takes two lanes. If such a job waits and only one lane is free, this lane stays empty until
        another one becomes free.
        """
        while self.free and not self._waits_for_second_lane:
            job = (self.to_measure.pop(0) if self.to_measure else
                   self.waiting.pop() if self.waiting else self._next_job())
            if job is None:
                break
            member = self.free.pop()
            self.jobs[member] = job
            self._start(member, job)
        for member in self.newly_free & set(self.free):
            self.batch.empty(member)
        self.newly_free.clear()

    @property
    def _waits_for_second_lane(self) -> bool:
        """Whether a free lane is reserved for a job that needs two."""
        return bool(self.to_measure) and len(self.free) < 2

    def _next_job(self) -> BatchJob | None:
        """The job of the next start, or None after the last one."""
        start = next(self.starts, None)
        if start is None:
            return None
        before, self.example = self.example, scale_like(self.example, start.scene)
        if self.example.slots.chain is not before.slots.chain:
            self.rest_state = self.example.from_si(rest(start.scene))
        y = self.rest_state if start.state is None else self.example.from_si(start.state)
        return BatchJob(start.scene, self.example, y, number=start.number)

    def _start(self, member: int, job: BatchJob) -> None:
        """Make a job a member.

        A coarse run is due after at most `EXAMINED_AFTER` periods, and a fine run once the difference has decayed. A
        job whose exponent is measured gets a neighbour.
        """
        if job.stage is Stage.EXPONENT:
            neighbour = self.neighbours[member] = self.free.pop()
            put_with_neighbour(self.batch, member, neighbour, job.scaled, job.y, MEASURED_PERIODS,
                               job.measurements.offset)
            return
        if job.stage is Stage.COARSE:
            return_at = min(_DRAFT_PERIODS if self.draft else EXAMINED_AFTER, job.affordable_periods - job.periods_run)
            self.batch.put(member, job.scaled, job.y, 1, return_at, fine=0 if self.draft else FINE_STEPS_PER_COARSE)
            return
        assert job.coarse is not None
        regime, maxima = job.coarse
        assert regime.period is not None
        self.batch.put_fine(member, job.scaled, job.y, FINE_STEPS_PER_COARSE, regime.period,
                            regime.observed_contraction or 0.0, maxima)

    def step(self) -> SteadyState | None:
        """Run until a member is due; return its result, or None if its job continues."""
        member, finite = self.batch.run()
        job = self.jobs[member]
        measured = job.stage is Stage.EXPONENT
        if job.stage is Stage.COARSE and self.batch.is_fine(member):
            take_coarse_orbit(job, self.batch, member)
        if not finite or (measured and np.isnan(self.batch.growth(member)).any()):
            self._free(member)
            return failed(job)
        if measured:
            result = self._decide_by_exponent(job, member)
            self._free(member)
            return result
        if self.draft:
            result = draft_result(job, self.batch, member)
            self._free(member)
            return result
        outcome = (outcome_of_coarse_run(job, self.batch, member) if job.stage is Stage.COARSE else
                   job.fine_result(self.batch, member, self.orbits))
        if outcome is None:
            return None
        self._free(member)
        if isinstance(outcome, SteadyState):
            return outcome
        self._measure(outcome)
        return None

    def _free(self, member: int) -> None:
        """Remove a job from its lanes; `fill` gives these lanes to other jobs or empties them."""
        del self.jobs[member]
        lanes = [member, self.neighbours.pop(member)] if member in self.neighbours else [member]
        self.free += lanes
        self.newly_free.update(lanes)

    def _decide_by_exponent(self, job: BatchJob, member: int) -> SteadyState | None:
        """The result of a job whose Lyapunov exponents were measured, or None if the job continues."""
        growth = growth_of(self.batch, member)
        job.periods_run += len(growth.strobes)
        job.y, job.stage = growth.y, Stage.COARSE
        job.record = np.concatenate([job.record, growth.strobes])[-REMEMBERED:]  # as for a chain settled alone
        regime = replace(find_period(job.record), periods_run=job.periods_run)
        if regime.period is not None:
            if regime.period > LONGEST_PERIOD:
                return self._measured_result(job, Regime.unsettled(job.periods_run), undecided=True)
            job.stage, job.coarse = Stage.FINE, (regime, growth.maxima[-regime.period :].max(axis=0))
            self.waiting.append(job)
            return None
        goes_on = job.periods_run < MOST_SETTLING_PERIODS and job.affordable
        decided = job.measurements.add(growth.growth, growth.offset, job.record, job.periods_run, last=not goes_on)
        latest = job.measurements.latest
        if decided is not None:
            near_an_orbit = decided.name == "quasi-periodic" and is_almost_periodic(job.record)
            return self._measured_result(job, decided, undecided=near_an_orbit)
        if latest is None or len(job.measurements.unfinished):
            self._measure(job)
            return None
        approach_rate = job.measurements.approach_rate
        comes_in_time = approach_rate * (MOST_SETTLING_PERIODS - job.periods_run) > -math.log(SETTLED_DISTANCE)
        if goes_on and (comes_in_time or converging(job.record)):
            job.measurements.interrupted()
            self.waiting.append(job)  # the motion reaches its orbit or closed curve within the budget
            return None
        if approach_rate == 0.0 and job.measurements.complete < MOST_MEASUREMENTS:
            self._measure(job)
            return None
        return self._measured_result(job, replace(latest, name="unsettled"), undecided=True)

    def _measured_result(self, job: BatchJob, regime: Regime, undecided: bool) -> SteadyState:
        """The result of a job whose exponents were measured; it is final once the budget of steps is used up."""
        return SteadyState(job.scene, maxima=job.maxima, regime=regime, errors=None, state=job.scaled.to_si(job.y),
                           number=job.number, undecided=undecided and job.affordable)

    def _measure(self, job: BatchJob) -> None:
        """Queue a job for two lanes, behind jobs with at least as many steps per period: the longest start first."""
        job.stage = Stage.EXPONENT
        insort(self.to_measure, job, key=lambda one: -one.steps)


def batch_results(scenes: Iterator[Scene], stop: Stop, draft: bool = False) -> Iterator[SteadyState]:
    """Yield the steady states from rest of scenes of one structure and one N, in the order in which they are decided.

    See `batch_states`.
    """
    return batch_states((Start(scene) for scene in scenes), stop, draft)


def batch_states(starts: Iterator[Start], stop: Stop, draft: bool = False) -> Iterator[SteadyState]:
    """Yield the steady states reached from starts of one structure and one N, in the order in which they are decided.

    Results do not depend on which starts share a batch, to the last bit. A draft is the coarse run alone, over few
    periods: its results have no errors, and a motion that is not periodic by then is called unsettled. Raises
    `Cancelled`.
    """
    first = next(starts, None)
    if first is None:
        return
    refuse_undriven(first.scene)
    jobs = _JobsInBatch(first, starts, stop, draft)
    jobs.fill()
    while jobs.jobs:
        result = jobs.step()
        if result is not None:
            yield result
        jobs.fill()
