"""Scenes shared by several tests: the cases of the stored reference."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from granchain_core import Scene, scene
from granchain_core.scene.laws import LAWS as DAMPING_LAWS

#: The values of the knob `dissipation`.
LAWS = (*DAMPING_LAWS, "none")
_REFERENCE = np.load(Path(__file__).parent / "reference" / "reference.npz")


def reference_names() -> list[str]:
    """Return the names of the stored cases."""
    return sorted({key.split("/")[0] for key in _REFERENCE})


def reference(name: str) -> dict:
    """Return the arrays of one stored case, with its `record` parsed from JSON."""
    arrays = {key.split("/")[1]: _REFERENCE[key] for key in _REFERENCE if key.startswith(name + "/")}
    return {**arrays, "record": json.loads(str(arrays["record"]))}


def reference_scene(name: str) -> Scene:
    """Build the scene of a stored case with granchain's own functions, knob by knob."""
    return recorded_scene(reference(name)["record"]["scene"])


def recorded_scene(given: dict) -> Scene:
    """Build the scene in a record of tests/reference with granchain's own functions, knob by knob."""
    base = scene("rig" if given["name"].startswith("rig") else "sec2")
    chosen = base.evolve(f=given["frequency"], A0=given["amplitude"], D=given["damping"], N=given["beads"],
                         kappa=given["kappa"], wall=given["wall"], dissipation=given["law"],
                         tension=given["tension"], F0=given["preload"])
    return replace(chosen, reference_overlap=given["delta_ref"])
