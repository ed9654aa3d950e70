"""The tangent flow in (u, w): how neighbouring motions grow or shrink along one.

Equation   δu̇_i = δw_i + (g_{i-1} δδ_{i-1} − g_i δδ_i)/m_i
           m_i δẇ_i = s_{i-1} δδ_{i-1} − s_i δδ_i − k δu_i,   δδ_c = δu_c − δu_{c+1},   s = (3/2) K √δ
Method     The right-hand side is continuous in w, so the tangents cross contact events without a jump (the saltation of
           the (u, v) form is inside the change of variables). They are integrated with the stages of the accepted
           step of the motion itself, eight columns in one vector.
Check      ∫ trace = −∫ Σ_c g_c (1/m_c + 1/m_{c+1}) dt is the logarithm of the determinant (Liouville).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contact_cubic import TINY
from ..dop853.tableau import STAGES, A, C
from ..effects.contact import elastic_slope, positive_part
from ..effects.dissipation import damping
from ..effects.foundation import foundation_pull
from ..effects.preload import overlap
from ..jit import by_slot, inline_llvm, inline_numba, internal
from ..simd.vector import blank, load, store
from .attempt import keep_gaps
from .time_map import rate_at


class Tangent(NamedTuple):
    """Tangent vectors as columns in blocks of eight, and workspaces.

    `matrix` (blocks · 2N, 8): rows δu_1..δu_N, then δw_1..δw_N of the first eight columns, then of the next.
    `gaps`, `stiffness`, `damping` (stages, N+1); `slopes` (2N · stages, 8) and `state` (2N, 8) of one block; `weights`
    (stages + 1, stages) are the step's size times the tableau.
    `first_contact` is 0, or 1 for the observer, on which the driver acts by a given force.
    """

    matrix: np.ndarray
    gaps: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    slopes: np.ndarray
    state: np.ndarray
    weights: np.ndarray
    first_contact: int


@internal
def stage_gaps(slots, state, stage, gaps):
    """Write the overlaps of one stage's state."""
    for c in range(gaps.shape[1]):
        gaps[stage, c] = overlap(slots.preload, state, c)


@keep_gaps.of(Tangent)
def _(tangent, slots, state, slope, stage):
    stage_gaps(slots, state, stage, tangent.gaps)


@by_slot
def carry(tangent, slots, time, h, contacts):
    """Carry the tangents through the accepted step of size h; returns its share of ∫ trace. Absent: there are none."""
    return 0.0


@carry.of(Tangent)
def _(tangent, slots, time, h, contacts):
    share = linearise(slots, time, h, contacts, tangent)
    for stage in range(STAGES + 1):
        for earlier in range(stage):
            tangent.weights[stage, earlier] = h * A[stage, earlier]
    rows = tangent.state.shape[0]
    for first in range(0, tangent.matrix.shape[0], rows):
        carry_block(slots, time, h, tangent, first)
    return share


@inline_numba
def linearise(slots, time, h, contacts, tangent):
    """Tangent stiffness s and damping g of every contact in every stage, times dt/dx; returns ∫ trace over the step.

    A contact that is closed has the damping of one though rounding may have its overlap below zero.
    """
    trace, inverse_mass = 0.0, slots.chain.inverse_mass
    for stage in range(STAGES):
        rate = rate_at(time, C[stage] * h)
        share = h * A[STAGES, stage]
        for c in range(tangent.gaps.shape[1]):
            s, g = 0.0, 0.0
            if contacts.closed[c] != 0 and c >= tangent.first_contact:
                d = positive_part(tangent.gaps[stage, c])
                s = rate * elastic_slope(slots.chain.stiffness[c], d)
                g = rate * damping(slots.dissipation, d + TINY)
            tangent.stiffness[stage, c], tangent.damping[stage, c] = s, g
            trace -= share * g * (inverse_mass[c] + inverse_mass[c + 1])
    return trace


@inline_llvm
def stage_value(tangent, stage, i, first):
    """Row i of the block that begins at `first`, where slope `stage` of the step is taken."""
    value, base = load(tangent.matrix, first + i), i * STAGES
    for earlier in range(stage):
        value = value + load(tangent.slopes, base + earlier) * tangent.weights[stage, earlier]
    return value


@inline_llvm
def block_slope(slots, tangent, stage, rate):
    """Slope of a block at its stage state."""
    inverse_mass, s, g = slots.chain.inverse_mass, tangent.stiffness, tangent.damping
    n = tangent.state.shape[0] // 2
    pull = rate * foundation_pull(slots.foundation)
    here = load(tangent.state, 0)
    left = blank(here) - here
    for i in range(n):
        ahead = load(tangent.state, i + 1) if i + 1 < n else blank(here)
        right, inverse = here - ahead, inverse_mass[i + 1]
        store(tangent.slopes, i * STAGES + stage, load(tangent.state, n + i) * rate
              + left * (inverse * g[stage, i]) - right * (inverse * g[stage, i + 1]))
        store(tangent.slopes, (n + i) * STAGES + stage, left * (inverse * s[stage, i])
              - right * (inverse * s[stage, i + 1]) - here * (inverse * pull))
        here, left = ahead, right


@inline_numba
def carry_block(slots, time, h, tangent, first):
    """Carry eight columns, whose rows begin at `first`, through the step."""
    rows = tangent.state.shape[0]
    for stage in range(STAGES):
        for i in range(rows):
            store(tangent.state, i, stage_value(tangent, stage, i, first))
        block_slope(slots, tangent, stage, rate_at(time, C[stage] * h))
    for i in range(rows):
        store(tangent.matrix, first + i, stage_value(tangent, STAGES, i, first))
