"""The stated errors of the largest forces on a periodic orbit: one rule for pictures, curves and maps."""

from __future__ import annotations

import numpy as np

from ..integrate import Engine
from ..integrate.methods import jump_errors, typical_error
from ..integrate.safety_factors import ORBIT_FORCES
from ..integrate.stated import relative_changes
from ..scaling import ScaledChain

#: F ∝ δ^{3/2}: a relative change of the overlap is half as much again in the force.
_FORCE_PER_OVERLAP = 1.5


def force_distances(distance: float, scaled: ScaledChain, maxima: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Relative changes (3,) of the largest forces over a relative `distance` of states.

    The distance is relative to the largest displacement of the scaled state y, but a force depends on its overlap.
    Where a contact of the first or last bead overlaps less than that, as in the stop band, the same distance changes
    its force by a larger part. `maxima` are the scaled forces.
    """
    stiffness = scaled.slots.chain.stiffness
    largest = float(np.abs(scaled.rows(y)[0]).max())
    overlaps = [(max(0.0, float(force)) / float(stiffness[c])) ** (1.0 / _FORCE_PER_OVERLAP)
                for force, c in zip(maxima, (0, -1, -1), strict=True)]
    nearer = [largest / overlap if 0.0 < overlap < largest else 1.0 for overlap in overlaps]
    return _FORCE_PER_OVERLAP * distance * np.array(nearer)


def orbit_force_errors(change: np.ndarray | float, distance: np.ndarray | float, contraction: float = 0.0,
                       further: np.ndarray | float = 0.0, least: float = 0.0) -> np.ndarray:
    """Relative errors of the three largest forces on an orbit: of its integration, and of the distance left to it.

    `change` (3,) is the relative change of the forces from one computation to a finer one. If both began in the same
    state, `contraction` is the contraction factor per orbit (|μ|, or else the decay seen): an error
    ε of the n-period map moves its fixed point by ε/(1 − contraction), and the forces with it. If each ran on its own
    orbit, it is 0. `distance` (3,) is what the distance left contributes (`force_distances`), and `further` errors
    (3,), such as those at jumps, are added. `least` is the typical error of the finer
    computation, because two may agree by chance. Like `change` it is divided by 1 − `contraction` here; a caller whose
    `contraction` is 0 because each ran on its own orbit divides it beforehand.
    """
    return np.asarray(np.maximum(ORBIT_FORCES * change, least) / (1.0 - contraction) + distance + further)


def errors_between(finer: Engine, before: np.ndarray, contraction: float, distance: float) -> np.ndarray:
    """Relative errors (3,) of the largest forces that `finer` found in one orbit; a coarser run found `before`.

    Both began at the relative `distance` from the orbit; `contraction` is the contraction factor per orbit.
    """
    step = finer.setting.step(finer.scaled, finer.samples)
    jumps = jump_errors(finer.setting, finer.scaled, step, finer.jumps, finer.maxima)
    left = force_distances(distance, finer.scaled, finer.maxima, finer.y)
    return orbit_force_errors(relative_changes(finer.maxima, before), left, contraction, jumps,
                              typical_error(finer.setting))
