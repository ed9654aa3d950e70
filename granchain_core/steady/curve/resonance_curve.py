"""The resonance curve: largest forces over the drive frequency, point by point, on all cores."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from ...errors import BadInput, Cancelled
from ...execution.stop import Stop
from ...inputs.checks import numbers_in
from ...integrate.batch import can_share_batch
from ...scene import Amplitude, Scene
from ...scene.quantities import QUANTITIES
from ...scene.refusals import refuse_undriven
from ...scheduler import dealt, results
from ..batch.job import Start
from ..batch.jobs_in_batch import batch_results
from ..batch.starts import settle_starts, threads_for
from ..batch.threads import on_all_cores
from ..settling.single_chain import settle_or_failure
from .curve import Curve, CurvePoint
from .order import Knobs, LongestFirst, used_and_missing

#: Maximum number of points of one curve.
MOST_POINTS = 100_000
#: Number of points in one task for a scheduler's worker.
POINTS_IN_TASK = 64


def checked_points(scene: Scene, frequencies: Sequence[float] | np.ndarray,
                   amplitude: Amplitude | None = None) -> list[Knobs]:
    """Check the points of a curve; return the knobs that change between them: f, and A0 where it follows the frequency.

    Raises `BadInput` for no points, too many points, or a frequency or amplitude out of range.
    """
    refuse_undriven(scene)
    numbers = numbers_in("Frequencies", frequencies)
    if not 1 <= len(numbers) <= MOST_POINTS:
        raise BadInput(f"A curve has 1 to {MOST_POINTS} points, not {len(numbers)}.")
    points = [{"f": f} if amplitude is None else {"f": f, "A0": amplitude.at(f)} for f in numbers]
    for knobs in points:
        for name, value in knobs.items():
            QUANTITIES[name].check(value)
    return points


def iter_curve(scene: Scene, frequencies: Sequence[float] | np.ndarray, start: str = "rest",
               stop: Stop | None = None, workers: int | None = None) -> Iterator[CurvePoint]:
    """Yield the points of a resonance curve as they are finished.

    Parameters
    ----------
    scene : Scene
        The chain; its own frequency does not matter.
    frequencies : sequence of float
        Drive frequencies [Hz].
    start : str
        "rest": every point starts from rest, on all cores; "up" or "down": each starts from the state of the
        previous one.
    stop : Stop, optional
        When set, the curve ends and running points are abandoned.
    workers : int, optional
        Number of threads; by default one per core.

    Yields
    ------
    CurvePoint
        One for each frequency.

    Raises
    ------
    BadInput
        When the first point is requested: no frequency, too many, one out of range, an unknown `start`, or a scene
        without a drive.

    Examples
    --------
    >>> from granchain_core import iter_curve, scene
    >>> points = iter_curve(scene("sec2").evolve(N=2), [1800.0, 2000.0], start="down")
    >>> [point.frequency for point in points]
    [2000.0, 1800.0]
    """
    yield from _computed(scene, _parted(scene, frequencies, start)[1], None, start, stop, workers)


def _parted(scene: Scene, frequencies: Sequence[float] | np.ndarray, start: str,
            known: Sequence[CurvePoint] = (),
            amplitude: Amplitude | None = None) -> tuple[list[CurvePoint], list[Knobs]]:
    """The known points that can be used and the knobs of the missing ones, both in the order of computation."""
    points = checked_points(scene, frequencies, amplitude)
    used, missing = used_and_missing([point.frequency for point in known], [knobs["f"] for knobs in points], start)
    return [known[i] for i in used], [points[i] for i in missing]


def _computed(scene: Scene, left: list[Knobs], before: CurvePoint | None, start: str, stop: Stop | None,
              workers: int | None) -> Iterator[CurvePoint]:
    """Yield the remaining points; where the state is carried along, each starts from the state of the previous one."""
    if left and start == "rest":
        yield from _from_rest(scene, left, stop, workers)
    elif left:
        yield from _carried(scene, left, before, stop)


def _carried(scene: Scene, left: list[Knobs], before: CurvePoint | None, stop: Stop | None) -> Iterator[CurvePoint]:
    """Yield points one after another, each from the state of the previous one, or from rest if that one failed."""
    stop = Stop() if stop is None else stop
    state = None if before is None or before.failure else before.state
    for knobs in left:
        if stop:
            return
        try:
            steady_state = settle_or_failure(scene.evolve(**knobs), state, stop)
        except Cancelled:
            return
        state = steady_state.state if not steady_state.failure else None
        yield CurvePoint.of(steady_state)


def _from_rest(scene: Scene, left: list[Knobs], stop: Stop | None, workers: int | None) -> Iterator[CurvePoint]:
    """Yield independent points on all cores, in batches where possible; closing the generator stops the work."""
    ended, order = Stop(), LongestFirst(left)

    def work(shared: Iterator[Knobs]) -> Iterator[CurvePoint]:
        for point in _points(scene, shared, ended):
            order.finished(point.frequency, point.regime.periods_run)
            yield point

    yield from on_all_cores(work, order, ended, stop, min(threads_for(scene, workers), len(left)))


def _points(scene: Scene, left: Iterator[Knobs], ended: Stop) -> Iterator[CurvePoint]:
    """Yield points from rest in one thread, which also creates the scenes, so that other threads do not wait for it."""
    for steady_state in settle_starts((Start(scene.evolve(**knobs)) for knobs in left), ended):
        yield CurvePoint.of(steady_state)


def _scheduled(scheduler: Any, scene: Scene, left: list[Knobs], stop: Stop | None) -> Iterator[CurvePoint]:
    """Yield independent points, computed by the workers of a scheduler."""
    try:
        for _, points in results(scheduler, block_points, [(scene, block) for block in dealt(left, POINTS_IN_TASK)],
                                 stop):
            yield from points
    except Cancelled:
        return


def block_points(scene: Scene, left: list[Knobs]) -> list[CurvePoint]:
    """Compute points of one structure from rest in this thread: the task of one worker."""
    return list(_points(scene, iter(left), Stop()))


def draft_curve(scene: Scene, frequencies: Sequence[float] | np.ndarray, stop: Stop) -> list[CurvePoint]:
    """Compute a draft of the curve from rest on one core, to be drawn while a knob is still moving.

    It has coarse steps and few periods: no errors are stated, and motions that are not periodic by then are unsettled.
    Returns an empty list for scenes that a batch cannot run. Raises `BadInput` and `Cancelled`.
    """
    points = checked_points(scene, frequencies)
    if not can_share_batch(scene):
        return []
    scenes = (scene.evolve(**knobs) for knobs in points)
    return [CurvePoint.of(result) for result in batch_results(scenes, stop, draft=True)]


def resonance_curve(scene: Scene, frequencies: Sequence[float] | np.ndarray, start: str = "rest",
                    stop: Stop | None = None, on_point: Callable[[CurvePoint], None] | None = None,
                    workers: int | None = None, known: Sequence[CurvePoint] = (),
                    amplitude: Amplitude | None = None, scheduler: Any = None) -> Curve:
    """Compute the resonance curve: largest forces of the steady state over the drive frequency.

    Points from rest are computed in batches with fixed steps, whatever the scene's `accuracy`, and report their actual
    error. Points that are settled alone are computed to `accuracy`, at best to 1e-5.

    Parameters
    ----------
    scene : Scene
        The chain; its own frequency does not matter.
    frequencies : sequence of float
        Drive frequencies [Hz], 1 to 100,000 of them, in any order.
    start : str
        "rest": every point starts from rest, on all cores; "up" or "down": each point starts from the state of the
        previous one, so that hysteresis shows.
    stop : Stop, optional
        When set, the curve ends with its finished points; running points are abandoned.
    on_point : callable, optional
        Called with each `CurvePoint` as it is finished.
    workers : int, optional
        Number of threads; by default one per core.
    known : sequence of CurvePoint
        Points of this curve that are already computed, as `on_point` received them.
    amplitude : Amplitude, optional
        The drive amplitude over the frequency; by default the scene's A0. The spring k is not changed.
    scheduler : distributed.Client, optional
        Its workers compute the points from rest.

    Returns
    -------
    Curve
        The points in ascending frequency. If the computation of a point fails, its `failure` says why, and the curve
        continues.

    Raises
    ------
    BadInput
        No frequency, too many, one out of range, an unknown `start`, a scene without a drive, or a scheduler for a
        sweep.

    Examples
    --------
    >>> from granchain_core import resonance_curve, scene
    >>> curve = resonance_curve(scene("sec2").evolve(N=2), [1800.0, 2000.0, 2200.0])
    >>> curve.column("frequency")
    array([1800., 2000., 2200.])
    >>> max(curve.points, key=lambda point: point.max_output_force_elastic).frequency
    1800.0
    """
    began = time.perf_counter()
    used, left = _parted(scene, frequencies, start, known, amplitude)
    if scheduler is not None and start != "rest":
        raise BadInput("A sweep carries its state from point to point and cannot be divided among the workers of a "
                       'scheduler; use start="rest".')
    curve = Curve(scene, start, used, amplitude=amplitude)
    for point in (_computed(scene, left, used[-1] if used else None, start, stop, workers) if scheduler is None else
                  _scheduled(scheduler, scene, left, stop)):
        curve.points.append(point)
        if on_point is not None:
            on_point(point)
    curve.points.sort(key=lambda p: p.frequency)
    curve.wall_s = time.perf_counter() - began
    return curve
