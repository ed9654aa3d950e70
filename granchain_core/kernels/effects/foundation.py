"""Spring from every bead to the ground: the flexures of the rig.

Equation   m_i ü_i = … − k u_i
Source     Zhang et al. 2016, eqs. (3) to (5), figure 8
Values     stiffness: κ = k/(K√A₀) with K of the contact of two beads like bead 1, the same for all beads
"""

from __future__ import annotations

from typing import NamedTuple

from ..compiling.dispatch import by_slot
from ..simd.vector import load_batch
from .batch_values import batch_values
from .registry import in_simd_kernels


@in_simd_kernels("rk4", "batch", "dop853_root")
class Foundation(NamedTuple):
    """Slot of the foundation spring."""

    stiffness: float


@by_slot
def add_foundation_force(foundation, force, u):
    """Force on a bead, `force` with −k u added. Effect absent: `force` itself."""
    return force


@add_foundation_force.of(Foundation)
def _(foundation, force, u):
    return force - foundation.stiffness * u


@by_slot
def foundation_energy(foundation, u):
    """k u²/2."""
    return 0.0


@foundation_energy.of(Foundation)
def _(foundation, u):
    return 0.5 * foundation.stiffness * u * u


@batch_values.of(Foundation)
def _(foundation):
    return Foundation(load_batch(foundation.stiffness, 0))


@by_slot
def add_foundation_slope(foundation, slope, du, factor):
    """A tangent's slope with the change of the force, −k δu, times `factor` added. Effect absent: the slope itself."""
    return slope


@add_foundation_slope.of(Foundation)
def _(foundation, slope, du, factor):
    return slope - du * (factor * foundation.stiffness)
