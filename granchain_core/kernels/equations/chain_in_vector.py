"""The equations of motion of a short chain, whose bodies fit into one vector of 8, 16 or 32 doubles.

Body i is lane i of the displacements and of w, contact c lane c of the overlaps. Bodies beyond the wall have an inverse
mass of 0, and contacts beyond it have no stiffness. rk4/short_chain.py uses these equations for its steps.
dop853_root/chain.py repeats them in a transformed time, with one contact's force written as a power of q.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..compiling.dispatch import by_slot, by_type
from ..compiling.jit import inline_llvm
from ..effects.dissipation import LAWS, unit_primitive
from ..effects.preload import row_overlap, row_values
from ..simd.functions import chain_root, positive_part
from ..simd.vector import blank, from_left, from_right, load8, load16, load32, with_first
from .body_forces import force_on_bead


class Width8(NamedTuple):
    """Up to 8 bodies."""

    width: int = 8


class Width16(NamedTuple):
    """Up to 16 bodies."""

    width: int = 16


class Width32(NamedTuple):
    """Up to 32 bodies."""

    width: int = 32


#: The available widths, by their number of bodies.
CHAIN_WIDTHS: dict[int, Any] = {8: Width8(), 16: Width16(), 32: Width32()}


class ChainValues(NamedTuple):
    """The chain's slots, with the values used at every step as vectors."""

    slots: Any
    inverse_mass: Any
    damping_over_mass: Any
    stiffness: Any
    preload: Any


@by_type
def load_row(width, array, row):
    """Load one row of a (rows, width) array."""


@load_row.of(Width8)
def _(width, array, row):
    return load8(array, row)


@load_row.of(Width16)
def _(width, array, row):
    return load16(array, row)


@load_row.of(Width32)
def _(width, array, row):
    return load32(array, row)


@by_slot
def over_masses(law, inverse_mass):
    """Damping coefficient over the masses, the factor of differences of G/λ. Effect absent: None."""
    return None


@over_masses.of(*LAWS)
def _(law, inverse_mass):
    return law.coefficient * inverse_mass


@by_slot
def chain_velocity(law, w, damping_over_mass, primitives):
    """v = w + (G_{i-1} − G_i)/m of all beads, from G/λ of all contacts."""
    return w


@chain_velocity.of(*LAWS)
def _(law, w, damping_over_mass, primitives):
    return w + damping_over_mass * (from_left(blank(primitives), primitives) - primitives)


@inline_llvm
def chain_values(short, slots):
    """Load the chain's values into registers."""
    width = short.width
    inverse_mass = load_row(width, short.inverse_mass, 0)
    return ChainValues(slots, inverse_mass, over_masses(slots.dissipation, inverse_mass),
                       load_row(width, short.stiffness, 0), row_values(short.preload, load_row, width))


@inline_llvm
def chain_slope(values, u0, u, w):
    """Overlaps, elastic forces, velocities and forces on the beads; the driver's velocity is left at zero."""
    law, here = values.slots.dissipation, with_first(u, u0)
    overlap = row_overlap(values.preload, here, from_right(here, blank(here)))
    d = positive_part(overlap)
    r = chain_root(d)
    e = values.stiffness * d * r
    du = chain_velocity(law, w, values.damping_over_mass, unit_primitive(law, d, r))
    return overlap, e, du, force_on_bead(values.slots, None, from_left(blank(e), e) - e, here, du)
