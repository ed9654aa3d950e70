"""Invariants of every scene; each function returns its violation, relative to the largest displacement."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from granchain_core import Scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.scaling import ScaledChain, scale_chain
from granchain_core.kernels.effects.contact import Chain
from granchain_core.kernels.effects.driver import Harmonic
from granchain_core.kernels.effects.preload import Preload
from granchain_core.kernels.samples import Samples
from granchain_core.scene.state import State, rest

SAMPLES = 16
_FIXED = MethodSetting("rk4-split", 1.0)
#: Scaled time of the mirrored motions, long enough for dozens of contacts and too short for chaos to magnify rounding.
_TIME = 20.0


def distance(one: np.ndarray, two: np.ndarray) -> float:
    """Return the largest difference over the largest value of the second array; NaN if either contains NaN."""
    largest = float(np.abs(two).max())
    return float(np.abs(one - two).max()) / largest if largest > 0.0 else float(np.abs(one).max())


def energy(scaled: ScaledChain, kept: Samples) -> float:
    """Return how far work − lost is from the stored energy, ½mv² + ⅖Kδ^{5/2} + ½ku², over the largest of the three."""
    slots = scaled.slots
    masses, theta = 1.0 / slots.chain.inverse_mass[1:-1], 2.0 * np.pi * np.arange(len(kept.velocity)) / SAMPLES
    ends = np.zeros((len(theta), 1))
    bodies = np.hstack([np.sin(theta)[:, None], kept.displacement, ends])
    pressed = np.maximum(bodies[:, :-1] - bodies[:, 1:] + (0.0 if slots.preload is None else slots.preload.static), 0.0)
    stored = (0.5 * (kept.velocity**2) @ masses + 0.4 * pressed**2.5 @ slots.chain.stiffness[: len(masses) + 1]
              + (0.0 if slots.foundation is None else 0.5 * slots.foundation.stiffness * (kept.displacement**2).sum(axis=1)))
    assert kept.energy is not None
    _, work, lost = (kept.energy - kept.energy[0]).T
    largest = max(np.abs(work).max(), np.abs(lost).max(), stored.max())
    return float(np.abs(work - lost - (stored - stored[0])).max() / largest)


def scaling(scene: Scene, power: int, stop: Stop) -> float:
    """Compare a period with that at (sA0, s^{1/4} f, s^{1/4} D), s = 16^power, where the scaled motion is the same."""
    root = 2.0**power
    s = root**4
    other = replace(scene, A0=s * scene.A0, f=root * scene.f, D=root * scene.D, k=root**2 * scene.k, F0=root**6 * scene.F0,
                    reference_overlap=s * scene.reference_overlap,
                    start_velocity=tuple((i, root**5 * v) for i, v in scene.start_velocity))
    return distance(_period(other, rest(other), stop), _period(scene, rest(scene), stop))


def _period(scene: Scene, start: State, stop: Stop) -> np.ndarray:
    engine = Engine(scene, _FIXED, SAMPLES, account=True, stop=stop)
    engine.start(start)
    return engine.record(SAMPLES).displacement


def shifted(scene: Scene, stop: Stop) -> float:
    """Compare the second period of a run with a run started from the state after the first."""
    engine = Engine(scene, _FIXED, SAMPLES, account=True, stop=stop)
    engine.start(rest(scene))
    engine.record(SAMPLES)
    again = engine.state
    return distance(_period(scene, again, stop), engine.record(SAMPLES).displacement)


def mirrored(scene: Scene, rng: np.random.Generator, stop: Stop) -> tuple[float, float, float]:
    """Make the scene its own mirror image, with its driver at rest, and return three differences.

    They are how far a symmetric start departs from symmetry, how far a start and its mirror image differ, and how much
    the method's own error changes the latter motion.
    """
    symmetric = _symmetric(scene)
    thrown = rng.uniform(-1.0, 1.0, scene.N)
    even = _thrown(symmetric, thrown - thrown[::-1], 1e-15, stop)
    one, two = (_thrown(symmetric, v, 1e-15, stop) for v in (thrown, -thrown[::-1]))
    return distance(-even[:, ::-1], even), distance(-two[:, ::-1], one), distance(_thrown(symmetric, thrown, 1e-13, stop), one)


def _symmetric(scene: Scene) -> ScaledChain:
    scaled = scale_chain(scene, account=True)
    slots = scaled.slots

    def both(values: np.ndarray) -> np.ndarray:
        return 0.5 * (values + values[::-1])

    beta = 2.0 * np.pi / _TIME
    preload = None if slots.preload is None else Preload(both(slots.preload.static))
    stiffness = slots.chain.stiffness.copy()
    stiffness[: scene.N + 1] = both(stiffness[: scene.N + 1])
    return replace(scaled, beta=beta, slots=slots._replace(
        chain=Chain(both(slots.chain.inverse_mass), stiffness), driver=Harmonic(0.0, beta), preload=preload))


def _thrown(scaled: ScaledChain, velocity: np.ndarray, tolerance: float, stop: Stop) -> np.ndarray:
    engine = Engine(scaled.scene, MethodSetting("dop853", tolerance=tolerance), SAMPLES, stop=stop, scaled=scaled)
    engine.start(State(np.zeros(len(velocity)), velocity * scaled.scales.velocity))
    return engine.record(SAMPLES).displacement
