"""A short chain in one vector of 8, 16 or 32 doubles, up to 30 beads: RK4 split at contact events.

Body i is lane i of the displacements and of w, contact c lane c of the overlaps; bodies beyond the wall have an
inverse mass of 0 and contacts beyond it no stiffness. A step evaluates three slopes and the one at its end, which is
the next step's first. Nothing is evaluated twice, and only the forces at the two ends go through memory.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.jit import by_slot, by_type, inline_llvm
from ..effects.contact import positive_part
from ..effects.dissipation import LAWS, unit_primitive
from ..effects.preload import row_overlap, row_values
from ..equations.body_forces import force_on_bead
from ..simd.functions import root
from ..simd.vector import blank, from_left, from_right, load, load16, load32, store, with_first
from ..step_ends import OVERLAP_AT, RATE_AT


class Width8(NamedTuple):
    """Up to 8 bodies."""

    lanes: int = 8


class Width16(NamedTuple):
    """Up to 16 bodies."""

    lanes: int = 16


class Width32(NamedTuple):
    """Up to 32 bodies."""

    lanes: int = 32


#: The widths there are, by their number of bodies.
CHAIN_WIDTHS: dict[int, Any] = {8: Width8(), 16: Width16(), 32: Width32()}

#: The chain at a step's beginning and at its end in the workspace; the vectors of each, one a row, and their number.
BEGIN, END = 0, 1
U, W, DU, NET_FORCE, ELASTIC, STATE_ROWS = range(6)
#: Steps whose forces are searched together.
STEPS_IN_BLOCK = 32


class ShortChain(NamedTuple):
    """Workspace of a chain of up to `width` bodies: values padded with zeros (1, width), `rows` (10, width) of states.

    `ends` (END_ROWS, width) are overlaps and rates at the ends of a step that is split (step_ends.py), `forces`
    (3, STEPS_IN_BLOCK) input force, output force and its elastic part of the last steps.
    """

    width: Any
    inverse_mass: np.ndarray
    stiffness: np.ndarray
    preload: Any
    rows: np.ndarray
    ends: np.ndarray
    forces: np.ndarray


class ChainValues(NamedTuple):
    """The chain's slots, and those of its values that are vectors."""

    slots: Any
    inverse_mass: Any
    damping_over_mass: Any
    stiffness: Any
    preload: Any


class ChainState(NamedTuple):
    """The chain at one instant: state, velocities, forces on the beads, overlaps, their rates, elastic forces."""

    u: Any
    w: Any
    du: Any
    net_force: Any
    overlap: Any
    rate: Any
    elastic: Any


@by_type
def load_row(width, array, row):
    """One row of a (rows, width) array."""


@load_row.of(Width8)
def _(width, array, row):
    return load(array, row)


@load_row.of(Width16)
def _(width, array, row):
    return load16(array, row)


@load_row.of(Width32)
def _(width, array, row):
    return load32(array, row)


@by_slot
def over_masses(law, inverse_mass):
    """The damping coefficient over the masses, by which differences of G/λ are multiplied. Absent: None."""
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
    """The chain's values in registers."""
    width = short.width
    inverse_mass = load_row(width, short.inverse_mass, 0)
    return ChainValues(slots, inverse_mass, over_masses(slots.dissipation, inverse_mass),
                       load_row(width, short.stiffness, 0), row_values(short.preload, load_row, width))


@inline_llvm
def chain_slope(values, u0, u, w):
    """Overlaps, elastic forces, velocities and forces on the beads; the driver's own velocity is left at zero."""
    law, here = values.slots.dissipation, with_first(u, u0)
    overlap = row_overlap(values.preload, here, from_right(here, blank(here)))
    d = positive_part(overlap)
    r = root(d)
    e = values.stiffness * d * r
    du = chain_velocity(law, w, values.damping_over_mass, unit_primitive(law, d, r))
    return overlap, e, du, force_on_bead(values.slots, None, from_left(blank(e), e) - e, here, du)


@inline_llvm
def chain_at(values, u0, v0, u, w):
    """The chain in state (u, w) with the driver at u0, moving at v0."""
    overlap, e, du, net_force = chain_slope(values, u0, u, w)
    moving = with_first(du, v0)
    return ChainState(u, w, du, net_force, overlap, moving - from_right(moving, blank(moving)), e)


@inline_llvm
def chain_step(values, ua, ub, vb, h, x, shift, impulse):
    """One RK4 step from x; the driver at ua at mid-step, at ub, moving at vb, at the end.

    `shift` and `impulse` are added to displacements and w at the end.
    """
    half, sixth = 0.5 * h, h / 6.0
    half_m, whole_m, sixth_m = half * values.inverse_mass, h * values.inverse_mass, sixth * values.inverse_mass
    _, _, du2, net_force2 = chain_slope(values, ua, x.u + half * x.du, x.w + half_m * x.net_force)
    _, _, du3, net_force3 = chain_slope(values, ua, x.u + half * du2, x.w + half_m * net_force2)
    _, _, du4, net_force4 = chain_slope(values, ub, x.u + h * du3, x.w + whole_m * net_force3)
    return chain_at(values, ub, vb, x.u + sixth * (x.du + du4 + 2.0 * (du2 + du3)) + shift,
                  x.w + sixth_m * (x.net_force + net_force4 + 2.0 * (net_force2 + net_force3)) + impulse)


@inline_llvm
def store_state(short, end, x):
    """Write the chain at a step's beginning or end into the workspace."""
    first = STATE_ROWS * end
    store(short.rows, first + U, x.u)
    store(short.rows, first + W, x.w)
    store(short.rows, first + DU, x.du)
    store(short.rows, first + NET_FORCE, x.net_force)
    store(short.rows, first + ELASTIC, x.elastic)
    store(short.ends, OVERLAP_AT[end], x.overlap)
    store(short.ends, RATE_AT[end], x.rate)


@inline_llvm
def load_state(short, end):
    """The chain at a step's beginning or end from the workspace."""
    width, rows, first = short.width, short.rows, STATE_ROWS * end
    return ChainState(
        load_row(width, rows, first + U), load_row(width, rows, first + W), load_row(width, rows, first + DU),
        load_row(width, rows, first + NET_FORCE), load_row(width, short.ends, OVERLAP_AT[end]),
        load_row(width, short.ends, RATE_AT[end]), load_row(width, rows, first + ELASTIC))


@inline_llvm
def chain_correction(values, excess):
    """Correction of the beads' displacements or w, from the quadrature errors of their contacts."""
    return values.inverse_mass * (excess - from_left(blank(excess), excess))
