"""The resonance curve: largest forces over the drive frequency, point by point, on all cores."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from ...errors import BadInput, Cancelled
from ...execution.cores import usable_cores
from ...execution.stop import Stop
from ...inputs.checks import numbers_in
from ...integrate.batch import can_share_batch
from ...scene import Amplitude, Scene
from ...scene.quantities import QUANTITIES
from ...scene.refusals import refuse_undriven
from ...scheduler import dealt, results
from ..batch.job import Start
from ..batch.jobs_in_batch import batch_results
from ..batch.starts import settle_starts
from ..batch.threads import on_all_cores
from ..settling.single_chain import settle_or_failure
from .curve import Curve, CurvePoint
from .order import Knobs, LongestFirst, used_and_missing

#: Most points of one curve.
MOST_POINTS = 100_000
#: Points of one task of a scheduler's worker.
POINTS_IN_TASK = 64


def checked_points(scene: Scene, frequencies: Sequence[float] | np.ndarray,
                   amplitude: Amplitude | None = None) -> list[Knobs]:
    """The knobs that change from point to point of a curve: f, and A0 where it follows the frequency.

    Raises `BadInput` for no points, too many, or a frequency or amplitude out of range.
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
    """Points of a resonance curve as they are finished.

    Parameters
    ----------
    scene : Scene
        The chain; its own frequency does not matter.
    frequencies : sequence of float
        Drive frequencies [Hz].
    start : str
        "rest": every point begins at rest, on all cores; "up" or "down": each begins in the state of the
        one before it.
    stop : Stop, optional
        When set, the curve ends and running points are abandoned.
    workers : int, optional
        Threads; one for each core if not given.

    Yields
    ------
    CurvePoint
        One for each frequency.

    Raises
    ------
    BadInput
        When the first point is asked for: no frequency, too many, one out of range, another word for `start`, or a
        scene without a drive.

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
    """The known points that can be used and the knobs of those that are left, both in the order of computing."""
    points = checked_points(scene, frequencies, amplitude)
    used, missing = used_and_missing([point.frequency for point in known], [knobs["f"] for knobs in points], start)
    return [known[i] for i in used], [points[i] for i in missing]


def _computed(scene: Scene, left: list[Knobs], before: CurvePoint | None, start: str, stop: Stop | None,
              workers: int | None) -> Iterator[CurvePoint]:
    """The remaining points; where the state is carried along, each starts in the state of the point before."""
    if left and start == "rest":
        yield from _from_rest(scene, left, stop, workers)
    elif left:
        yield from _carried(scene, left, before, stop)


def _carried(scene: Scene, left: list[Knobs], before: CurvePoint | None, stop: Stop | None) -> Iterator[CurvePoint]:
    """Points one after another, each from the state of the one before; from rest after one that failed."""
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
    """Independent points on all cores: in batches where they can, else one by one; closing the generator stops them."""
    ended, order = Stop(), LongestFirst(left)

    def work(shared: Iterator[Knobs]) -> Iterator[CurvePoint]:
        for point in _points(scene, shared, ended):
            order.finished(point.frequency, point.regime.periods_run)
            yield point

    yield from on_all_cores(work, order, ended, stop, min(workers or usable_cores(), len(left)))


def _points(scene: Scene, left: Iterator[Knobs], ended: Stop) -> Iterator[CurvePoint]:
    """Points from rest in one thread, which makes the scenes: made beforehand, all other threads would wait for them.
    """
    for steady_state in settle_starts((Start(scene.evolve(**knobs)) for knobs in left), ended):
        yield CurvePoint.of(steady_state)


def _scheduled(scheduler: Any, scene: Scene, left: list[Knobs], stop: Stop | None) -> Iterator[CurvePoint]:
    """Independent points by the workers of a scheduler."""
    try:
        for _, points in results(scheduler, block_points, [(scene, block) for block in dealt(left, POINTS_IN_TASK)],
                                 stop):
            yield from points
    except Cancelled:
        return


def block_points(scene: Scene, left: list[Knobs]) -> list[CurvePoint]:
    """Points of one structure from rest, computed in this thread: the work of one worker."""
    return list(_points(scene, iter(left), Stop()))


def draft_curve(scene: Scene, frequencies: Sequence[float] | np.ndarray, stop: Stop) -> list[CurvePoint]:
    """A draft of the curve from rest, on one core, to be drawn while a knob still moves.

    Coarse steps and few periods: no errors are stated, and motions that are not periodic by then are unsettled. Empty
    for scenes that a batch cannot run. Raises `BadInput` and `Cancelled`.
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
    """The resonance curve: largest forces of the steady state over the drive frequency.

    Points from rest are computed in batches with fixed steps, whatever the scene's `accuracy`, and state the error they
    have. Points that are settled alone are computed to `accuracy`, at best to 1e-5.

    Parameters
    ----------
    scene : Scene
        The chain; its own frequency does not matter.
    frequencies : sequence of float
        Drive frequencies [Hz], 1 to 100,000 of them, in any order.
    start : str
        "rest": every point begins at rest, on all cores; "up" or "down": each point begins in the state of the one
        before it, so hysteresis shows.
    stop : Stop, optional
        When set, the curve ends with its finished points; running points are abandoned.
    on_point : callable, optional
        Called with each `CurvePoint` as it is finished.
    workers : int, optional
        Threads; one for each core if not given.
    known : sequence of CurvePoint
        Points of this curve that are already computed, as `on_point` received them.
    amplitude : Amplitude, optional
        The drive amplitude over the frequency; the scene's A0 if not given. The spring k stays as it is.
    scheduler : distributed.Client, optional
        Points from rest are computed by its workers.

    Returns
    -------
    Curve
        Its points in ascending frequency. If the computation of a point fails, its `failure` says why, and the curve
        continues.

    Raises
    ------
    BadInput
        No frequency, too many, one out of range, another word for `start`, a scene without a drive, or a scheduler for
        a sweep.

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
