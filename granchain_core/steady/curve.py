"""The resonance curve: largest forces over the drive frequency, point by point, on all cores."""

from __future__ import annotations

import itertools
import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..errors import BadInput, Cancelled, unknown_name
from ..integrate import State
from ..integrate.batch import can_share_batch
from ..regime import Regime
from ..result import ForceErrors
from ..scene import Scene
from ..stop import Stop
from .alone import safe_state, settled_alone
from .batch_settle import batch_results
from .steady_state import SteadyState
from .threads import on_all_cores

STARTS = ("rest", "up", "down")
#: Most points of one curve.
MOST_POINTS = 100_000


@dataclass(frozen=True, eq=False)
class CurvePoint:
    """The steady state at one frequency.

    Attributes
    ----------
    frequency : float
        [Hz]
    max_output_force, max_output_force_elastic, max_input_force : float
        Largest forces [N]; where the motion is not periodic, those of the last periods. NaN where the numbers failed.
    regime : Regime
        What kind of motion it is.
    force_errors : ForceErrors
        Relative errors of the three; None where the motion is not periodic.
    state : State
        Where the chain is at drive phase 0.
    failure : str
        A sentence where the numbers failed.
    status : str
        "done", or the failure's name.

    Examples
    --------
    >>> from granchain_core import resonance_curve, scene
    >>> point = resonance_curve(scene("sec2").evolve(N=2), [2000.0]).points[0]
    >>> point.status, point.regime.period, point.error_estimate < 1e-3
    ('done', 1, True)
    """

    frequency: float
    max_output_force: float
    max_output_force_elastic: float
    max_input_force: float
    regime: Regime
    force_errors: ForceErrors
    state: State
    failure: str = ""
    status: str = "done"

    @classmethod
    def of(cls, found: SteadyState) -> CurvePoint:
        """The point of a steady state."""
        input_force, output_force, elastic = map(float, found.tops)
        return cls(found.scene.f, output_force, elastic, input_force, found.regime, found.force_errors, found.state,
                   found.failure, found.status)

    @property
    def error_estimate(self) -> float | None:
        """Relative error of the output force; None where none is claimed."""
        return self.force_errors.output


@dataclass(eq=False)
class Curve:
    """A resonance curve in ascending frequency.

    Attributes
    ----------
    scene : Scene
        The chain.
    start : str
        "rest", "up" or "down".
    points : list of CurvePoint
        One for each frequency.
    wall_s : float
        Wall-clock time [s].

    Examples
    --------
    >>> from granchain_core import resonance_curve, scene
    >>> curve = resonance_curve(scene("sec2").evolve(N=2), [1800.0, 2000.0])
    >>> curve.column("max_input_force").shape
    (2,)
    """

    scene: Scene
    start: str
    points: list[CurvePoint] = field(default_factory=list)
    wall_s: float = 0.0

    def column(self, name: str) -> np.ndarray:
        """One attribute of all points as an array."""
        return np.array([getattr(p, name) for p in self.points])


def coarse_first(count: int) -> list[int]:
    """Indices 0..count−1 so that the curve's shape is there early: ends, middle, quarters, …"""
    step = 1 << max(0, (count - 1).bit_length())
    order: list[int] = []
    seen = set()
    while step >= 1:
        for i in range(0, count, step):
            if i not in seen:
                seen.add(i)
                order.append(i)
        step //= 2
    return order


def checked_frequencies(scene: Scene, frequencies: Sequence[float] | np.ndarray) -> list[Scene]:
    """The scenes of a curve; `BadInput` for no points, too many, or a frequency out of range."""
    if not 1 <= len(frequencies) <= MOST_POINTS:
        raise BadInput(f"A curve has 1 to {MOST_POINTS} points, not {len(frequencies)}.")
    return [scene.evolve(f=float(f)) for f in frequencies]


def iter_curve(scene: Scene, frequencies: Sequence[float] | np.ndarray, start: str = "rest",
               stop: Stop | None = None, workers: int | None = None,
               known: Sequence[CurvePoint] = ()) -> Iterator[CurvePoint]:
    """Points of a resonance curve as they are finished.

    Parameters
    ----------
    scene : Scene
        The chain; its own frequency does not matter.
    frequencies : sequence of float
        Drive frequencies [Hz].
    start : str
        "rest": points come coarse first, from all cores; "up" or "down": the state is carried along in that direction.
    stop : Stop, optional
        Once it is set the curve ends, and a running point is given up.
    workers : int, optional
        Threads; one for each core if not given.
    known : sequence of CurvePoint
        Points of this curve that are there already; `missing_from` says which of them are used.

    Yields
    ------
    CurvePoint
        One for each frequency that is not known.

    Raises
    ------
    BadInput
        No frequency, too many, one out of range, or another word for `start`.

    Examples
    --------
    >>> from granchain_core import iter_curve, scene
    >>> points = iter_curve(scene("sec2").evolve(N=2), [1800.0, 2000.0], start="down")
    >>> [point.frequency for point in points]
    [2000.0, 1800.0]
    """
    scenes = checked_frequencies(scene, frequencies)
    used, missing = missing_from(known, [one.f for one in scenes], start)
    left = [scenes[i] for i in missing]
    if not left:
        return
    if start == "rest":
        yield from _from_rest(left, stop, workers)
    else:
        yield from _carried(left, used[-1] if used else None, stop)


def missing_from(known: Sequence[CurvePoint], frequencies: Sequence[float],
                 start: str) -> tuple[list[CurvePoint], list[int]]:
    """Which known points a curve can use, and the places of the missing frequencies, both in the order of computing.

    From rest every known point is used. Where the state is carried along, only those up to the first that is missing.
    Raises `BadInput` for an unknown start.
    """
    if start not in STARTS:
        raise unknown_name("start", start, STARTS)
    count = range(len(frequencies))
    order = (coarse_first(len(frequencies)) if start == "rest"
             else sorted(count, key=lambda i: frequencies[i], reverse=start == "down"))
    there: dict[float, list[CurvePoint]] = {}
    for point in known:
        there.setdefault(point.frequency, []).append(point)
    used: list[CurvePoint] = []
    missing: list[int] = []
    for i in order:
        found = there.get(frequencies[i])
        if found and (start == "rest" or not missing):
            used.append(found.pop())
        else:
            missing.append(i)
    return used, missing


def _carried(scenes: list[Scene], before: CurvePoint | None, stop: Stop | None) -> Iterator[CurvePoint]:
    """Points one after another, each from the state of the one before; from rest after one that failed."""
    stop = Stop() if stop is None else stop
    state = None if before is None or before.failure else before.state
    for one in scenes:
        if stop:
            return
        try:
            found = safe_state(one, state, stop)
        except Cancelled:
            return
        state = found.state if not found.failure else None
        yield CurvePoint.of(found)


def _from_rest(scenes: list[Scene], stop: Stop | None, workers: int | None) -> Iterator[CurvePoint]:
    """Independent points on all cores: by lanes where they can, else one by one; closing the generator stops them."""
    ended = Stop()
    yield from on_all_cores(lambda shared: _points(shared, ended), scenes, ended, stop,
                            min(workers or os.cpu_count() or 1, len(scenes)))


def _points(scenes: Iterator[Scene], ended: Stop) -> Iterator[CurvePoint]:
    first = next(scenes, None)
    if first is None:
        return
    rest_of_them = itertools.chain([first], scenes)
    if can_share_batch(first):
        for found in batch_results(rest_of_them, ended):
            yield CurvePoint.of(settled_alone(found, ended) if found.doubtful else found)
        return
    for one in rest_of_them:
        yield CurvePoint.of(safe_state(one, None, ended))


def draft_curve(scene: Scene, frequencies: Sequence[float] | np.ndarray, stop: Stop) -> list[CurvePoint]:
    """A draft of the curve from rest, on one core, to be drawn while a knob still moves.

    Coarse steps and few periods: no errors are claimed, and motions that are not periodic by then are unsettled. Empty
    for scenes that lanes cannot run. Raises `BadInput` and `Cancelled`.
    """
    if not can_share_batch(scene):
        return []
    scenes = iter(checked_frequencies(scene, frequencies))
    return [CurvePoint.of(result) for result in batch_results(scenes, stop, draft=True)]


def resonance_curve(scene: Scene, frequencies: Sequence[float] | np.ndarray, start: str = "rest",
                    stop: Stop | None = None, on_point: Callable[[CurvePoint], None] | None = None,
                    workers: int | None = None, known: Sequence[CurvePoint] = ()) -> Curve:
    """The resonance curve: largest forces of the steady state over the drive frequency.

    Parameters
    ----------
    scene : Scene
        The chain; its own frequency does not matter.
    frequencies : sequence of float
        Drive frequencies [Hz], 1 to 100,000 of them, in any order.
    start : str
        "rest": every point begins at rest, all cores work; "up" or "down": the state is carried along that way, so
        that hysteresis shows.
    stop : Stop, optional
        Once it is set the curve ends with what there is; a running point is given up.
    on_point : callable, optional
        Called with each `CurvePoint` as it is finished.
    workers : int, optional
        Threads; one for each core if not given.
    known : sequence of CurvePoint
        Points of this curve that are there already, as `on_point` gave them.

    Returns
    -------
    Curve
        Its points in ascending frequency. A point whose numbers fail says so and does not end the curve.

    Raises
    ------
    BadInput
        No frequency, too many, one out of range, or another word for `start`.

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
    curve = Curve(scene, start, missing_from(known, [float(f) for f in frequencies], start)[0])
    for point in iter_curve(scene, frequencies, start, stop, workers, known):
        curve.points.append(point)
        if on_point is not None:
            on_point(point)
    curve.points.sort(key=lambda p: p.frequency)
    curve.wall_s = time.perf_counter() - began
    return curve
