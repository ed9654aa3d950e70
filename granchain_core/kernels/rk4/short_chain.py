"""A short chain: RK4 split at contact events, in one vector (equations/chain_in_vector.py).

A step evaluates three slopes and the slope at its end, which is the first of the next step. Nothing is evaluated twice.
Between contact events, only the forces at the two ends of the chain are written to arrays.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.jit import inline_llvm
from ..equations.chain_in_vector import chain_slope, load_row
from ..simd.vector import blank, from_left, from_right, store, with_first
from ..step_ends import OVERLAP_AT, RATE_AT

#: The chain at a step's start and end in the workspace; the rows of vectors for each, and their number.
BEGIN, END = 0, 1
U, W, DU, NET_FORCE, ELASTIC, STATE_ROWS = range(6)
#: Steps whose forces are searched together.
STEPS_IN_BLOCK = 32


class ShortChain(NamedTuple):
    """Workspace of a chain of up to `width` bodies: values padded with zeros (1, width), `rows` (10, width) of states.

    `ends` (END_ROWS, width) are overlaps and rates at the ends of a split step (step_ends.py); `forces` (3,
    STEPS_IN_BLOCK) are the input force, the output force and its elastic part in the last steps.
    """

    width: Any
    inverse_mass: np.ndarray
    stiffness: np.ndarray
    preload: Any
    rows: np.ndarray
    ends: np.ndarray
    forces: np.ndarray


class ChainState(NamedTuple):
    """The chain at one instant: state, velocities, forces on the beads, overlaps, their rates, elastic forces."""

    u: Any
    w: Any
    du: Any
    net_force: Any
    overlap: Any
    rate: Any
    elastic: Any


@inline_llvm
def chain_at(values, u0, v0, u, w):
    """Evaluate the chain in state (u, w) with the driver at u0, moving at v0."""
    overlap, e, du, net_force = chain_slope(values, u0, u, w)
    moving = with_first(du, v0)
    return ChainState(u, w, du, net_force, overlap, moving - from_right(moving, blank(moving)), e)


@inline_llvm
def chain_step(values, ua, ub, vb, h, x, shift, impulse):
    """Take one RK4 step from x; the driver is at ua at mid-step, and at ub, moving at vb, at the end.

    `shift` and `impulse` are added to the displacements and to w at the end.
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
    """Write the chain at a step's start or end into the workspace."""
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
    """Read the chain at a step's start or end from the workspace."""
    width, rows, first = short.width, short.rows, STATE_ROWS * end
    return ChainState(
        load_row(width, rows, first + U), load_row(width, rows, first + W), load_row(width, rows, first + DU),
        load_row(width, rows, first + NET_FORCE), load_row(width, short.ends, OVERLAP_AT[end]),
        load_row(width, short.ends, RATE_AT[end]), load_row(width, rows, first + ELASTIC))


@inline_llvm
def chain_correction(values, excess):
    """Correction of the beads' displacements or w, from the quadrature errors of their contacts."""
    return values.inverse_mass * (excess - from_left(blank(excess), excess))
