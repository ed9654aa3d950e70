"""The chain itself, the replay clock and the time cursor, all drawn in the browser from one set of frames."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from bokeh.palettes import Inferno256

from granchain_core import Scene

from ..format import prefixed
from ..frames import Frames
from ..scripts import module
from .component import Component, text


class Chain(Component):
    """Beads, contacts, driver and wall; the frames come as single-precision arrays."""

    _esm = module("chain.js")
    _stylesheets = [text("chain.css")]  # noqa: RUF012  (Panel's own class attribute)


PALETTE = list(Inferno256)


def frames_message(number: int, frames: Frames, scene: Scene, scale: float, live: bool,
                   running: bool) -> dict[str, Any]:
    """What the browser needs to draw the chain at every instant; a running chain only has a now."""
    factor, letter = prefixed(scale)
    rows = slice(-1, None) if running else slice(None)
    return {
        "type": "frames",
        "number": number,
        "live": live,
        "rows": 1 if running else frames.rows,
        "beads": frames.beads,
        "samples": frames.samples,
        "radii": [bead.radius for bead in scene.beads],
        "foundation": scene.knobs["k"] > 0.0,
        "energy_high": scale,
        "energy_label": f"{scale / factor:g} {letter}J",
        "sent": time.time(),
        # One array, because every array is two messages on the websocket.
        "values": np.concatenate([series[rows].ravel() for series in (
            frames.displacement, frames.force, frames.kinetic_energy, frames.drive_displacement)], dtype=np.float32),
    }
