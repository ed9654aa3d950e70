"""The Observer page: a chain, its observer under it, the force between them, and their distance over time."""

from __future__ import annotations

from typing import Any

import numpy as np

from granchain_core import Scene

from ...page.frames import prefixed
from ...parts.chain import PALETTE
from ...parts.component import Component, text
from ...scripts import module
from .work import Step


class Observer(Component):
    """The page over the pictures; every period comes as one message."""

    _esm = module("observer.js")
    _stylesheets = [text("controls.css"), text("drawing.css"), text("observer.css")]  # noqa: RUF012


def first_state() -> dict[str, Any]:
    """What the page knows before anything was computed."""
    return {"palette": PALETTE, "kappa": 0.0, "status": "", "sentence": ""}


def step_message(step: Step, scene: Scene, began: bool) -> dict[str, Any]:
    """One drive period for the browser, all series in one array: rows of the chain's, then of the observer's."""
    push = float(np.abs(step.chain_force[:, 0]).max())
    factor, letter = prefixed(push)
    series = (step.chain, step.chain_force, step.chain_energy, step.drive, step.observer, step.observer_force,
              step.observer_energy, step.drive, step.distance)
    return {
        "type": "step", "number": step.number, "began": began, "rows": len(step.distance), "beads": scene.N,
        "samples": step.samples, "radii": [bead.radius for bead in scene.beads], "foundation": scene.k > 0.0,
        "energy_high": max(float(step.chain_energy.max()), 1e-300), "push": f"{push / factor:.3g} {letter}N",
        "frequency": scene.f,
        "values": np.concatenate([one.ravel() for one in series], dtype=np.float32),
    }
