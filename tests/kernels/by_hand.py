"""A chain of Hertz contacts with a harmonic driver and nothing else, written by hand: what an absent effect must not
cost more than. Arrays, loops and functions are those of granchain_core/kernels/motion.py and fixed_step.py with every
optional term struck out; there is no slot for what could be there."""

from __future__ import annotations

from math import cos, sin

import numba
import numpy as np

from granchain_core.kernels.effects.contact import elastic_force, positive_part
from granchain_core.kernels.fixed_step import step
from granchain_core.kernels.jit import kernel
from granchain_core.kernels.motion import motion


def uncounted(function):
    """The product's compiler options without Numba's reference counts, which it adds to one leaf and not to another."""
    return numba.njit(nogil=True, fastmath={"nsz", "arcp", "contract", "reassoc"}, error_model="numpy", _nrt=False)(
        function)


@uncounted
def motion_by_hand(inverse_mass, stiffness, u0, v0, y, dy, e):
    """dy/dτ of the bare chain."""
    m = inverse_mass.size
    y[0] = u0
    dy[0] = v0
    for c in range(m - 1):
        d = positive_part(y[c] - y[c + 1])
        e[c] = elastic_force(stiffness[c], d)
    for i in range(1, m - 1):
        dy[i] = y[m + i]
    for i in range(1, m - 1):
        dy[m + i] = inverse_mass[i] * (e[i - 1] - e[i])


@kernel
def rk4_by_hand(inverse_mass, stiffness, ua, va, ub, vb, h, y, k, stage, end, e):
    """One RK4 step from y to `end`."""
    for i in range(y.size):
        stage[i] = y[i] + 0.5 * h * k[0, i]
    motion_by_hand(inverse_mass, stiffness, ua, va, stage, k[1], e)
    for i in range(y.size):
        stage[i] = y[i] + 0.5 * h * k[1, i]
    motion_by_hand(inverse_mass, stiffness, ua, va, stage, k[2], e)
    for i in range(y.size):
        stage[i] = y[i] + h * k[2, i]
    motion_by_hand(inverse_mass, stiffness, ub, vb, stage, k[3], e)
    for i in range(y.size):
        end[i] = y[i] + h / 6.0 * (k[0, i] + 2.0 * (k[1, i] + k[2, i]) + k[3, i])


@kernel
def drive_by_hand(drive, i, column, beta, dtheta):
    """The driver's displacement (column 0) or velocity (1) at half-step index i, from the table or where it is empty
    from the phase."""
    if drive.shape[0] > 0:
        return drive[i, column]
    return sin(0.5 * dtheta * i) if column == 0 else beta * cos(0.5 * dtheta * i)


@kernel
def whole_step_by_hand(inverse_mass, stiffness, drive, j, beta, dtheta, h, y, k, stage, end, e):
    """One RK4 step to `end`; returns the driver there."""
    ua, va = drive_by_hand(drive, 2 * j + 1, 0, beta, dtheta), drive_by_hand(drive, 2 * j + 1, 1, beta, dtheta)
    ub, vb = drive_by_hand(drive, 2 * j + 2, 0, beta, dtheta), drive_by_hand(drive, 2 * j + 2, 1, beta, dtheta)
    rk4_by_hand(inverse_mass, stiffness, ua, va, ub, vb, h, y, k, stage, end, e)
    return ub, vb


@kernel
def step_by_hand(inverse_mass, stiffness, drive, j, beta, dtheta, h, y, k, stage, end, e, counts):
    """One RK4 step in place."""
    ub, vb = whole_step_by_hand(inverse_mass, stiffness, drive, j, beta, dtheta, h, y, k, stage, end, e)
    for i in range(y.size):
        y[i] = end[i]
    motion_by_hand(inverse_mass, stiffness, ub, vb, y, k[0], e)
    counts[0] += 1
    counts[1] += 4


@kernel
def steps_by_hand(inverse_mass, stiffness, drive, beta, dtheta, h, y, k, stage, end, e, counts, count):
    """`count` steps."""
    for j in range(count):
        step_by_hand(inverse_mass, stiffness, drive, j, beta, dtheta, h, y, k, stage, end, e, counts)


@kernel
def steps_of_product(method, slots, drive, h, y, stages, counts, count):
    """`count` RK4 steps of the product's own kernel."""
    dtheta = 2.0 * np.pi / method.steps_per_period
    for j in range(count):
        step(method, slots, drive, j, j * dtheta, dtheta, h, y, stages, counts)


@kernel
def motions_by_hand(inverse_mass, stiffness, y, dy, e, count):
    """The slope, `count` times."""
    for j in range(count):
        motion_by_hand(inverse_mass, stiffness, 0.01 * j, 0.01, y, dy, e)


@kernel
def motions_of_product(slots, y, dy, forces, count):
    """The product's slope, `count` times."""
    for j in range(count):
        motion(slots, 0.01 * j, 0.01, y, dy, forces)
