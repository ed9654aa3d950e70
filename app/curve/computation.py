"""The resonance curve as a background computation: coarse first, finer where it bends, cancellable."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import partial

import numpy as np

from granchain_core import CurvePoint, Scene, iter_curve
from granchain_core.execution.stop import Stop

from ..serve.computing.shared import Shared
from ..serve.computing.worker_pools import CURVE_WORK
from ..session.scene_facts import slider_range, without_frequency
from ..session.task import Job

#: Frequencies of the first pass over a curve from rest.
COARSE = 75
#: Frequencies of a sweep up or down, which has only one pass: each point starts where the last one ended.
_POINTS_OF_SWEEP = 150
#: Further passes over a curve from rest, each between the points of the earlier ones.
_FINER_PASSES = 2


@dataclass
class Progress:
    """The progress of the curve from one start, `done` from 0 to 1; `points` are new since the last report.

    `covers_range` says that the points cover the whole range, `complete` that no more will come.
    """

    start: str
    points: list[CurvePoint]
    done: float
    complete: bool = False
    covers_range: bool = False


def grid(scene: Scene, points: int) -> np.ndarray:
    """Return frequencies over the scene's range."""
    return np.linspace(*slider_range(scene, "f"), points)


def midpoints(points: list[CurvePoint], low_step: float) -> np.ndarray:
    """Return frequencies of further points: where the curve bends, and where the regime changes."""
    points = sorted((p for p in points if np.isfinite(p.max_output_force)), key=lambda p: p.frequency)
    force = np.array([point.max_output_force for point in points])
    frequency = np.array([point.frequency for point in points])
    if len(points) < 4:
        return np.zeros(0)
    bend = np.zeros(len(points))
    bend[1:-1] = np.abs(force[2:] - 2 * force[1:-1] + force[:-2])
    kinds = [(point.regime.name, point.regime.period) for point in points]
    needed = np.maximum(bend[:-1], bend[1:]) > 0.02 * force.max()
    needed |= np.array([kinds[i] != kinds[i + 1] for i in range(len(kinds) - 1)])
    needed &= np.diff(frequency) > low_step
    return (0.5 * (frequency[:-1] + frequency[1:]))[needed]


@dataclass(frozen=True)
class CurveComputation:
    """The work of one request on a worker thread: the curves of some starts of one scene, one after another.

    It waits while `busy` returns True. Sessions at the same knobs share one computation.
    """

    scene: Scene
    starts: list[str]
    report: Callable[[Progress], None]
    busy: Callable[[], bool]

    def __call__(self, job: Job) -> None:
        """Report each point as it comes; reported points stay when the job is cancelled."""
        for start in self.starts:
            key = without_frequency(self.scene), start
            with closing(CURVES_SHARED.follow(key, partial(_computed, self.scene, start), job.stop)) as shared:
                for progress in shared:
                    job.stop.check()
                    self.report(progress)
                    job.give_way(self.busy)


def _computed(scene: Scene, start: str, stop: Stop) -> Iterator[Progress]:
    """Compute one curve, from coarse to fine. Raises `Cancelled`."""
    if start != "rest":
        yield from _points(scene, grid(scene, _POINTS_OF_SWEEP), start, stop, 0.0, 1.0)
        yield Progress(start, [], 1.0, complete=True, covers_range=True)
        return
    points: list[CurvePoint] = []
    frequencies = grid(scene, COARSE)
    finest = 0.26 * float(frequencies[1] - frequencies[0])
    for number in range(_FINER_PASSES + 1):
        low, high = number / (_FINER_PASSES + 1), (number + 1) / (_FINER_PASSES + 1)
        for progress in _points(scene, frequencies, start, stop, low, high):
            points += progress.points
            yield progress
        yield Progress(start, [], high, complete=number == _FINER_PASSES, covers_range=True)
        frequencies = midpoints(points, finest)


def _points(scene: Scene, frequencies: np.ndarray, start: str, stop: Stop, low: float,
            high: float) -> Iterator[Progress]:
    """Compute a point for each frequency and report each; progress rises from `low` to `high` meanwhile."""
    if not len(frequencies):
        return
    for number, point in enumerate(iter_curve(scene, frequencies, start=start, stop=stop), 1):
        stop.check()
        yield Progress(start, [point], low + (high - low) * number / len(frequencies))
    stop.check()


def _cached(parts: list[Progress]) -> list[Progress]:
    """Return a complete curve as it is cached for the next session: all points at once."""
    points = [point for progress in parts for point in progress.points]
    return [Progress(parts[-1].start, points, 1.0, complete=True, covers_range=True)]


def _size(progress: Progress) -> int:
    """Return the memory used [bytes]: the states of the points, and some numbers and words."""
    return sum(2000 + point.state.displacement.nbytes + point.state.velocity.nbytes for point in progress.points)


#: Curves of all sessions. They take no turns; docs/dashboard-server.md says what that means for visitors.
CURVES_SHARED: Shared[Progress] = Shared(CURVE_WORK, 50_000_000, _size, _cached, turns=False)
