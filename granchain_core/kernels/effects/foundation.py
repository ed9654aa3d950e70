"""A spring from every bead to the ground: the flexures of the rig.

Equation   m_i ü_i = … − k u_i
Source     Zhang et al. 2016, eqs. (3) to (5), figure 8
Values     stiffness: κ = k/(K√A₀), the same for all beads, with K of a contact of two beads like bead 1
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
    """Add −k u to the force on a bead. Effect absent: `force` unchanged."""
    return force


@add_foundation_force.of(Foundation)
def _(foundation, force, u):
    return force - foundation.stiffness * u


@by_slot
def foundation_energy(foundation, u):
    """Spring energy k u²/2."""
    return 0.0


@foundation_energy.of(Foundation)
def _(foundation, u):
    return 0.5 * foundation.stiffness * u * u


@batch_values.of(Foundation)
def _(foundation):
    return Foundation(load_batch(foundation.stiffness, 0))


@by_slot
def add_foundation_slope(foundation, slope, du, factor):
    """Add the change of the force, −k δu, times `factor` to a tangent's slope. Effect absent: the slope unchanged."""
    return slope


@add_foundation_slope.of(Foundation)
def _(foundation, slope, du, factor):
    return slope - du * (factor * foundation.stiffness)
