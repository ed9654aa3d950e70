"""The resonance curve as a background computation: coarse first, finer where it bends, cancellable."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from granchain_core import Cancelled, CurvePoint, Scene, iter_curve

from ...session.session import slider_range
from ...session.task import Job

DIRECTIONS = ("rest", "up", "down")
COARSE, _SWEEP = 75, 150
_PASSES = 2


@dataclass
class Progress:
    """How far one curve is; `points` are new since the last report."""

    direction: str
    points: list[CurvePoint]
    done: float
    complete: bool = False
    covers: bool = False


def grid(scene: Scene, points: int) -> np.ndarray:
    """Frequencies over the scene's range."""
    return np.linspace(*slider_range(scene, "f"), points)


def midpoints(points: list[CurvePoint], low_step: float) -> np.ndarray:
    """Where the curve needs more points: where it bends, and where the regime changes."""
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
class Sweep:
    """The work of one request on a worker thread: some directions of one scene, one after the other.

    It waits while `busy` returns True.
    """

    scene: Scene
    directions: list[str]
    report: Callable[[Progress], None]
    busy: Callable[[], bool]

    def __call__(self, job: Job) -> None:
        """Compute everything, reporting as it comes; what was reported stays when the job is cancelled."""
        for direction in self.directions:
            (self._from_rest if direction == "rest" else self._carried)(direction, job)

    def _from_rest(self, direction: str, job: Job) -> None:
        found: list[CurvePoint] = []
        frequencies = grid(self.scene, COARSE)
        finest = 0.26 * float(frequencies[1] - frequencies[0])
        for number in range(_PASSES + 1):
            low, high = number / (_PASSES + 1), (number + 1) / (_PASSES + 1)
            found += self._points(frequencies, direction, job, low, high)
            self.report(Progress(direction, [], high, complete=number == _PASSES, covers=True))
            frequencies = midpoints(found, finest)

    def _carried(self, direction: str, job: Job) -> None:
        self._points(grid(self.scene, _SWEEP), direction, job, 0.0, 1.0)
        self.report(Progress(direction, [], 1.0, complete=True, covers=True))

    def _points(self, frequencies: np.ndarray, direction: str, job: Job, low: float, high: float) -> list[CurvePoint]:
        """Compute `frequencies`, reporting as they come; their share of the progress is `low` to `high`.

        Raises `Cancelled`.
        """
        found: list[CurvePoint] = []
        if not len(frequencies):
            return found
        for point in iter_curve(self.scene, frequencies, start=direction, stop=job.stop):
            if job.stop:
                raise Cancelled
            found.append(point)
            done = low + (high - low) * len(found) / len(frequencies)
            self.report(Progress(direction, [point], done))
            job.give_way(self.busy)
        if job.stop:
            raise Cancelled
        return found
