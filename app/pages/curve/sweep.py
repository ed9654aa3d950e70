"""The resonance curve as a background computation: coarse first, finer where it bends, cancellable."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from granchain_core import CurvePoint, Scene, iter_curve

from ...page.session import slider_range
from ...serve.queues import BACKGROUND

DIRECTIONS = ("rest", "up", "down")
COARSE, _SWEEP = 75, 150
_PASSES = 2
_PATIENCE = 0.01
"""Seconds between looks whether the picture in front is done; a curve never competes with a moving knob."""


@dataclass
class Progress:
    """How far one curve is; `points` are new since the last report."""

    direction: str
    points: list[CurvePoint]
    done: float
    complete: bool = False
    covers: bool = False


def without_frequency(scene: Scene) -> Scene:
    """What a curve belongs to: moving f costs nothing on it."""
    return scene.evolve(f=slider_range(scene, "f")[0])


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


@dataclass
class Sweep:
    """The curves of one scene; `start` replaces whatever was being computed."""

    report: Callable[[Progress], None]
    fail: Callable[[Exception], None]
    busy: Callable[[], bool]
    _stop: threading.Event = field(default_factory=threading.Event)

    def start(self, scene: Scene, directions: list[str]) -> None:
        """Compute these directions in the background, one after the other."""
        self.cancel()
        self._stop = stop = threading.Event()
        if directions:
            BACKGROUND.submit(self._work, scene, directions, stop)

    def cancel(self) -> None:
        """Stop; what was reported stays."""
        self._stop.set()

    def _work(self, scene: Scene, directions: list[str], stop: threading.Event) -> None:
        try:
            for direction in directions:
                passes = self._from_rest if direction == "rest" else self._carried
                passes(scene, direction, stop)
        except Exception as error:
            if not stop.is_set():
                self.fail(error)

    def _from_rest(self, scene: Scene, direction: str, stop: threading.Event) -> None:
        found: list[CurvePoint] = []
        frequencies = grid(scene, COARSE)
        finest = 0.26 * float(frequencies[1] - frequencies[0])
        for number in range(_PASSES + 1):
            low, high = number / (_PASSES + 1), (number + 1) / (_PASSES + 1)
            found += self._points(scene, frequencies, direction, stop, low, high)
            if stop.is_set():
                return
            self.report(Progress(direction, [], high, complete=number == _PASSES, covers=True))
            frequencies = midpoints(found, finest)

    def _carried(self, scene: Scene, direction: str, stop: threading.Event) -> None:
        self._points(scene, grid(scene, _SWEEP), direction, stop, 0.0, 1.0)
        if not stop.is_set():
            self.report(Progress(direction, [], 1.0, complete=True, covers=True))

    def _points(self, scene: Scene, frequencies: np.ndarray, direction: str, stop: threading.Event,
                low: float, high: float) -> list[CurvePoint]:
        """Compute `frequencies`, reporting as they come; their share of the progress is `low` to `high`."""
        found: list[CurvePoint] = []
        if not len(frequencies):
            return found
        for point in iter_curve(scene, frequencies, start=direction, stop=stop.is_set):
            if stop.is_set():
                break
            found.append(point)
            done = low + (high - low) * len(found) / len(frequencies)
            self.report(Progress(direction, [point], done))
            while self.busy() and not stop.wait(_PATIENCE):
                pass
        return found
