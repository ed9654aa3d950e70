"""The stated errors of a periodic orbit, of its displacements and largest forces: one rule for all results."""

from __future__ import annotations

import numpy as np

from ..integrate import Engine, MethodSetting
from ..integrate.methods import jump_errors, typical_error
from ..integrate.safety_factors import IRREGULAR, ORBIT_FORCES
from ..integrate.scaling import ScaledChain
from ..integrate.stated import relative_changes
from ..scene.hertz import EXPONENT, OVERLAP_POWER


def force_distances(distance: float, scaled: ScaledChain, maxima: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Relative changes (3,) of the largest forces over a relative `distance` between states.

    The distance is relative to the largest displacement of the scaled state y, but a force depends on its overlap as
    F ∝ δ^p, so its relative change is p times that of the overlap. Where the first or last contact overlaps by less
    than the largest displacement, as in the stop band, the same distance changes its force by a larger fraction.
    `maxima` are the scaled forces.
    """
    stiffness = scaled.slots.chain.stiffness
    largest = float(np.abs(scaled.rows(y)[0]).max())
    overlaps = [(max(0.0, float(force)) / float(stiffness[c])) ** OVERLAP_POWER
                for force, c in zip(maxima, (0, -1, -1), strict=True)]
    nearer = [largest / overlap if 0.0 < overlap < largest else 1.0 for overlap in overlaps]
    return EXPONENT * distance * np.array(nearer)


def error_of_displacements(change: float, finer: MethodSetting, contraction: float) -> float:
    """Relative error of the displacements on an orbit, from the relative `change` from one computation to a finer one.

    Both began in the same state. `finer` is the setting of the finer one, whose typical error is the least, because two
    computations may agree by chance. Contact events make the error fall irregularly, and an error of the n-period map
    moves its fixed point by about 1/(1 − contraction) times that error.
    """
    return max(IRREGULAR * change, typical_error(finer)) / (1.0 - contraction)


def errors_of_map(change: np.ndarray, least_errors: float, contraction: float) -> np.ndarray:
    """Relative errors (3,) of the largest forces on an orbit that was computed twice from one state.

    `change` (3,) is the relative change of the forces from one computation of the orbit to a finer one, both from the
    same state. `least_errors` is the typical error of the finer one, a lower limit because two may agree by chance. An
    error ε of the n-period map moves its fixed point by ε/(1 − contraction), and the forces with it. `contraction` is
    the factor per orbit: |μ|, or otherwise the observed contraction factor.
    """
    return np.maximum(ORBIT_FORCES * change, least_errors) / (1.0 - contraction)


def errors_of_two_orbits(change: np.ndarray, least_errors: float, contraction: float) -> np.ndarray:
    """Relative errors (3,) of the largest forces where each of two computations reached its own orbit.

    `change` (3,) is then the difference between these orbits and already contains the factor 1/(1 − contraction). Only
    `least_errors`, the typical error of the finer map, is enlarged by it.
    """
    return np.maximum(ORBIT_FORCES * change, least_errors / (1.0 - contraction))


def errors_between(finer: Engine, before: np.ndarray, contraction: float, distance: float) -> np.ndarray:
    """Relative errors (3,) of the largest forces that `finer` found along one orbit; a coarser run found `before`.

    Both started in the same state, at a relative `distance` from the orbit; `contraction` is the factor per orbit. The
    contribution of the distance (`force_distances`) and the errors at jumps are added.
    """
    step = finer.setting.step(finer.scaled, finer.samples)
    jumps = jump_errors(finer.setting, finer.scaled, step, finer.jumps, finer.maxima)
    left = force_distances(distance, finer.scaled, finer.maxima, finer.y)
    change = relative_changes(finer.maxima, before)
    return errors_of_map(change, typical_error(finer.setting), contraction) + left + jumps
