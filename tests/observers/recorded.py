"""Forces for the observers in tests, computed by dop853 from a chain whose states are known too."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from granchain_core import Scene, State, orbit
from granchain_core.integrate import Engine, MethodSetting


@dataclass(frozen=True)
class Recorded:
    """A chain on its orbit: times, input and output forces, displacements (T, N), and the state at the first time.

    `largest` (2,) has the largest output force and its largest elastic part, including maxima between samples.
    """

    time: np.ndarray
    force: np.ndarray
    output: np.ndarray
    displacement: np.ndarray
    start: State
    largest: np.ndarray


def recorded(scene: Scene, samples: int, periods: int = 3) -> Recorded:
    """Record `periods` drive periods of the settled chain of `scene`, with `samples` samples each."""
    start = orbit(scene).state
    engine = Engine(scene, MethodSetting("dop853", tolerance=1e-12), samples)
    engine.start(start)
    rows, scales = engine.record(periods * samples), engine.scaled.scales
    return Recorded(np.arange(periods * samples + 1) / samples / scene.f, rows.force[:, 0] * scales.force,
                    rows.force[:, -1] * scales.force, rows.displacement * scales.length, start,
                    engine.maxima[1:] * scales.force)


def error(found: np.ndarray, true: np.ndarray) -> float:
    """Return the largest difference, relative to the largest value."""
    return float(np.abs(found - true).max() / np.abs(true).max())
