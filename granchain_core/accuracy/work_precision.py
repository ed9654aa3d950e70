"""Work and precision: error against time for every method and setting, and the error of the reference.

The reference is dop853 at its finest setting. The second reference, SciPy's DOP853 restarted wherever a contact opens
or closes, shares only the equations with it. The difference between the two measures the error of the reference.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..errors import BadInput, Cancelled, ComputationError
from ..execution.stop import Stop
from ..integrate import METHODS, Engine, MethodSetting, dop853_setting
from ..integrate.stated import relative_difference
from ..scene import Scene
from .compared_methods import SCIPY, MeasuredSetting, measured_settings
from .limit import Limited
from .measurements import Row, WorkPrecision
from .naive import naive_comparison
from .scipy_methods import solve

#: Drive periods run from rest; without a drive, a single time 1/f.
PERIODS = 10
#: Samples per period at which displacements are compared.
SAMPLES = 16
#: The reference, and the SciPy solver and tolerance that check it.
_REFERENCE = dop853_setting(3e-15)
_SECOND = ("DOP853", 1e-14)
#: Time after which a setting is abandoned [s].
_ROW_LIMIT = 8.0
#: Time after which a reference is abandoned [s].
_REFERENCE_LIMIT = 60.0
#: A setting is repeated for this time [s]. The fastest run counts, so that neither compiling nor another process is
#: measured.
_ENOUGH = 0.05
#: Maximum number of runs of one setting.
_MOST_RUNS = 9
#: A setting that takes longer than this is run once [s].
_SLOW = 0.5
#: A setting that takes less than this is measured again in a second round, seconds after the first, because another
#: process may have been busy during all of the first runs [s].
_BRIEF = 0.1


class Computed(NamedTuple):
    """One computation: displacements in scaled units, evaluations, and seconds."""

    displacement: np.ndarray
    rhs: int
    seconds: float


Measure = Callable[[Stop], Computed]


def work_precision(scene: Scene, stop: Stop | None = None, progress: Callable[[float], None] | None = None,
                   report: Callable[[WorkPrecision], None] | None = None,
                   pause: Callable[[], None] | None = None) -> WorkPrecision:
    """Measure work-precision data of one scene on this machine: error against time for every method.

    Parameters
    ----------
    scene : Scene
        The chain; it is run for ten drive periods from rest.
    stop : Stop, optional
        Ends the measurement when another thread sets it.
    progress : callable, optional
        Called with the fraction that is done, 0 to 1.
    report : callable, optional
        Called with the growing result after each part.
    pause : callable, optional
        Called before each part; it may wait, so that nothing is timed meanwhile.

    Returns
    -------
    WorkPrecision
        A row for every method and setting, and the references with which they are compared. Its JSON keys are those of
        `granchain accuracy --json`.

    Raises
    ------
    ComputationError
        The reference cannot be computed.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene, work_precision
    >>> found = work_precision(scene("sec2").evolve(N=1, f=3000.0))
    >>> found.agreement < 1e-9, found.cheapest(1e-4).error <= 1e-4
    (True, True)
    """
    stop = Stop() if stop is None else stop
    settings = list(measured_settings())
    parts = 2 * len(settings) + 3
    comparison = WorkPrecision(scene, f"dop853 with located events, tolerance {_REFERENCE.tolerance:g}",
                               f"SciPy DOP853, restarted at contact events, tolerance {_SECOND[1]:g}")
    for done, _ in enumerate(_measured_parts(comparison, settings, stop), start=1):
        if report is not None:
            report(comparison)
        if progress is not None:
            progress(done / parts)
        if pause is not None:
            pause()
        if stop:
            raise Cancelled
    return comparison


def _measured_parts(comparison: WorkPrecision, settings: Sequence[MeasuredSetting], stop: Stop) -> Iterator[None]:
    """Fill in the comparison, yielding after each part.

    The parts are the reference, the naive methods, each setting in two rounds, and the second reference.
    """
    scene = comparison.scene
    compile_methods(scene.evolve(f=max(scene.f, 1000.0)))  # otherwise a method's first row would include compiling
    exact = _within("The reference", stop, _REFERENCE_LIMIT, lambda stop: _ours(scene, _REFERENCE, stop)).displacement
    yield
    comparison.naive = naive_comparison(scene, stop)
    yield
    for setting in settings:
        comparison.rows.append(_row(scene, setting, exact, stop))
        yield
    for number, setting in enumerate(settings):
        comparison.rows[number] = _faster(comparison.rows[number], scene, setting, exact, stop)
        yield
    try:
        second = _within("It", stop, _REFERENCE_LIMIT, lambda stop: _scipys(scene, *_SECOND, stop, located=True))
        comparison.agreement = _distance(second.displacement, exact)
    except ComputationError as problem:
        comparison.disagreement = problem.sentence
    yield


def compile_methods(scene: Scene) -> None:
    """Compile every method's kernels for the scene's structure, or load them from the cache, by a short run."""
    for name in METHODS:
        with contextlib.suppress(BadInput):  # the rows of a method that cannot compute this chain say so
            Engine(scene, MethodSetting(name, tolerance=1e-3), 2).record(2)


def _row(scene: Scene, choice: MeasuredSetting, exact: np.ndarray, stop: Stop) -> Row:
    """Measure one setting; a failure is recorded in its row."""

    def measure(limit: Stop) -> Computed:
        if choice.setting is not None:
            return _ours(scene, choice.setting, limit)
        return _scipys(scene, choice.method.removeprefix(SCIPY), choice.value, limit)

    try:
        best = _fastest(stop, measure)
    except (ComputationError, BadInput) as problem:
        return Row(choice.method, setting=choice.label, error=float("inf"), wall_s=0.0, rhs=0, value=choice.value,
                   failure=str(problem))
    return Row(choice.method, setting=choice.label, error=_distance(best.displacement, exact), wall_s=best.seconds,
               rhs=best.rhs, value=choice.value)


def _faster(before: Row, scene: Scene, choice: MeasuredSetting, exact: np.ndarray, stop: Stop) -> Row:
    """Return the better of a brief row and its second measurement; a long row or a failure is returned unchanged."""
    if before.failure or before.wall_s > _BRIEF:
        return before
    again = _row(scene, choice, exact, stop)
    return again if again.wall_s < before.wall_s and not again.failure else before


def _fastest(stop: Stop, measure: Measure) -> Computed:
    """Return the fastest of several runs; a slow setting is run only once or twice."""
    runs: list[Computed] = []
    while len(runs) < _MOST_RUNS:
        runs.append(_within("It", stop, _ROW_LIMIT, measure))
        spent = sum(run.seconds for run in runs)
        if spent > _ENOUGH and (len(runs) > 1 or spent > _SLOW):
            break
    return min(runs, key=lambda run: run.seconds)


def _within(what: str, stop: Stop, seconds: float, measure: Measure) -> Computed:
    """Run `measure` with a flag that is also set after `seconds`; that counts as a failure, not as a cancellation."""
    try:
        with Limited(stop, seconds) as limit:
            return measure(limit.stop)
    except Cancelled:
        if stop:
            raise
        raise ComputationError(f"{what} was not done after {seconds:g} s and was stopped.", "too-slow") from None


def _periods(scene: Scene) -> int:
    return PERIODS if scene.is_driven else 1


def _ours(scene: Scene, setting: MethodSetting, stop: Stop) -> Computed:
    """Compute the motion with one of granchain's methods, and its processor time."""
    engine = Engine(scene, setting, SAMPLES, stop=stop)
    began = time.thread_time()
    moved = engine.record(_periods(scene) * SAMPLES).displacement
    return Computed(moved, engine.counts.rhs, time.thread_time() - began)


def _scipys(scene: Scene, solver: str, tolerance: float, stop: Stop, located: bool = False) -> Computed:
    """Compute the motion with one of SciPy's solvers, and its processor time."""
    began = time.thread_time()
    moved, counts = solve(scene, solver, tolerance, _periods(scene), SAMPLES, stop, located)
    return Computed(moved, counts.rhs, time.thread_time() - began)


def _distance(moved: np.ndarray, exact: np.ndarray) -> float:
    """Return the largest displacement error over the largest displacement; infinite if the method did not reach the
    end.
    """
    if not np.isfinite(moved).all():
        return float("inf")
    return relative_difference(exact, moved)
