"""An independent version of the equations of motion, in (u, v) with SI units and plain loops, for comparison in tests.
"""

from __future__ import annotations

import math

import numpy as np

from granchain_core import Scene
from tools.fuzzing.laws import EXPONENT

WALL = {"bead": 1.0, "same-material": math.sqrt(2), "rigid": 2 * math.sqrt(2)}


def stiffness(scene: Scene) -> list[float]:
    """Return K = E√(2R)/(3(1−ν²)) of equal spheres for every contact; the last one is multiplied by the wall factor."""
    bead = scene.pattern[0]
    one = bead.young * math.sqrt(2 * bead.radius) / (3 * (1 - bead.poisson**2))
    factor = WALL[scene.wall] if isinstance(scene.wall, str) else scene.wall
    return [one] * scene.N + [factor * one]


def forces(scene: Scene, u: np.ndarray, v: np.ndarray, time: float) -> tuple[list[float], list[float]]:
    """Return total and elastic forces of contacts 0 to N for displacements and velocities (N,) at a time [s]."""
    omega = 2 * math.pi * scene.f
    bodies = [scene.A0 * math.sin(omega * time), *u, 0.0]
    speeds = [scene.A0 * omega * math.cos(omega * time), *v, 0.0]
    total, elastic = [], []
    for c, K in enumerate(stiffness(scene)):
        d = bodies[c] - bodies[c + 1] + (scene.F0 / K) ** (2 / 3)
        if d <= 0:
            total.append(0.0)
            elastic.append(0.0)
            continue
        elastic.append(K * d**1.5)
        damping = 0.0
        if scene.dissipation != "none":
            damping = scene.D * (d / scene.reference_overlap) ** EXPONENT[scene.dissipation]
        force = elastic[-1] + damping * (speeds[c] - speeds[c + 1])
        total.append(max(0.0, force) if scene.tension == "cut" else force)
    return total, elastic


def acceleration(scene: Scene, u: np.ndarray, v: np.ndarray, time: float) -> np.ndarray:
    """Return the accelerations (N,) [m/s²]."""
    total, _ = forces(scene, u, v, time)
    m = scene.pattern[0].mass
    return np.array([(total[i] - total[i + 1] - scene.k * u[i]) / m for i in range(scene.N)])


def stored_energy(scene: Scene, u: np.ndarray, v: np.ndarray, time: float) -> float:
    """Return the sum of kinetic, contact and foundation energies [J]."""
    bodies = [scene.A0 * math.sin(2 * math.pi * scene.f * time), *u, 0.0]
    contact = sum(0.4 * K * max(0.0, bodies[c] - bodies[c + 1] + (scene.F0 / K) ** (2 / 3)) ** 2.5
                  for c, K in enumerate(stiffness(scene)))
    return contact + sum(0.5 * scene.pattern[0].mass * v**2) + sum(0.5 * scene.k * u**2)
