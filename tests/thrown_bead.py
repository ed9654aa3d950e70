"""Touches with a closed form: what a driver that just reaches a bead does to it."""

from __future__ import annotations

import numpy as np


def thrown_by_a_touch(depth: float, beta: float) -> float:
    """Speed of a bead at rest, of mass and stiffness 1, after a driver sin θ at θ = βt reached `depth` into it.

    The push is ∫(depth − θ²/2)^{3/2} dθ/β over the touch, (3π√2/8)·depth²/β, as long as the bead hardly moves
    meanwhile. The bead's own motion and cos θ are corrections of order depth.
    """
    return 3.0 * np.pi * np.sqrt(2.0) / 8.0 * depth**2 / beta
