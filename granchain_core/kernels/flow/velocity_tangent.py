"""The tangent flow in (u, v), as a second route: tangents jump where a contact with a dashpot opens or closes.

Equation   m_i δv̇_i = s_{i-1} δδ_{i-1} − s_i δδ_i + g_{i-1} δδ̇_{i-1} − g_i δδ̇_i + δP_i,   δu̇_i = δv_i
Saltation  at the closing of contact c   δv_c −= (λ/m_c) δδ_c,   δv_{c+1} += (λ/m_{c+1}) δδ_c,   at an opening the
           reverse: neighbouring trajectories cross the event at different times
Source     saltation matrices: Leine & Nijmeijer 2004, chapter 7; for this force they are constant shears
Use        a check of flow/tangent.py, with the same motion and steps. The shear has determinant 1, so Liouville's
           formula cannot detect whether it is applied; the columns can. Linear dashpot or no damping.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.jit import inline_numba
from ..dop853.tableau import STAGES, A, C
from ..effects.contact import TINY, elastic_slope
from ..effects.dissipation import damping
from ..effects.preload import overlap
from ..equations.body_forces import add_force_slope
from ..simd.functions import positive_part
from .attempt import record_stage
from .event_time import dt_ds_at
from .run import apply_saltation
from .tangent import StageMotions, new_stage_motions, propagate, write_stage_motion


class VelocityTangent(NamedTuple):
    """Tangent vectors as columns: matrix (2N, columns), rows δu_1..δu_N, then δv_1..δv_N, and workspaces.

    `jumps` is 1; with 0 the saltation is left out, so that a test can measure the resulting error.
    """

    matrix: np.ndarray
    stages: StageMotions
    slopes: np.ndarray
    state: np.ndarray
    jumps: float


def new_velocity_tangent(start, bodies, jumps):
    """Return the workspace of tangents that start from the columns of `start` (2N, columns)."""
    return VelocityTangent(start, new_stage_motions(bodies), np.zeros((STAGES, *start.shape)), np.zeros(start.shape),
                           jumps)


@record_stage.of(VelocityTangent)
def _(tangent, state, slope, stage):
    write_stage_motion(tangent.stages, state, slope, stage)


@inline_numba
def velocity_slope(slots, dt_ds, u, v, closed, T, out):
    """Slope of all columns T at one stage with displacements u and velocities v, times |dt/ds|."""
    n, columns = T.shape[0] // 2, T.shape[1]
    for i in range(n):
        for q in range(columns):
            out[i, q] = dt_ds * T[n + i, q]
            out[n + i, q] = add_force_slope(slots, i + 1, 0.0, u[i + 1], v[i + 1], T[i, q], out[i, q], dt_ds)
    for c in range(n + 1):
        if closed[c] == 0:
            continue
        d = positive_part(overlap(slots.preload, u, c))
        s, g = elastic_slope(slots.chain.stiffness[c], d), damping(slots.dissipation, d + TINY)
        for q in range(columns):
            push = 0.0
            if c > 0:
                push += s * T[c - 1, q] + g * T[n + c - 1, q]
            if c < n:
                push -= s * T[c, q] + g * T[n + c, q]
            if c > 0:
                out[n + c - 1, q] -= dt_ds * slots.chain.inverse_mass[c] * push
            if c < n:
                out[n + c, q] += dt_ds * slots.chain.inverse_mass[c + 1] * push


@propagate.of(VelocityTangent)
def _(tangent, slots, transform, h, contacts):
    rows, columns = tangent.matrix.shape
    for stage in range(STAGES + 1):
        for i in range(rows):
            for q in range(columns):
                value = tangent.matrix[i, q]
                for earlier in range(stage):
                    value += h * A[stage, earlier] * tangent.slopes[earlier, i, q]
                tangent.state[i, q] = value
        if stage < STAGES:
            velocity_slope(slots, dt_ds_at(transform, C[stage] * h), tangent.stages.u[stage], tangent.stages.v[stage],
                           contacts.closed, tangent.state, tangent.slopes[stage])
    for i in range(rows):
        for q in range(columns):
            tangent.matrix[i, q] = tangent.state[i, q]
    return 0.0


@apply_saltation.of(VelocityTangent)
def _(tangent, slots, c, closes):
    T, n = tangent.matrix, tangent.matrix.shape[0] // 2
    shear = tangent.jumps * damping(slots.dissipation, 1.0)
    if not closes:
        shear = -shear
    for q in range(T.shape[1]):
        d = (T[c - 1, q] if c > 0 else 0.0) - (T[c, q] if c < n else 0.0)
        if c > 0:
            T[n + c - 1, q] -= shear * slots.chain.inverse_mass[c] * d
        if c < n:
            T[n + c, q] += shear * slots.chain.inverse_mass[c + 1] * d
