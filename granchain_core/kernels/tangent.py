"""The tangent flow in (u, w): how neighbouring motions grow or shrink along a certified one.

Equation   δu̇_i = δw_i + (g_{i-1} δδ_{i-1} − g_i δδ_i)/m_i
           m_i δẇ_i = s_{i-1} δδ_{i-1} − s_i δδ_i − k δu_i,   δδ_c = δu_c − δu_{c+1},   s = (3/2) K √δ
Method     The right-hand side is continuous in w, so the tangents cross contact events without a jump (the saltation of
           the (u, v) form is inside the change of variables). They are integrated with the stages of the accepted
           step of the motion itself; all columns at once.
Check      ∫ trace = −∫ Σ_c g_c (1/m_c + 1/m_{c+1}) dt is the logarithm of the determinant (Liouville).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np

from .certified import certified_step
from .dop853 import attempt, combine, evaluate, new_scale
from .dop853_tableau import STAGES, A, C
from .effects.contact import positive_part
from .effects.dissipation import damping
from .effects.driver import driver_displacement
from .effects.foundation import foundation_pull
from .effects.preload import overlap
from .jit import kernel
from .motion import copy
from .sampling import CANCELLED, DONE, NOT_FINITE, first_not_finite

#: Behind an event tangents go with (t − t_e)^{3/2}, one power less than w: steps begin and end this near to it, and
#: each step before it leaves this part of the way. Their error is then some 10 · _NEAREST^{3/2} per event.
_NEAREST, _LEFT = 1e-8, 0.2


class Tangent(NamedTuple):
    """Tangent vectors as columns: matrix (2N, columns), rows δu_1..δu_N then δw_1..δw_N, and workspaces."""

    matrix: np.ndarray
    slopes: np.ndarray
    stage: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray


@kernel
def linearise(slots, y, first_contact, tangent):
    """Tangent stiffness s and damping g of every contact at state y; contacts before `first_contact` are left out."""
    trace, inverse_mass = 0.0, slots.chain.inverse_mass
    for c in range(tangent.stiffness.size):
        d = positive_part(overlap(slots.preload, y, c)) if c >= first_contact else 0.0
        tangent.stiffness[c] = 1.5 * slots.chain.stiffness[c] * sqrt(d)
        tangent.damping[c] = damping(slots.dissipation, d)
        trace -= tangent.damping[c] * (inverse_mass[c] + inverse_mass[c + 1])
    return trace


@kernel
def tangent_slope(slots, tangent, out):
    """Slope of all columns of tangent.stage by the last linearisation."""
    T, s, g = tangent.stage, tangent.stiffness, tangent.damping
    n, columns = T.shape[0] // 2, T.shape[1]
    pull = foundation_pull(slots.foundation)
    for i in range(n):
        inverse = slots.chain.inverse_mass[i + 1]
        for q in range(columns):
            left = T[i - 1, q] - T[i, q] if i > 0 else -T[i, q]
            right = T[i, q] - T[i + 1, q] if i + 1 < n else T[i, q]
            out[i, q] = T[n + i, q] + inverse * (g[i] * left - g[i + 1] * right)
            out[n + i, q] = inverse * (s[i] * left - s[i + 1] * right - pull * T[i, q])


@kernel
def tangent_step(slots, beta, t, h, y, work, tangent, first_contact):
    """Carry the tangents through the accepted step from y of size h; returns its share of ∫ trace."""
    share = 0.0
    rows, columns = tangent.matrix.shape
    for s in range(STAGES + 1):
        for i in range(rows):
            for q in range(columns):
                tangent.stage[i, q] = tangent.matrix[i, q]
        for j in range(s):
            a = h * A[s, j]
            if a != 0.0:
                for i in range(rows):
                    for q in range(columns):
                        tangent.stage[i, q] += a * tangent.slopes[j, i, q]
        if s == STAGES:
            break
        combine(y, h, work.k, s, work.stage)
        work.stage[0] = driver_displacement(slots.driver, beta * (t + C[s] * h))
        share += h * A[STAGES, s] * linearise(slots, work.stage, first_contact, tangent)
        tangent_slope(slots, tangent, tangent.slopes[s])
    for i in range(rows):
        for q in range(columns):
            tangent.matrix[i, q] = tangent.stage[i, q]
    return share


@kernel
def run_tangent(method, slots, beta, period, periods, y, work, clock, tangent, first_contact, counts, stop):
    """Carry motion and tangents through whole periods from phase 0.

    `first_contact` is 0, or 1 for the observer, on which the driver acts by a given force. Returns (status, periods
    done, ∫ trace).
    """
    m, trace = slots.chain.inverse_mass.size, 0.0
    evaluate(slots, beta, 0.0, y, work.k[0], work.forces)
    for p in range(periods):
        t = 0.0
        while t < period:
            status, h, contact = certified_step(method, slots, beta, t, period, y, work, clock, counts)
            if status != DONE:
                return status, p, trace
            if contact >= 0 and h > _NEAREST:
                # towards the event in shrinking steps, each of which leaves a part of the way
                h *= 1.0 - _LEFT
                attempt(method, slots, beta, t, h, y, work)
                counts[1] += STAGES
                clock[0] = 2.0 * _LEFT * h
            elif contact >= 0:
                clock[0] = _NEAREST
            trace += tangent_step(slots, beta, t, h, y, work, tangent, first_contact)
            copy(work.end, y)
            new_scale(y, work, m)
            copy(work.k[STAGES], work.k[0])
            t = period if period - (t + h) < 1e-13 * period else t + h
        evaluate(slots, beta, 0.0, y, work.k[0], work.forces)
        if first_not_finite(y, m) != 0:
            return NOT_FINITE, p, trace
        if stop[0] != 0:
            return CANCELLED, p, trace
    return DONE, periods, trace
