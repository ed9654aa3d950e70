"""Chains that tests need and the product does not offer: without a driver, and the stored reference as scenes."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from granchain_core import Scene, State, scene
from granchain_core.integrate import Engine, Setting
from granchain_core.kernels.effects.dissipation import LinearDashpot, Tsuji
from granchain_core.kernels.effects.driver import Harmonic

LAWS = ("linear", "tsuji", "kuwabara-kono", "none")
_REFERENCE = np.load(Path(__file__).parent / "reference" / "reference.npz")


def reference_names() -> list[str]:
    """Names of the stored cases."""
    return sorted({key.split("/")[0] for key in _REFERENCE})


def reference(name: str) -> dict:
    """Arrays of one stored case, its `record` read as JSON."""
    arrays = {key.split("/")[1]: _REFERENCE[key] for key in _REFERENCE if key.startswith(name + "/")}
    return {**arrays, "record": json.loads(str(arrays["record"]))}


def reference_scene(name: str) -> Scene:
    """The stored case as a scene of the product, knob by knob."""
    return recorded_scene(reference(name)["record"]["scene"])


def recorded_scene(given: dict) -> Scene:
    """The scene in a record of tests/reference as one of the product, knob by knob."""
    base = scene("rig" if given["name"].startswith("rig") else "sec2")
    chosen = base.evolve(f=given["frequency"], A0=given["amplitude"], D=given["damping"], N=given["beads"],
                         kappa=given["kappa"], wall=given["wall"], dissipation=given["law"],
                         tension=given["tension"], F0=given["preload"])
    return replace(chosen, reference_overlap=given["delta_ref"])


class Undriven:
    """Beads with nothing on their left, in scaled units (K = m = 1), by the certified method.

    The wall stands at contact N with stiffness `wall`; a dissipation law may act in every contact. With `stands` the
    driver is there and does not move.
    """

    def __init__(self, beads: int, law: LinearDashpot | Tsuji, time: float, samples: int, wall: float = 1.0,
                 tolerance: float = 1e-13, stands: bool = False) -> None:
        # The drive period of the scene is only the clock here: one "period" is the whole time of interest.
        base = scene("sec2").evolve(N=beads, wall=wall)
        rate = Engine(base, Setting("dop853", tolerance=1e-3)).lowered.scales.rate
        self.engine = Engine(base.evolve(f=rate / time), Setting("dop853", tolerance=tolerance), samples)
        lowered = self.engine.lowered
        driver = Harmonic(0.0, lowered.beta) if stands else None
        self.engine.use(replace(lowered, slots=lowered.slots._replace(driver=driver, dissipation=law)))
        self.time = np.linspace(0.0, time, samples + 1)

    def run(self, velocity: np.ndarray):
        """Scaled samples of the motion from zero displacement with these scaled velocities."""
        scales = self.engine.lowered.scales
        self.engine.start(State(np.zeros(len(velocity)), velocity * scales.velocity))
        return self.engine.record(self.engine.samples)
