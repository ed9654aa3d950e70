"""`run`: discarded and recorded periods of a motion, to the requested accuracy.

Every accuracy is verified by comparing two computations, and never trusted because of a tolerance.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..execution.stopwatch import Stopwatch
from ..inputs.checks import seconds_allowed, whole_number
from ..integrate import Counts, Engine, MethodSetting, following_setting, method_for
from ..integrate.methods import setting_of
from ..integrate.stated import StatedErrors, force_differences, least_errors, relative_difference
from ..kernels.samples import Samples
from ..results.recorded_motion import MOST_RECORDED, MOST_SAMPLES
from ..results.regime import Regime
from ..results.run import Cost, Run, residual, run_from, start_words
from ..scene import Scene
from ..scene.refusals import require_scene
from ..scene.state import State, checked_start, rest
from ..scene.validity import overlap_warnings
from ..steady.regime_criteria import find_period
from ..steady.settling.regime_decisions import REMEMBERED, regime_without_continuing
from .budget import BUDGET, check_budget
from .run_checkpoints import Reached, RunCheckpoints

#: [no threshold] Maximum number of drive periods of one run.
MOST_RUN_PERIODS = 10_000_000
#: [no threshold] Stated error above which a motion may be chaotic: finer computations then do not help.
_CHAOS_SUSPECTED_ABOVE = 0.3
#: [no threshold] A motion that may be chaotic is refined until its energy residual is below this factor times the
#: accuracy: energies are quadratic.
_RESIDUAL_PER_ACCURACY = 10.0
#: [no threshold] Expected time of the next finer computation over that of the last one.
_REFINED_COST_RATIO = 2.0
#: [all] `run`: fewest drive periods after which multipliers or a Lyapunov exponent are computed. A shorter run is
#: classified by its strobes alone.
_FEWEST_PERIODS_CLASSIFIED = 40


@dataclass(eq=False)
class _Attempt:
    """One computation of the whole motion."""

    engine: Engine
    samples: Samples
    strobes: np.ndarray


def run(scene: Scene, periods: int = 100, record: int = 20, samples: int = 96, method: str | None = None,
        start: State | None = None, stop: Stop | None = None,
        progress: Callable[[float], None] | None = None, budget: float = BUDGET,
        kept: RunCheckpoints | None = None) -> Run:
    """Run a chain through discarded and recorded drive periods, to the accuracy that its scene requests.

    The motion is computed twice, the second time finer; the stated error is derived from their largest difference
    (integrate/stated.py). As long as it is above the requested accuracy, a still finer computation follows
    (docs/accuracy.md, "Accuracy is measured, not trusted").

    Parameters
    ----------
    scene : Scene
        The chain; `scene.accuracy` is the requested relative error of the displacements.
    periods : int
        Number of drive periods that are run and discarded.
    record : int
        Number of drive periods that are recorded.
    samples : int
        Samples per period; both ends are recorded, so there are record · samples + 1 rows.
    method : str, optional
        Name of a method in `integrate.METHODS`; by default it is chosen from the accuracy.
    start : State, optional
        Where the motion starts; by default at rest, or with the scene's initial velocities.
    stop : Stop, optional
        Ends the computation when another thread sets it.
    progress : callable, optional
        Called with the completed fraction of the current computation, 0 to 1; each finer computation starts again at 0.
    budget : float
        Time that the run may take [s]; compilation does not count.
    kept : RunCheckpoints, optional
        Checkpoints on disk of a run that starts at phase 0: the run continues from them and adds to them
        (runs/run_checkpoints.py).

    Returns
    -------
    Run
        The recorded motion. Its `status` is "done", "accuracy-not-reached" if no finer computation came near enough
        (chaos magnifies every error), or "over-budget" if the next finer one would take too long.

    Raises
    ------
    BadInput
        A number of periods or samples is not a whole number or is out of range, or there is no such method.
    OverBudget
        Even the first computations would take longer than `budget`; `OverBudget` is a `BadInput`.
    ComputationError
        The motion is no longer finite, a step has shrunk to nothing, a period takes millions of steps, or contacts open
        and close while no time passes (chatter); the message says when and why.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import run, scene
    >>> result = run(scene("sec2").evolve(N=2, f=2000.0), periods=60, record=2, samples=8)
    >>> result.status, result.regime.name, result.regime.period
    ('done', 'periodic', 1)
    >>> result.displacement.shape, result.force.shape
    ((17, 2), (17, 3))
    >>> result.displacement_error < 1e-5
    True
    """
    require_scene(scene)
    periods, record, samples = _sizes(scene, periods, record, samples)
    budget = seconds_allowed(budget)
    spent, total = Stopwatch(), Counts()
    stop = Stop() if stop is None else stop
    begin = rest(scene) if start is None else checked_start(scene, start)
    setting = method_for(scene.accuracy, scene.cuts_tension) if method is None else setting_of(method, scene.accuracy)
    check_budget(scene, setting, periods, record, samples, budget)

    number = itertools.count(1)

    def attempt(finer: MethodSetting) -> _Attempt:
        engine = Engine(scene, finer, samples, account=True, stop=stop)
        engine.start(begin)
        reached = kept.begin(next(number), engine) if kept is not None else None
        if reached is None:
            reached = Reached(engine, 0, engine.strobe())
        return _attempt(reached, (periods, record), progress, total, kept)

    last, status, (error, *forces) = _refined(attempt, scene, setting, samples, budget)
    regime = _regime(scene, last, periods + record, stop)
    cost = Cost.of(spent.seconds, total, setting.method)
    first = periods * samples + round(begin.phase * samples)
    return run_from(last.engine, last.samples, first, regime, float(error), cost, status=status,
                    force_errors=np.array(forces), start=start_words(scene, start))


def _refined(attempt: Callable[[MethodSetting], _Attempt], scene: Scene, setting: MethodSetting, samples: int,
             budget: float) -> tuple[_Attempt, str, np.ndarray]:
    """Compute the motion with `setting`, then ever finer; return the last computation, the status, the errors (4,).

    It ends once the error is as small as requested, if finer steps would not help, or before a computation that would
    exceed `budget` seconds.
    """
    spent, errors = Stopwatch(), StatedErrors(scene.cuts_tension)
    errors.begin(setting)
    before = attempt(setting)
    while True:
        setting, lap = setting.finer_than(before.engine.scaled, samples), Stopwatch()
        now = attempt(setting)
        errors.add(setting, now.engine.counts.steps, _differences(now, before), _least(now, setting))
        error = float(errors.stated[0])
        if error <= scene.accuracy:
            return now, "done", errors.final(done=True)
        left = residual(now.samples.energy, now.engine.scaled.static_energy) or 0.0
        chaotic = error > _CHAOS_SUSPECTED_ABOVE and left <= _RESIDUAL_PER_ACCURACY * scene.accuracy
        if setting.finest or errors.rounded or chaotic:
            return now, "accuracy-not-reached", errors.final(done=False)
        if spent.seconds + _REFINED_COST_RATIO * lap.seconds > budget:
            return now, "over-budget", errors.final(done=False)
        before = now


def _sizes(scene: Scene, periods: int, record: int, samples: int) -> tuple[int, int, int]:
    """Check the three numbers and return them as ints."""
    periods = whole_number("periods =", periods, 0, MOST_RUN_PERIODS)
    record = whole_number("record =", record, 1, MOST_RUN_PERIODS)
    samples = whole_number("samples =", samples, 1, MOST_SAMPLES)
    rows = record * samples * scene.N
    if rows > MOST_RECORDED:
        most = max(1, MOST_RECORDED // (samples * scene.N))
        raise BadInput(f"{record} periods of {samples} samples for {scene.N} beads are {rows:.1e} values; at most "
                       f"{MOST_RECORDED:.0e} are recorded: record {most} periods.")
    return periods, record, samples


def _attempt(reached: Reached, sizes: tuple[int, int], progress: Callable[[float], None] | None, total: Counts,
             kept: RunCheckpoints | None) -> _Attempt:
    (periods, record), engine = sizes, reached.engine
    samples, from_phase_0 = engine.samples, engine.grid_index == 0
    strobes = [reached.strobes]
    chunk = min(max(1, periods // 50), REMEMBERED)
    for done in range(reached.done, periods, chunk):
        now = min(chunk, periods - done)
        if from_phase_0:
            passed, _ = engine.periods(now, watch=False)
        else:
            passed = _strobes(engine.record(now * samples), samples)
        strobes = [*strobes[-REMEMBERED // chunk - 1 :], passed[1:]]
        if kept is not None:
            strobes = [np.concatenate(strobes)[-REMEMBERED - 1 :]]
            kept.add(Reached(engine, done + now, strobes[0]))
        if progress is not None:
            progress(min(done + chunk, periods) / (periods + record))
    engine.begin_record()
    rows = engine.record(record * samples)
    if progress is not None:
        progress(1.0)
    total.array += engine.counts.array
    strobes.append(_strobes(rows, samples)[1:])
    return _Attempt(engine, rows, np.concatenate(strobes)[-REMEMBERED - 1 :])


def _strobes(rows: Samples, samples: int) -> np.ndarray:
    """The states one period apart, (P + 1, 2, N)."""
    return np.stack([rows.displacement[::samples], rows.velocity[::samples]], axis=1)


def _differences(now: _Attempt, before: _Attempt) -> np.ndarray:
    """Relative differences (4,) of the displacements and of the largest input, output and elastic output force.

    The differences of forces include a safety factor.
    """
    jumps = now.engine.scaled.scene.forces_jump
    return np.array([relative_difference(now.samples.displacement, before.samples.displacement),
                     *force_differences(now.engine.maxima, before.engine.maxima, jumps)])


def _least(now: _Attempt, setting: MethodSetting) -> np.ndarray:
    """Lower limits of the stated errors (4,)."""
    engine = now.engine
    step = setting.step(engine.scaled, engine.samples)
    return least_errors(setting, engine.scaled, step, engine.jumps, engine.maxima)


def _regime(scene: Scene, attempt: _Attempt, periods: int, stop: Stop) -> Regime:
    """The regime shown by these periods; a slow motion is classified by multipliers or its Lyapunov exponent."""
    if not scene.is_driven:
        return Regime.undriven(periods)
    noise = min(1e-6, 10.0 * scene.accuracy)  # strobes have the motion's error: up to ten times that is no change
    regime = replace(find_period(attempt.strobes, rounding=noise), periods_run=periods)
    if periods < _FEWEST_PERIODS_CLASSIFIED or attempt.engine.grid_index != 0:
        return regime
    engine = Engine(scene, following_setting(scene.cuts_tension), 1, stop=stop)
    engine.start(attempt.engine.state)
    return regime_without_continuing(engine, attempt.strobes, regime)


def warnings(result: Run) -> list[str]:
    """Sentences about contacts for which the model itself was no longer valid during a run."""
    return overlap_warnings(result.scene, result.overlap.max(axis=0))
