"""Multipliers of a preloaded chain with small motion, from the matrix exponential of its linear equations."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from granchain_core import Scene
from granchain_core.orbits.orbit import sorted_multipliers


def linear_multipliers(chain: Scene) -> np.ndarray:
    """Return the eigenvalues of exp(A T) for the linearised chain in SI units, largest modulus first."""
    n, mass = chain.N, chain.masses()
    spring = 1.5 * chain.contact_stiffness() * np.sqrt(chain.static_overlap())
    joins = np.zeros((n + 1, n))  # overlap of contact c = u_{c-1} − u_c
    for c in range(n + 1):
        if c > 0:
            joins[c, c - 1] = 1.0
        if c < n:
            joins[c, c] = -1.0
    stiffness, damping = joins.T @ np.diag(spring) @ joins, chain.D * joins.T @ joins
    matrix = np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness / mass[:, None], -damping / mass[:, None]]])
    return sorted_multipliers(expm(matrix * chain.period))
