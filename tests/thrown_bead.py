"""Touches with a closed form: the speed of a bead that the driver just reaches."""

from __future__ import annotations

import numpy as np


def thrown_by_a_touch(depth: float, beta: float) -> float:
    """Return the speed of a bead of mass and stiffness 1, at rest before a driver sin βt overlaps it by up to `depth`.

    The impulse is ∫(depth − θ²/2)^{3/2} dθ/β over the touch, with θ = βt counted from the driver's turning point, which
    is (3π√2/8)·depth²/β as long as the bead hardly moves during the touch. The bead's own motion and the terms of cos θ
    beyond θ² are corrections of relative order depth.
    """
    return 3.0 * np.pi * np.sqrt(2.0) / 8.0 * depth**2 / beta
