"""Many steady states in batches: settle with coarse steps, then with fine ones; the difference is the error.

Every scene becomes a member of a batch, with coarse steps. Once its regime is decided, the next takes its place.

Coarse run: `check_coarse` (kernels/batch/period_end.py) bounds the distance to the orbit; an orbit that was reached by
extrapolation (kernels/strobes/extrapolation.py) must survive a disturbance. Finer run, a third of the step:
`check_fine`, until that bound is small or six extrapolations are spent; what is left goes into the stated error, with
the change of the forces. Motions that are not periodic are classified by their Lyapunov exponents, twice, as many at a
time as there are pairs of members. What is still undecided is marked `doubtful` and settled alone
(settling/single_chain.py).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...integrate.batch import Batch
from ...kernels.width import BATCH_SIZE
from ...regime import Regime
from ...scaling import scale_chain, scale_like
from ...scene import Scene
from ...scene.driven import refuse_undriven
from ...state import rest
from ...stop import Stop
from ..lyapunov import MOST_APART, exponents_in_pairs
from ..regime_criteria import agree, clearly_chaotic, find_period, regime_from_exponents, undecided
from ..settling.nearby_orbit import MOST_BEADS_WITH_MULTIPLIERS, seen_modulus
from ..settling.regime_decisions import EXAMINED_AFTER, EXPONENT_BLOCKS, MOST_PERIODS, PERIODS_IN_BLOCK, REMEMBERED
from ..steady_state import SteadyState
from .job import FINER, Job, Start, draft_result, failed, outcome_of_coarse_run

#: Periods after which a draft gives up.
_DRAFT = 300
#: Decay per orbit above which an orbit found by extrapolation needs its multipliers.
_SLOW_DECAY = 0.998
#: Largest |μ|, by one-sided differences, that settles it.
_SURE = 0.995
#: Scenes whose exponents are found at once.
_PAIRS = BATCH_SIZE // 2


class _JobsInBatch:
    """A batch with the jobs of its members, those waiting for a place and those whose regime is in doubt."""

    def __init__(self, first: Start, starts: Iterator[Start], stop: Stop, draft: bool) -> None:
        self.batch = Batch(first.scene, stop)
        self.pairs: Batch | None = None
        self.draft = draft
        self.stop = stop
        self.latest = self.batch.example
        self.starts = itertools.chain([first], starts)
        self.waiting: list[Job] = []
        self.jobs: dict[int, Job] = {}
        self.left: set[int] = set()
        self.doubtful: list[Job] = []

    def fill(self) -> None:
        """Put jobs into all free places; those for which there is none are left empty."""
        for member in range(BATCH_SIZE):
            if member not in self.jobs:
                job = self.waiting.pop() if self.waiting else self._next_job()
                if job is not None:
                    self.jobs[member] = job
                    self._start(member, job)
                elif member in self.left:
                    self.batch.empty(member)
                self.left.discard(member)

    def _next_job(self) -> Job | None:
        """The job of the next start, if there is one."""
        start = next(self.starts, None)
        if start is None:
            return None
        self.latest = scaled = scale_like(self.latest, start.scene)
        state = rest(start.scene) if start.state is None else start.state
        return Job(start.scene, scaled, scaled.from_si(state), number=start.number)

    def _start(self, member: int, job: Job) -> None:
        """The coarse run is checked once it may have settled, the finer one once the difference has decayed."""
        if job.coarse is None:
            look = min(_DRAFT if self.draft else EXAMINED_AFTER, job.affordable_periods - job.run)
            self.batch.put(member, job.scaled, job.y, 1, look)
            return
        regime, maxima = job.coarse
        assert regime.period is not None
        rate = max(1e-3, regime.contraction)
        self.batch.put_fine(member, job.scaled, job.y, FINER, regime.period, rate, maxima)

    def step(self) -> SteadyState | None:
        """Run until a member is due for a check, and check it."""
        member, finite = self.batch.run()
        job = self.jobs[member]
        if not finite:
            self._free(member)
            return failed(job)
        if self.draft:
            result = draft_result(job, self.batch, member)
            self._free(member)
            return result
        coarse = job.coarse is None
        outcome = outcome_of_coarse_run(job, self.batch, member) if coarse else job.fine_result(self.batch, member)
        if outcome is None:
            return None
        self._free(member)
        if isinstance(outcome, SteadyState):
            return confirmed(outcome, self.stop)
        (self.doubtful if outcome.in_doubt else self.waiting).append(outcome)
        return None

    def _free(self, member: int) -> None:
        """Take a job out of its place, which `fill` fills or empties."""
        del self.jobs[member]
        self.left.add(member)

    def undecided(self) -> list[Job]:
        """Doubtful jobs of similar steps a period, one for a pair of members; fewer only if nothing else is to do."""
        jobs = sorted(self.doubtful, key=lambda job: job.steps)
        for i in range(len(jobs) - _PAIRS + 1):
            if jobs[i + _PAIRS - 1].steps <= MOST_APART * jobs[i].steps:
                return jobs[i : i + _PAIRS]
        return [] if self.jobs else [job for job in jobs if job.steps <= MOST_APART * jobs[0].steps]

    def decide(self, jobs: list[Job]) -> Iterator[SteadyState]:
        """Classify doubtful jobs by their Lyapunov exponents; one whose neighbours come closer runs on."""
        self.doubtful = [job for job in self.doubtful if job not in jobs]
        self.pairs = self.pairs or Batch(jobs[0].scene, self.stop)
        found = exponents_in_pairs([(job.scaled, job.y) for job in jobs], EXPONENT_BLOCKS, PERIODS_IN_BLOCK, self.pairs)
        for job, (growth, strobes, maxima, y) in zip(jobs, found, strict=True):
            if not np.isfinite(growth).all():
                yield failed(job)
                continue
            job.run += len(strobes)
            job.y, job.in_doubt = y, False
            regime = replace(find_period(strobes), periods_run=job.run)
            if regime.period is not None:
                job.coarse = (regime, maxima[-regime.period :].max(axis=0))
                self.waiting.append(job)
                continue
            job.record = np.concatenate([job.record, strobes])[-REMEMBERED:]  # as a chain settled alone is judged
            growth, job.blocks = np.concatenate([job.blocks, growth]), np.zeros(0)
            if undecided(growth) and job.run < MOST_PERIODS and job.affordable:
                job.blocks, job.in_doubt = growth, True
                self.doubtful.append(job)
                continue
            regime, before = regime_from_exponents(growth, job.record, job.run), job.measured
            if before is None and regime.name != "unsettled" and not clearly_chaotic(growth):
                job.measured, job.in_doubt = regime, True
                self.doubtful.append(job)
            elif regime.name == "unsettled" and growth.mean() < 0.0 and job.run < MOST_PERIODS and job.affordable:
                self.waiting.append(job)
            else:
                reported, clear = decided(regime, before, clearly_chaotic(growth))
                yield SteadyState(job.scene, job.maxima, reported, None, job.scaled.to_si(y), number=job.number,
                                  doubtful=not clear and job.affordable)


def decided(regime: Regime, before: Regime | None, sure: bool) -> tuple[Regime, bool]:
    """The regime to report after a last measurement, and whether it is clear.

    Two measurements that disagree decide nothing, unless the last is `sure` by itself.
    """
    agreed = before is None or agree(regime, before)
    if not agreed and not sure:
        regime = replace(regime, name="unsettled")
    return regime, agreed and regime.name != "unsettled"


def batch_results(scenes: Iterator[Scene], stop: Stop, draft: bool = False) -> Iterator[SteadyState]:
    """Steady states of scenes of one structure and one N, from rest, in the order in which they are decided.

    See `batch_states`.
    """
    return batch_states((Start(scene) for scene in scenes), stop, draft)


def batch_states(starts: Iterator[Start], stop: Stop, draft: bool = False) -> Iterator[SteadyState]:
    """Steady states that starts of one structure and one N lead to, in the order in which they are decided.

    To the last bit, results do not depend on which starts share a batch. A draft ends with the coarse run
    and after few periods: without errors, and motions that are not periodic by then are called unsettled. Raises
    `Cancelled`.
    """
    first = next(starts, None)
    if first is None:
        return
    refuse_undriven(first.scene)
    jobs = _JobsInBatch(first, starts, stop, draft)
    while True:
        jobs.fill()
        undecided = jobs.undecided()
        if undecided:
            yield from jobs.decide(undecided)
        elif not jobs.jobs:
            return
        else:
            result = jobs.step()
            if result is not None:
                yield result


def confirmed(result: SteadyState, stop: Stop) -> SteadyState:
    """The result; an orbit that was extrapolated to and decays slowly is in doubt unless |μ| is clearly below 1."""
    regime, scene = result.regime, result.scene
    slow = regime.followed and (regime.decay or 0.0) > _SLOW_DECAY
    if regime.period is None or not slow or scene.N > MOST_BEADS_WITH_MULTIPLIERS:
        return result
    y = scale_chain(scene).from_si(result.state).reshape(2, -1)
    largest = seen_modulus(scene, regime.period, y[:, 1:-1].ravel(), stop, refine=1.0)
    return result if largest < _SURE else replace(result, doubtful=True)
