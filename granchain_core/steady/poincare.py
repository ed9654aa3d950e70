"""The Poincaré section: a chain's state once per drive period, at any drive phase.

A driven chain's section at phase p is the set of states at t = (j + p)/f, j = 0, 1, …: n points for a period-n orbit, a
closed curve for a quasi-periodic motion, a structured cloud for a chaotic one. The motion is recorded at many phases of
each period, so that another phase or bead needs no new run.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..execution.stop import Stop
from ..integrate import Engine, following_setting
from ..integrate.start import at_phase_0
from ..scene import Scene
from ..scene.state import State, rest

#: Maximum number of displacement values in a section: the longer the chain, the fewer periods are kept.
MOST_VALUES = 1_500_000


@dataclass(frozen=True, eq=False)
class Section:
    """States of every bead at `samples` phases of each of P periods since the start, phase 0 first.

    displacement, velocity (P, samples, N) [m, m/s]; those of `iter_section` are in single precision, which is enough
    for figures and for starting Newton's method.
    """

    scene: Scene
    displacement: np.ndarray
    velocity: np.ndarray

    @property
    def samples(self) -> int:
        """Phases per period."""
        return int(self.displacement.shape[1])

    @property
    def periods(self) -> int:
        """Periods recorded so far."""
        return len(self.displacement)

    def points(self, bead: int, phase: int) -> np.ndarray:
        """Displacement and velocity (P, 2) of bead 1..N at the sample with number `phase` [m, m/s]."""
        return np.stack([self.displacement[:, phase, bead - 1], self.velocity[:, phase, bead - 1]], axis=1)

    def strobes(self) -> np.ndarray:
        """Displacement and velocity (P, 2, N) of all beads at phase 0 [m, m/s]."""
        return np.stack([self.displacement[:, 0], self.velocity[:, 0]], axis=1)


def most_periods(scene: Scene, samples: int, wanted: int) -> int:
    """Number of periods that are kept, at most `wanted`."""
    return max(1, min(wanted, MOST_VALUES // (samples * scene.N)))


def iter_section(scene: Scene, start: State | None, periods: int, samples: int = 48, seconds: float = 0.15,
                 stop: Stop | None = None) -> Iterator[Section]:
    """Yield the growing section from `start`, by default the scene's own start, about every `seconds`.

    It ends after `periods` drive periods, or after as many as are kept (`most_periods`). Raises `ComputationError`,
    `Cancelled`.
    """
    engine = Engine(scene, following_setting(scene.cuts_tension), samples, stop=stop)
    engine.start(rest(scene) if start is None else at_phase_0(scene, start, engine.stop))
    most = most_periods(scene, samples, periods)
    displacement = np.zeros((most, samples, scene.N), dtype=np.float32)
    velocity = np.zeros_like(displacement)
    scales = engine.scaled.scales
    done, chunk = 0, 1
    while done < most:
        until = time.perf_counter() + seconds
        while done < most and time.perf_counter() < until:
            began, chunk = time.perf_counter(), min(chunk, most - done)
            record, part = engine.record(chunk * samples), slice(done, done + chunk)
            displacement[part] = scales.displacements(record.displacement[:-1].reshape(chunk, samples, -1))
            velocity[part] = scales.velocities(record.velocity[:-1].reshape(chunk, samples, -1))
            done += chunk
            if time.perf_counter() - began < 0.1 * seconds:
                chunk *= 2
        yield Section(scene, displacement[:done], velocity[:done])
