"""Scenes that several tests need: the cases of the stored reference, and a chain scaled by its symmetry."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from granchain_core import Scene, scene
from granchain_core.scene.laws import LAWS as DAMPING_LAWS

#: What the knob `dissipation` may be.
LAWS = (*DAMPING_LAWS, "none")
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


def scaled(shown: Scene, s: float) -> Scene:
    """The chain with s times the amplitude that moves alike (docs/model.md, "Scaled variables").

    (A0, f, D, F0) → (s A0, s^{1/4} f, s^{1/4 − a} D, s^{3/2} F0) at fixed κ, with the exponent a of the damping law.
    Displacements are s times as large, velocities s^{5/4}, forces s^{3/2}; multipliers are the same.
    """
    a = DAMPING_LAWS[shown.dissipation].exponent if shown.dissipation in DAMPING_LAWS else 0.0
    return shown.evolve(A0=s * shown.A0, f=s**0.25 * shown.f, D=s ** (0.25 - a) * shown.D, F0=s**1.5 * shown.F0,
                        kappa=shown.kappa)
