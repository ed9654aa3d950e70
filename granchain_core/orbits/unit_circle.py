"""Which multipliers are outside the unit circle: the one rule by which orbits, branches and attractors are stable."""

from __future__ import annotations

import numpy as np

#: A multiplier this near to the unit circle counts as on it if there is no damping. The multipliers of a stable orbit
#: then lie on the circle, and where two meet, they are known only to about the root of the map's error.
ON_CIRCLE = 1e-6


def least_modulus_outside(damped: bool) -> float:
    """Least modulus of a multiplier that counts as outside the unit circle; `damped`: the contacts lose energy."""
    return 1.0 if damped else 1.0 + ON_CIRCLE


def outside(multipliers: np.ndarray | complex, damped: bool) -> np.ndarray:
    """Whether each multiplier is outside the unit circle; without damping, by `ON_CIRCLE` or more."""
    return np.asarray(np.abs(multipliers) >= least_modulus_outside(damped))


def are_certain(multipliers: np.ndarray, errors: np.ndarray | None, damped: bool) -> bool:
    """Whether the errors leave no doubt that none is outside, or that at least one is; False without errors."""
    sizes, limit = np.abs(multipliers), least_modulus_outside(damped)
    return errors is not None and bool((sizes + errors < limit).all() or (sizes - errors > limit).any())


def nearest_to_circle(multipliers: np.ndarray, errors: np.ndarray, damped: bool) -> int:
    """Index of the multiplier that is the least far from the circle in relation to its error: it leaves the doubt."""
    return int(np.argmin(np.abs(np.abs(multipliers) - least_modulus_outside(damped)) - errors))
