"""Hertz contact of spheres, always present.

Equation   F_el = K [δ]_+^{3/2},  potential (2/5) K [δ]_+^{5/2}
Source     Zhang et al. 2016, eqs. (1), (2)
Values     inverse_mass (N+2,) with 0 for driver and wall; stiffness (N+1,) of contacts 0..N, in units of K and m
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..jit import kernel
from ..simd.functions import clip, root


class Chain(NamedTuple):
    """Slot of the chain itself."""

    inverse_mass: np.ndarray
    stiffness: np.ndarray


@kernel
def positive_part(overlap):
    """[δ]_+, written so that a NaN overlap stays NaN instead of cutting the chain there."""
    return clip(overlap)


@kernel
def elastic_force(stiffness, d):
    """K d^{3/2} for an overlap d that is already non-negative."""
    return stiffness * d * root(d)


@kernel
def elastic_energy(stiffness, d):
    """(2/5) K d^{5/2}."""
    return 0.4 * stiffness * d * d * root(d)
