"""Hertz contact of spheres; always present.

Some kernels and closed forms repeat the exponent 3/2; docs/design.md, "The exponent 3/2", lists them.

Equation   F_el = K [δ]_+^{3/2},  potential (2/5) K [δ]_+^{5/2}
Source     Zhang et al. 2016, eqs. (1), (2)
Values     inverse_mass (N+2,) with 0 for driver and wall; stiffness (N+1,) of contacts 0..N, in units of K and m
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_llvm, internal
from ..simd.functions import positive_part, root
from .registry import in_simd_kernels

#: Size of an overlap of which only the sign matters: its force is negligible.
TINY = 1e-300


@in_simd_kernels("rk4", "batch", "dop853_root")
class Chain(NamedTuple):
    """Slot of the chain itself."""

    inverse_mass: np.ndarray
    stiffness: np.ndarray


class FrozenContacts(NamedTuple):
    """Slot of contacts whose state is fixed during an attempt: closed (N+1,) is 0 where a contact stays open."""

    closed: np.ndarray


@by_slot
def closed_overlap(frozen, c, overlap):
    """[δ]_+ of contact c, 0 where `frozen` keeps it open.

    Effect absent: the sign of the overlap decides.
    """
    return positive_part(overlap)


@closed_overlap.of(FrozenContacts)
def _(frozen, c, overlap):
    return positive_part(overlap) if frozen.closed[c] != 0 else 0.0


@inline_llvm
def three_halves(s):
    """s^{3/2}, the power of the elastic force."""
    return s * root(s)


@internal
def elastic_force(stiffness, d):
    """K d^{3/2} for a non-negative overlap d."""
    return stiffness * d * root(d)


@inline_llvm
def elastic_slope(stiffness, d):
    """Tangent stiffness (3/2) K √d, the slope of the elastic force."""
    return 1.5 * stiffness * root(d)


@internal
def elastic_energy(stiffness, d):
    """Elastic energy (2/5) K d^{5/2}."""
    return 0.4 * stiffness * d * d * root(d)
