"""The tangent flow in (u, w): growth or decay of the distance to neighbouring motions.

Equation   δu̇_i = δw_i + (g_{i-1} δδ_{i-1} − g_i δδ_i)/m_i
           m_i δẇ_i = s_{i-1} δδ_{i-1} − s_i δδ_i + δP_i,   δδ_c = δu_c − δu_{c+1},   s = (3/2) K √δ
           with δP_i, such as −k δu_i, from equations/body_forces.py
Method     The right-hand side is continuous in w, so the tangents cross contact events without a jump (the saltation of
           the (u, v) form is absorbed by the change of variables). They are integrated with the stages of the motion's
           own accepted step, eight columns in one vector.
Check      ∫ trace = ∫ (Σ_i ∂P_i/∂v_i/m_i − Σ_c g_c (1/m_c + 1/m_{c+1})) dt is the logarithm of the
           determinant (Liouville).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot, by_slot_inlined
from ..compiling.jit import inline_llvm, inline_numba, internal
from ..dop853.tableau import STAGES, A, C
from ..effects.contact import TINY, elastic_slope
from ..effects.dissipation import LAWS, damping
from ..effects.preload import overlap
from ..equations.body_forces import add_force_slope, add_force_trace
from ..simd.functions import positive_part
from ..simd.vector import BLOCK_WIDTH, aligned, blank, load8, store
from .attempt import record_stage
from .event_time import dt_ds_at


class StageMotions(NamedTuple):
    """Displacements u and velocities v of all bodies in the stages of a step, (stages + 1, N + 2) each."""

    u: np.ndarray
    v: np.ndarray


def new_stage_motions(bodies):
    """Allocate arrays for the motion in the stages of a step."""
    return StageMotions(np.zeros((STAGES + 1, bodies)), np.zeros((STAGES + 1, bodies)))


@internal
def write_stage_motion(stages, state, slope, stage):
    """Write one stage: its displacements from the state, its velocities from the state's slope."""
    for i in range(stages.u.shape[1]):
        stages.u[stage, i], stages.v[stage, i] = state[i], slope[i]


class Tangent(NamedTuple):
    """Tangent vectors as columns in blocks of eight, and workspaces.

    `matrix` (blocks · 2N, 8): rows δu_1..δu_N, then δw_1..δw_N of the first eight columns, then of the next.
    `stages` has the motion; `stiffness` and `damping` (stages, N+1) are those of the contacts; `slopes` (2N · stages,
    8) and `state` (2N, 8) belong to one block; `weights` (stages + 1, stages) are the step size times the tableau.
    `first_contact` is 0, or 1 for an observer, on which a given force acts instead of the driver.
    """

    matrix: np.ndarray
    stages: StageMotions
    stiffness: np.ndarray
    damping: np.ndarray
    slopes: np.ndarray
    state: np.ndarray
    weights: np.ndarray
    first_contact: int


def new_tangent(start, bodies, first_contact):
    """Return the workspace of tangents that start from the columns of `start` (2N, columns), eight in a block."""
    rows, columns = start.shape
    blocks, contacts = -(-columns // BLOCK_WIDTH), bodies - 1
    matrix = aligned(blocks * rows)
    padded = np.zeros((rows, blocks * BLOCK_WIDTH))
    padded[:, :columns] = start
    matrix[:] = padded.reshape(rows, blocks, BLOCK_WIDTH).transpose(1, 0, 2).reshape(blocks * rows, BLOCK_WIDTH)
    return Tangent(matrix, new_stage_motions(bodies), np.zeros((STAGES, contacts)), np.zeros((STAGES, contacts)),
                   aligned(STAGES * rows), aligned(rows), np.zeros((STAGES + 1, STAGES)), first_contact)


def columns_of(tangent, columns):
    """Return the first tangents as an ordinary matrix (2N, columns)."""
    rows = len(tangent.state)
    blocks = tangent.matrix.reshape(-1, rows, BLOCK_WIDTH)
    return np.ascontiguousarray(blocks.transpose(1, 0, 2).reshape(rows, -1)[:, :columns])


@record_stage.of(Tangent)
def _(tangent, state, slope, stage):
    if tangent.matrix.shape[0] > 0:
        write_stage_motion(tangent.stages, state, slope, stage)


@by_slot
def propagate(tangent, slots, transform, h, contacts):
    """Propagate the tangents through the accepted step of size h; return its share of ∫ trace, 0 without columns.

    Effect absent: nothing, and 0.
    """
    return 0.0


@propagate.of(Tangent)
def _(tangent, slots, transform, h, contacts):
    if tangent.matrix.shape[0] == 0:  # no columns: the same kernel serves the motion alone
        return 0.0
    share = linearise(slots, transform, h, contacts, tangent)
    for stage in range(STAGES + 1):
        for earlier in range(stage):
            tangent.weights[stage, earlier] = h * A[stage, earlier]
    rows = tangent.state.shape[0]
    for first in range(0, tangent.matrix.shape[0], rows):
        propagate_block(slots, transform, h, tangent, first)
    return share


@inline_numba
def linearise(slots, transform, h, contacts, tangent):
    """Write stiffness s and damping g of every contact in every stage, times |dt/ds|; return ∫ trace over the step."""
    trace, inverse_mass, stages = 0.0, slots.chain.inverse_mass, tangent.stages
    for stage in range(STAGES):
        dt_ds = dt_ds_at(transform, C[stage] * h)
        share = h * A[STAGES, stage]
        for c in range(inverse_mass.size - 1):
            acts = contacts.closed[c] != 0 and c >= tangent.first_contact
            d = positive_part(overlap(slots.preload, stages.u[stage], c)) if acts else 0.0
            tangent.stiffness[stage, c] = dt_ds * elastic_slope(slots.chain.stiffness[c], d) if acts else 0.0
            weight = share * (inverse_mass[c] + inverse_mass[c + 1])
            trace -= linearise_dashpot(slots.dissipation, tangent.damping[stage], c, d, dt_ds if acts else 0.0, weight)
        for i in range(1, inverse_mass.size - 1):
            u, v = stages.u[stage, i], stages.v[stage, i]
            trace = add_force_trace(slots, i, trace, u, v, share * dt_ds * inverse_mass[i])
    return trace


@by_slot_inlined
def linearise_dashpot(law, dampings, c, d, dt_ds, weight):
    """Store damping g of contact c times |dt/ds|, 0 if it is open; return it times `weight`. Effect absent: 0.

    A closed contact stays damped even if rounding makes its overlap negative.
    """
    return 0.0


@linearise_dashpot.of(*LAWS)
def _(law, dampings, c, d, dt_ds, weight):
    g = dt_ds * damping(law, d + TINY)
    dampings[c] = g
    return g * weight


@inline_llvm
def stage_value(tangent, stage, i, first):
    """Row i of the block that begins at `first`, in the state at which slope `stage` of the step is evaluated."""
    value, base = load8(tangent.matrix, first + i), i * STAGES
    for earlier in range(stage):
        value = value + load8(tangent.slopes, base + earlier) * tangent.weights[stage, earlier]
    return value


@by_slot_inlined
def add_dashpot_slope(law, slope, left, right, inverse_mass, g, i):
    """Add the share of bead i's two dashpots to the slope of its δu. Effect absent: the slope unchanged."""
    return slope


@add_dashpot_slope.of(*LAWS)
def _(law, slope, left, right, inverse_mass, g, i):
    return slope + left * (inverse_mass * g[i]) - right * (inverse_mass * g[i + 1])


@inline_llvm
def block_slope(slots, tangent, stage, dt_ds):
    """Slope of a block at its stage state."""
    inverse_mass, s, g, stages = slots.chain.inverse_mass, tangent.stiffness, tangent.damping[stage], tangent.stages
    n = tangent.state.shape[0] // 2
    here = load8(tangent.state, 0)
    left = -here
    for i in range(n):
        ahead = load8(tangent.state, i + 1) if i + 1 < n else blank(here)
        right, inverse = here - ahead, inverse_mass[i + 1]
        moving = add_dashpot_slope(slots.dissipation, load8(tangent.state, n + i) * dt_ds, left, right, inverse, g, i)
        pushed = left * (inverse * s[stage, i]) - right * (inverse * s[stage, i + 1])
        u, v = stages.u[stage, i + 1], stages.v[stage, i + 1]
        store(tangent.slopes, i * STAGES + stage, moving)
        store(tangent.slopes, (n + i) * STAGES + stage,
              add_force_slope(slots, i + 1, pushed, u, v, here, moving, dt_ds))
        here, left = ahead, right


@inline_numba
def propagate_block(slots, transform, h, tangent, first):
    """Propagate eight columns, whose rows begin at `first`, through the step."""
    rows = tangent.state.shape[0]
    for stage in range(STAGES):
        for i in range(rows):
            store(tangent.state, i, stage_value(tangent, stage, i, first))
        block_slope(slots, tangent, stage, dt_ds_at(transform, C[stage] * h))
    for i in range(rows):
        store(tangent.matrix, first + i, stage_value(tangent, STAGES, i, first))
