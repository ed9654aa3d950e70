"""The tangent flow in (u, v), the second route: tangents jump where a dashpot contact opens or closes.

Equation   m_i δv̇_i = s_{i-1} δδ_{i-1} − s_i δδ_i + λ_{i-1} δδ̇_{i-1} − λ_i δδ̇_i − k δu_i,   δu̇_i = δv_i
Saltation  at the onset of contact c   δv_c −= (λ/m_c) δδ_c,   δv_{c+1} += (λ/m_{c+1}) δδ_c,   at release the reverse:
           the velocity of neighbouring motions changes its slope there at another time than that of this one
Source     saltation matrices: Leine & Nijmeijer 2004, chapter 7; for this force they are constant shears
Use        a check of flow/tangent.py that shares the motion and its steps with it. The shear has determinant 1, so
           Liouville's formula cannot see whether it is there; the columns do. Linear dashpot or no damping.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..contact_cubic import TINY
from ..dop853.tableau import STAGES, A, C
from ..effects.contact import elastic_slope, positive_part
from ..effects.dissipation import damping
from ..effects.foundation import foundation_pull
from ..jit import inline_numba
from .attempt import keep_gaps
from .run import saltate
from .tangent import carry, stage_gaps
from .time_map import rate_at


class VelocityTangent(NamedTuple):
    """Tangent vectors as columns: matrix (2N, columns), rows δu_1..δu_N, then δv_1..δv_N, and workspaces.

    `jumps` is 1, or 0 to see what comes of a forgotten saltation.
    """

    matrix: np.ndarray
    gaps: np.ndarray
    slopes: np.ndarray
    state: np.ndarray
    jumps: float


@keep_gaps.of(VelocityTangent)
def _(tangent, slots, state, slope, stage):
    stage_gaps(slots, state, stage, tangent.gaps)


@inline_numba
def velocity_slope(slots, rate, gaps, closed, T, out):
    """Slope of all columns T at one stage, times dt/dx."""
    n, columns = T.shape[0] // 2, T.shape[1]
    for i in range(n):
        for q in range(columns):
            out[i, q] = rate * T[n + i, q]
            out[n + i, q] = -rate * slots.chain.inverse_mass[i + 1] * foundation_pull(slots.foundation) * T[i, q]
    for c in range(n + 1):
        if closed[c] == 0:
            continue
        d = positive_part(gaps[c])
        s, g = elastic_slope(slots.chain.stiffness[c], d), damping(slots.dissipation, d + TINY)
        for q in range(columns):
            push = 0.0
            if c > 0:
                push += s * T[c - 1, q] + g * T[n + c - 1, q]
            if c < n:
                push -= s * T[c, q] + g * T[n + c, q]
            if c > 0:
                out[n + c - 1, q] -= rate * slots.chain.inverse_mass[c] * push
            if c < n:
                out[n + c, q] += rate * slots.chain.inverse_mass[c + 1] * push


@carry.of(VelocityTangent)
def _(tangent, slots, time, h, contacts):
    rows, columns = tangent.matrix.shape
    for stage in range(STAGES + 1):
        for i in range(rows):
            for q in range(columns):
                value = tangent.matrix[i, q]
                for earlier in range(stage):
                    value += h * A[stage, earlier] * tangent.slopes[earlier, i, q]
                tangent.state[i, q] = value
        if stage < STAGES:
            velocity_slope(slots, rate_at(time, C[stage] * h), tangent.gaps[stage], contacts.closed, tangent.state,
                           tangent.slopes[stage])
    for i in range(rows):
        for q in range(columns):
            tangent.matrix[i, q] = tangent.state[i, q]
    return 0.0


@saltate.of(VelocityTangent)
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
