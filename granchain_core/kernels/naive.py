"""The naive methods: the equations in (u, v), whose dashpot force jumps, with fixed steps across all events.

Equation   m_i v̇_i = F_{i-1} − F_i + P_i,  F_c = K δ^{3/2} + g(δ) δ̇ H(δ)         Zhang et al. 2016, eq. (1)
Purpose    the usual first attempt, against which the gain of w-variables and located events is measured
The second row of the state is v here, not w; nothing else differs for the rest of the program. Importing this module
registers the two methods' code for `step` of rk4/step.py; integrate/fixed.py imports it.
"""

from __future__ import annotations

from typing import NamedTuple

from .compiling.jit import kernel
from .effects.contact import elastic_force
from .effects.dissipation import dashpot_force
from .effects.preload import overlap
from .effects.tension import cut_at_zero
from .equations.body_forces import force_on_bead
from .forces.crossings import end_approaches, record_crossings
from .forces.largest import Instant
from .rk4.step import span_of, step, tabulated_displacement, tabulated_velocity
from .simd.functions import positive_part
from .status import EVALUATIONS, STEPS


class Rk4Naive(NamedTuple):
    """Method slot: RK4 in (u, v) with a fixed step."""

    steps_per_period: int


class VerletNaive(NamedTuple):
    """Method slot: velocity Verlet in (u, v) with a fixed step; damping forces use the half-step velocities."""

    steps_per_period: int


@kernel
def naive_motion(slots, u0, v0, y, dy, forces):
    """Compute dy/dτ in (u, v); leave the elastic forces, with those that a cut adds, in forces.e, as `motion` does."""
    inverse_mass = slots.chain.inverse_mass
    bodies = inverse_mass.size
    y[0], dy[0] = u0, v0
    for i in range(1, bodies - 1):
        dy[i] = y[bodies + i]
    left = 0.0
    for c in range(bodies - 1):
        delta = overlap(slots.preload, y, c)
        damped = dashpot_force(slots.dissipation, delta, dy[c] - dy[c + 1])
        force = cut_at_zero(slots.tension, elastic_force(slots.chain.stiffness[c], positive_part(delta)) + damped)
        forces.e[c] = force - damped
        if c > 0:
            dy[bodies + c] = inverse_mass[c] * force_on_bead(slots, c, left - force, y[c], dy[c])
        left = force


@step.of(Rk4Naive)
def _(method, trajectory, j, out):
    slots, drive, y, workspace = trajectory
    k, stage, forces, h = workspace.k, workspace.stage, workspace.forces, drive.h
    now = Instant(y, k[0])
    before = end_approaches(slots.dissipation, slots, now)
    ua, va = tabulated_displacement(slots, drive, 2 * j + 1), tabulated_velocity(slots, drive, 2 * j + 1)
    ub, vb = tabulated_displacement(slots, drive, 2 * j + 2), tabulated_velocity(slots, drive, 2 * j + 2)
    for i in range(y.size):
        stage[i] = y[i] + 0.5 * h * k[0, i]
    naive_motion(slots, ua, va, stage, k[1], forces)
    for i in range(y.size):
        stage[i] = y[i] + 0.5 * h * k[1, i]
    naive_motion(slots, ua, va, stage, k[2], forces)
    for i in range(y.size):
        stage[i] = y[i] + h * k[2, i]
    naive_motion(slots, ub, vb, stage, k[3], forces)
    for i in range(y.size):
        y[i] += h / 6.0 * (k[0, i] + 2.0 * (k[1, i] + k[2, i]) + k[3, i])
    naive_motion(slots, ub, vb, y, k[0], forces)
    record_crossings(slots.dissipation, slots, before, now, span_of(drive, j), out.log)
    out.counts[STEPS] += 1
    out.counts[EVALUATIONS] += 4
    return h


@step.of(VerletNaive)
def _(method, trajectory, j, out):
    slots, drive, y, workspace = trajectory
    bodies, k, h = slots.chain.inverse_mass.size, workspace.k, drive.h
    now = Instant(y, k[0])
    before = end_approaches(slots.dissipation, slots, now)
    for i in range(1, bodies - 1):
        y[bodies + i] += 0.5 * h * k[0, bodies + i]
        y[i] += h * y[bodies + i]
    ub, vb = tabulated_displacement(slots, drive, 2 * j + 2), tabulated_velocity(slots, drive, 2 * j + 2)
    naive_motion(slots, ub, vb, y, k[0], workspace.forces)
    for i in range(1, bodies - 1):
        y[bodies + i] += 0.5 * h * k[0, bodies + i]
        k[0, i] = y[bodies + i]
    record_crossings(slots.dissipation, slots, before, now, span_of(drive, j), out.log)
    out.counts[STEPS] += 1
    out.counts[EVALUATIONS] += 1
    return h
