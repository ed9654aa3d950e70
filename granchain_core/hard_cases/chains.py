"""Chains for the hard cases that scenes cannot describe: without a driver or with free ends, in scaled units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..integrate import Engine, MethodSetting, dop853_setting
from ..integrate.methods import DOP853
from ..kernels.effects.contact import Chain
from ..kernels.effects.dissipation import LinearDashpot
from ..kernels.effects.driver import Harmonic
from ..kernels.effects.preload import Preload
from ..kernels.effects.tension import new_tension_cut
from ..kernels.samples import Samples
from ..scene import Scene, scene
from ..scene.hertz import HERTZ_DURATION
from ..scene.state import State


def contact_time(speed: float, reduced_mass: float = 0.5, stiffness: float = 1.0) -> float:
    """Return the duration of a loss-free Hertz collision."""
    return HERTZ_DURATION * (reduced_mass / stiffness) ** 0.4 * speed**-0.2


class Bench:
    """Equal or unequal beads between a driver and a wall, both at rest, integrated by `method`; K = m = 1.

    `ends` are the stiffnesses of the first and the last contact. If the first is 0, there is no driver; if the last is
    0, that end is free as long as the damping law `law`, which acts in every contact, has no strength. `time` is the
    length of one record of `samples` samples; displacements start at zero. `static` gives the overlaps of the contacts
    at rest (negative values are gaps).
    """

    def __init__(self, beads: int, time: float, samples: int, law: Any = None, ends: tuple[float, float] = (1.0, 1.0),
                 inverse_mass: Sequence[float] | None = None, stiffness: Sequence[float] | None = None,
                 static: np.ndarray | None = None, cut: bool = False, method: str = DOP853,
                 tolerance: float = 1e-13, refine: float = 1.0) -> None:
        base: Scene = scene("sec2").evolve(N=beads)
        phi = Engine(base, dop853_setting(1e-3)).scaled.scales.phi
        self.engine = Engine(base.evolve(f=phi / time), MethodSetting(method, refine, tolerance), samples)
        scaled = self.engine.scaled
        masses = np.zeros(beads + 2)
        masses[1:-1] = 1.0 if inverse_mass is None else inverse_mass
        springs = np.ones(beads + 1) if stiffness is None else np.array(stiffness, dtype=float)
        springs[0], springs[-1] = ends[0] * springs[0], ends[1] * springs[-1]
        slots = scaled.slots._replace(
            chain=Chain(masses, springs), dissipation=LinearDashpot(0.0) if law is None else law,
            driver=Harmonic(0.0, scaled.beta) if ends[0] > 0.0 else None,
            tension=new_tension_cut(beads + 1) if cut else None,
            preload=None if static is None else Preload(np.array(static, dtype=float)))
        self.engine.use(replace(scaled, slots=slots))
        self.masses = 1.0 / masses[1:-1]
        self.springs = springs
        self.static = np.zeros(beads + 1) if static is None else np.array(static, dtype=float)
        self.samples = samples
        self.time = np.linspace(0.0, time, samples + 1)

    def throw(self, velocity: Sequence[float] | np.ndarray, displacement: np.ndarray | None = None) -> None:
        """Start with these scaled velocities, from the given displacement or from zero."""
        scales = self.engine.scaled.scales
        start = np.zeros(len(self.masses)) if displacement is None else displacement
        self.engine.start(State(start * scales.length, np.array(velocity, dtype=float) * scales.velocity))

    def record(self, times: int = 1) -> Samples:
        """Return the scaled samples of `times` consecutive records."""
        return self.engine.record(self.samples * times)

    def overlaps(self, displacement: np.ndarray) -> np.ndarray:
        """Return the overlap of every contact (T, N+1); negative where there is a gap."""
        ends = np.zeros((len(displacement), 1))
        bodies = np.hstack([ends, displacement, ends])
        return bodies[:, :-1] - bodies[:, 1:] + self.static

    def energy(self, kept: Samples) -> np.ndarray:
        """Return the kinetic plus contact energy at every sample (T,)."""
        pressed = np.maximum(self.overlaps(kept.displacement), 0.0)
        return 0.5 * (self.masses * kept.velocity**2).sum(axis=1) + 0.4 * (self.springs * pressed**2.5).sum(axis=1)

    def momentum(self, kept: Samples) -> np.ndarray:
        """Return the momentum of all beads at every sample (T,)."""
        return (self.masses * kept.velocity).sum(axis=1)
