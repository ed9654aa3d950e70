"""Beads or contacts that differ from the first bead: dimers, impurities, soft beads.

Equation   m_i and K_c in units of the first bead's
Values     inverse_mass (N+2, L) and stiffness (N+1, L) for all L members
Absent     all beads are equal: the wall's stiffness is the only factor in a batch
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..simd.vector import load_like


class Unequal(NamedTuple):
    """Slot of chains whose beads are not all equal."""

    inverse_mass: np.ndarray
    stiffness: np.ndarray


@by_slot
def over_mass(unequal, i, force):
    """A force on bead i over its mass. Effect absent: the force unchanged."""
    return force


@over_mass.of(Unequal)
def _(unequal, i, force):
    return load_like(force, unequal.inverse_mass, i) * force


@by_slot
def times_stiffness(unequal, wall, i, is_wall, elastic):
    """The elastic force of contact i from d^{3/2}; `wall` is the last contact's stiffness.

    Effect absent: all other stiffnesses are 1.
    """
    return wall * elastic if is_wall else elastic


@times_stiffness.of(Unequal)
def _(unequal, wall, i, is_wall, elastic):
    return load_like(elastic, unequal.stiffness, i) * elastic
