"""The chain itself, the replay clock and the time cursor, all drawn in the browser from one set of frames."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from granchain_core import Scene

from ...format import prefixed
from ...frames import Extremes, Frames, chain_series, drawn_values
from ...scripts import module
from ...session.share import VIEW_VALUES, encode
from ..toolkit.component import Component, text

#: The scales of the pictures: the text of each button, and its meaning.
_SCALES = {
    "same": ("same scale", "One scale for all pictures of this scene: its axes and colours end at the largest values "
             "at any drive frequency, so that strong and weak motions can be compared. A larger motion widens it; "
             "a click restores the scene's own scale"),
    "fit": ("fit", "Every picture fills its frame: weak motions are visible, but cannot be compared"),
}
SCALES = [(scale, *_SCALES[scale]) for scale in VIEW_VALUES["scale"]]


class ChainPart(Component):
    """Beads, contacts, driver and wall; the frames arrive as single-precision arrays."""

    _esm = module("chain.js")
    _stylesheets = [text("chain.css")]  # noqa: RUF012  (Panel's own class attribute)


def frames_message(number: int, frames: Frames, scene: Scene, scale: Extremes, fit: bool,
                   peaks: list[list[str]], live: bool, running: bool, final: bool) -> dict[str, Any]:
    """Return the data from which the browser draws the chain at every instant; for a live run, only at the present.

    `scale` has the largest values that the chain and its colours are drawn to; a fitted chain finds its own. `peaks`
    are the largest and the smallest input and output force in words. A `final` picture is the last and best one of
    these knobs.
    """
    return {
        "type": "frames",
        "number": number,
        "live": live,
        "final": final,
        "rows": 1 if running else frames.rows,
        "samples": frames.samples,
        "scene": scene.name,
        "f": scene.f,
        "knobs": encode(scene, {}),
        **drawn_chain(scene),
        "energy_high": scale.kinetic_energy,
        "energy_labels": energy_labels(scale.kinetic_energy),
        "fit": fit,
        "driven": scene.is_driven,
        "peaks": peaks,
        "scale": None if fit else {"largest": scale.displacement, "overlap": scale.overlap,
                                   "force": max(scale.input_force, scale.output_force)},
        "sent": time.time(),
        "values": _present(frames) if running else frames.chain,
    }


def _present(frames: Frames) -> np.ndarray:
    """Return the values of the last row only."""
    return drawn_values(chain_series(frames.displacement[-1:], frames.force[-1:], frames.kinetic_energy[-1:],
                                     frames.drive_displacement[-1:]))


def energy_labels(high: float) -> list[str]:
    """Return the labels at the start, in the middle and at the end of a colour bar up to `high` [J].

    The bar is linear in the square root of the energy, so its middle stands for a quarter of `high`.
    """
    factor, letter = prefixed(high)
    return ["0", f"{high / 4 / factor:.3g}", f"{high / factor:.3g} {letter}J"]


def drawn_chain(scene: Scene) -> dict[str, Any]:
    """Return the properties of a chain, in addition to its motion, that chain_drawing.js draws."""
    return {"beads": scene.N, "radii": [bead.radius for bead in scene.beads], "foundation": scene.k > 0.0}
