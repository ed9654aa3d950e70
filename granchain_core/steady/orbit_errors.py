"""The stated errors of the largest forces on a periodic orbit: one rule for pictures, curves and maps."""

from __future__ import annotations

import numpy as np

from ..result import CAUTION

#: F ∝ δ^{3/2}: a relative change of the overlap is half as much again in the force.
_FORCE_PER_OVERLAP = 1.5


def orbit_force_errors(change: np.ndarray | float, distance: float, slowness: float = 0.0,
                       further: np.ndarray | float = 0.0, least: float = 0.0) -> np.ndarray:
    """Relative errors of the three largest forces on an orbit at the relative `distance` from the true one.

    `change` (3,) is the relative change of the forces from one computation to a finer one. Where both began in the same
    state, `slowness` is |μ|, the part of a distance that is left after an orbit: an error e of the n-period map moves
    its fixed point by e/(1 − |μ|), and the forces with it. Where each ran on its own orbit it is 0. `further` errors
    (3,), as of jumps, are added. `least` is the typical error of the finer computation: two may agree by chance.
    """
    return np.asarray(np.maximum(CAUTION * change, least) / (1.0 - slowness) + _FORCE_PER_OVERLAP * distance + further)
