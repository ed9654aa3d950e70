"""A scene that is being settled in a batch: when its regime is checked, and what happens next."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field, replace
from enum import Enum

import numpy as np

from ...execution.stop import Stop
from ...integrate import Engine, fixed_step_setting
from ...integrate.batch import Batch
from ...integrate.failure import not_finite
from ...integrate.methods import AT_A_JUMP, typical_error
from ...integrate.scaling import ScaledChain
from ...integrate.stated import relative_changes
from ...kernels.batch.begin import (
    CHECK_COLUMNS,
    CHECK_DISTANCE,
    CHECK_PERIOD,
    ORBIT_PERIODS,
    ORBIT_SLOWEST_CONTRACTION,
)
from ...kernels.forces.peaks import HIGHEST
from ...results.regime import EXTRAPOLATION, SETTLING, Regime
from ...scene import Scene
from ...scene.state import State
from ..exponent_measurements import ExponentMeasurements
from ..orbit_errors import errors_between, errors_of_two_orbits, force_distances
from ..regime_criteria import SLOW_RECORD, converging
from ..settling.advance import MOST_SETTLING_STEPS
from ..settling.nearby_orbit import MOST_BEADS_WITH_MULTIPLIERS, seen_modulus
from ..settling.refine_orbit import FARTHEST_FROM_ORBIT
from ..settling.regime_decisions import EXAMINED_AFTER, MOST_SETTLING_PERIODS
from ..steady_state import IRREGULAR_PERIODS, SteadyState

#: [no threshold] Steps of a batch's fine run per step of the coarse run.
FINE_STEPS_PER_COARSE = 3
#: [no threshold] Setting for the largest forces of an orbit with jumps: finer than in the batch that found the orbit.
_LOCATED_SETTING = fixed_step_setting(8)
#: [period n] A batch: an orbit found by extrapolation needs multipliers if its contraction factor per orbit is above
#: this.
_SLOW_CONTRACTION = 0.998
#: [period n] A batch: an orbit that needs multipliers is accepted if its largest |μ|, by one-sided differences, is
#: below this; otherwise the chain is settled alone. An orbit near which changes grew in the fine run needs them too.
_LARGEST_SURE_MULTIPLIER = 0.995
#: [no threshold] Typical relative error of the fine run.
_FINE_ERROR = typical_error(fixed_step_setting(FINE_STEPS_PER_COARSE))


@dataclass(frozen=True, eq=False)
class Start:
    """A scene to be settled, from rest or from `state` at phase 0; its `number` is returned with the result."""

    scene: Scene
    state: State | None = None
    number: int = 0


class Stage(Enum):
    """The run that a job is in, or waits for."""

    #: The motion with coarse steps, until its regime is decided.
    COARSE = "coarse"
    #: The periodic orbit of the coarse run, with fine steps.
    FINE = "fine"
    #: The motion with coarse steps, along with a neighbouring trajectory, which gives its Lyapunov exponent.
    EXPONENT = "exponent"


@dataclass(eq=False)
class BatchJob:
    """A scene that is being settled, as a member of a batch or waiting for a lane.

    Attributes
    ----------
    scene, scaled : Scene, ScaledChain
        The scene, and its chain in scaled quantities.
    y : np.ndarray
        Scaled state (2(N+2),) at phase 0 from which the motion continues.
    periods_run : int
        Drive periods from the start to `y`.
    stage : Stage
        The run that the job is in, or waits for.
    coarse : tuple of (Regime, np.ndarray) or None
        In the fine stage: regime and scaled largest forces (3,) from the coarse run.
    record : np.ndarray
        The last strobes (P, 2, N), scaled, since a measurement was first due.
    maxima : np.ndarray
        Largest forces (3,) [N] of a motion whose exponent is measured.
    measurements : ExponentMeasurements
        Measurements so far.
    number : int
        Number of its `Start`.
    """

    scene: Scene
    scaled: ScaledChain
    y: np.ndarray
    periods_run: int = 0
    stage: Stage = Stage.COARSE
    coarse: tuple[Regime, np.ndarray] | None = None
    record: np.ndarray = field(default_factory=lambda: np.zeros((0, 2, 0)))
    maxima: np.ndarray = field(default_factory=lambda: np.zeros(3))
    measurements: ExponentMeasurements = field(default_factory=ExponentMeasurements)
    number: int = 0

    @functools.cached_property
    def steps(self) -> int:
        """Steps per period of the coarse run."""
        return self.scaled.steps_per_period()

    @property
    def affordable_periods(self) -> int:
        """Periods of the coarse run that the budget of steps allows."""
        return max(2, MOST_SETTLING_STEPS // self.steps)

    @property
    def affordable(self) -> bool:
        """Whether the budget of steps allows another measurement."""
        return self.periods_run + EXAMINED_AFTER < self.affordable_periods

    def fine_result(self, batch: Batch, member: int, orbits: LocatedOrbits) -> SteadyState:
        """The result of the fine run. Raises `Cancelled`."""
        assert self.coarse is not None
        regime, before = self.coarse
        assert regime.period is not None and regime.distance is not None
        y, distance = batch.state.motion.y[:, member], float(batch.state.search.last_check[member, CHECK_DISTANCE])
        maxima, jumps, unresolved = batch.maxima(member, regime.period)
        farther = max(distance, regime.distance)
        regime = _with_period(regime, int(batch.state.search.last_check[member, CHECK_PERIOD]))
        if not distance <= FARTHEST_FROM_ORBIT:  # settled alone; NaN counts as far
            return SteadyState(self.scene, maxima=self.scaled.scales.forces(maxima),
                               regime=replace(regime, distance=distance), errors=None, state=self.scaled.to_si(y),
                               number=self.number, undecided=True)
        multiplier = self._multiplier(regime, y, batch.grew(member), batch.stop)
        regime = replace(regime, distance=distance, multiplier=multiplier)
        left = force_distances(farther, self.scaled, maxima, y)
        errors = errors_of_two_orbits(relative_changes(maxima, before), _FINE_ERROR, regime.assumed_contraction) + left
        rough = (jumps > AT_A_JUMP * maxima[:2]) | (HIGHEST * unresolved > maxima[:2])
        if rough.any():
            rough = np.append(rough, rough[1])
            located, located_errors = orbits.maxima(self.scaled, y, regime, farther)
            maxima, errors = np.where(rough, located, maxima), np.where(rough, located_errors, errors)
        maxima = self.scaled.scales.forces(maxima)
        undecided = multiplier is not None and multiplier >= _LARGEST_SURE_MULTIPLIER
        return SteadyState(self.scene, maxima=maxima, regime=regime, errors=errors, state=self.scaled.to_si(y),
                           number=self.number, undecided=undecided)

    def _multiplier(self, regime: Regime, y: np.ndarray, grew: bool, stop: Stop) -> float | None:
        """Largest |μ| of an orbit through the scaled state y that attracts slowly, or near which changes `grew`.

        An extrapolation leads to an orbit whether it is stable or not, and one that is stable with coarse steps may be
        unstable with finer ones. None for other orbits, and for chains too long for multipliers. Raises `Cancelled`.
        """
        slow = regime.is_approach and (regime.observed_contraction or 0.0) > _SLOW_CONTRACTION
        if regime.period is None or not (slow or grew) or self.scene.N > MOST_BEADS_WITH_MULTIPLIERS:
            return None
        return seen_modulus(self.scene, regime.period, self.scaled.beads_of(y), stop, refine=FINE_STEPS_PER_COARSE)


class LocatedOrbits:
    """Largest forces on orbits that a batch found, computed with located events.

    A batch steps across events, so its jumps have an error of the order of the step. A second orbit with half the step
    shows how much the forces still change between the batch's orbit and that of this method, and how much they depend
    on the step at a jump, where convergence is uneven.
    """

    def __init__(self, scaled: ScaledChain, stop: Stop) -> None:
        self._scaled, self._stop = scaled, stop

    @functools.cached_property
    def _engines(self) -> list[Engine]:
        """One engine for each of the two step sizes."""
        return [Engine(self._scaled.scene, setting, 1, stop=self._stop, scaled=self._scaled)
                for setting in (_LOCATED_SETTING, _LOCATED_SETTING.finer())]

    def maxima(self, scaled: ScaledChain, y: np.ndarray, regime: Regime,
               distance: float) -> tuple[np.ndarray, np.ndarray]:
        """Largest forces (3,) on the periodic orbit of a chain through its scaled state y, and their relative errors.

        Raises `Cancelled`, `ComputationError`.
        """
        assert regime.period is not None
        for engine in self._engines:
            engine.move(scaled, engine.setting.steps_per_period(scaled, 1))
        coarse, finer = self._engines
        coarse.start_scaled(scaled.beads_of(y))
        first = coarse.advance_and_find_largest(regime.period)
        finer.start_scaled(scaled.beads_of(coarse.y))
        maxima = finer.advance_and_find_largest(regime.period)
        return maxima, errors_between(finer, first, regime.assumed_contraction, distance)


def draft_result(job: BatchJob, batch: Batch, member: int) -> SteadyState:
    """The result of the coarse run alone."""
    periods_run = int(batch.state.record.periods[member])
    period = batch.state.search.last_check[member, CHECK_PERIOD]
    if period <= 0:
        return unsettled(job, batch, member, periods_run)
    search = batch.state.search
    regime = _periodic(search.last_check[member], search.slowest_contraction[member], periods_run)
    maxima = job.scaled.scales.forces(batch.settled_maxima(member, int(period)))
    state = job.scaled.to_si(batch.state.motion.y[:, member])
    return SteadyState(job.scene, maxima=maxima, regime=regime, errors=None, state=state, number=job.number)


def outcome_of_coarse_run(job: BatchJob, batch: Batch, member: int) -> SteadyState | BatchJob | None:
    """Return what follows a coarse run that has not found an orbit.

    This is the result if no steps are left, otherwise a job that measures the exponent, or None if the member
    continues.
    """
    here = int(batch.state.record.periods[member])
    periods_run = job.periods_run + here
    if periods_run >= job.affordable_periods:
        return unsettled(job, batch, member, periods_run)
    record = batch.strobes(member)
    if periods_run >= MOST_SETTLING_PERIODS or (len(record) >= SLOW_RECORD and not converging(record)):
        return _to_measure(job, batch, member, periods_run, record.copy())
    longer = max(EXAMINED_AFTER // 4, SLOW_RECORD - len(record))
    batch.state.schedule.return_at[member] = min(here + longer, job.affordable_periods - job.periods_run)
    return None


def take_coarse_orbit(job: BatchJob, batch: Batch, member: int) -> None:
    """Store the orbit that the coarse run found; the member has run with fine steps since then."""
    row = batch.state.search.coarse_orbit[member]
    job.periods_run += int(row[ORBIT_PERIODS])
    regime = _periodic(row[:CHECK_COLUMNS], row[ORBIT_SLOWEST_CONTRACTION], job.periods_run)
    job.stage, job.coarse = Stage.FINE, (regime, batch.coarse_maxima(member))


def _with_period(regime: Regime, period: int) -> Regime:
    """The regime with this period of its orbit, which divides the one that the coarse run found."""
    if regime.period is None or period == regime.period:
        return regime
    observed = regime.observed_contraction
    contraction = None if observed is None else observed ** (period / regime.period)
    return replace(regime, period=period, observed_contraction=contraction)


def _periodic(check: np.ndarray, slowest_contraction: float, periods_run: int) -> Regime:
    """The periodic regime of a coarse run, from its last check; extrapolations may have led to it."""
    period, contraction, distance = check
    observed = float(contraction) if contraction >= 0.0 else None
    return Regime(name="periodic", period=int(period), observed_contraction=observed, distance=float(distance),
                  periods_run=periods_run, orbit_found_by=EXTRAPOLATION if slowest_contraction > 0.0 else SETTLING)


def _to_measure(job: BatchJob, batch: Batch, member: int, periods_run: int, record: np.ndarray) -> BatchJob:
    """The job whose exponent is measured next."""
    maxima = job.scaled.scales.forces(batch.maxima(member, IRREGULAR_PERIODS)[0])
    y = batch.state.motion.y[:, member].copy()
    return BatchJob(job.scene, scaled=job.scaled, y=y, periods_run=periods_run, stage=Stage.EXPONENT, record=record,
                    maxima=maxima, number=job.number)


def unsettled(job: BatchJob, batch: Batch, member: int, periods_run: int) -> SteadyState:
    """The result of a member that has used up its budget of steps."""
    maxima = job.scaled.scales.forces(batch.maxima(member, IRREGULAR_PERIODS)[0])
    state = job.scaled.to_si(batch.state.motion.y[:, member])
    return SteadyState(job.scene, maxima=maxima, regime=Regime.unsettled(periods_run), errors=None, state=state,
                       number=job.number)


def failed(job: BatchJob) -> SteadyState:
    """The result of a member with numbers that are no longer finite, with the state from which its run started.

    Which bead failed, and when, is found when the chain is settled alone (starts.py).
    """
    failure = not_finite(f"at {job.scene.f:g} Hz", advice="lower the damping")
    return SteadyState(job.scene, maxima=np.full(3, np.nan), regime=Regime.unsettled(job.periods_run), errors=None,
                       state=job.scaled.to_si(job.y), failure=failure, status="not-finite", number=job.number)
