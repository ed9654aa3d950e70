"""A chain of Hertz contacts with a harmonic driver and nothing else, written by hand: what an absent effect must not
cost more than. Arrays, loops, functions and their arguments are those of granchain_core/kernels/equations/motion.py and
fixed_step.py with every optional term struck out; `slots` is handed on as there and only its chain and driver are read."""

from __future__ import annotations

from math import cos, sin

import numba
import numpy as np

from granchain_core.kernels.effects.contact import elastic_force, positive_part
from granchain_core.kernels.equations.motion import motion
from granchain_core.kernels.jit import kernel
from granchain_core.kernels.rk4.step import step

FLAGS = {"nsz", "arcp", "contract", "reassoc"}


def uncounted(function):
    """The product's compiler options without Numba's reference counts, which it adds to one leaf and not to another."""
    return numba.njit(nogil=True, fastmath=FLAGS, error_model="numpy", _nrt=False)(function)


def fresh(function):
    """The product's compiler options, compiled in every process: a caller from the cache and a leaf compiled beside it
    execute 6 % more than when both are compiled together."""
    return numba.njit(nogil=True, fastmath=FLAGS, error_model="numpy")(function)


@uncounted
def motion_by_hand(slots, u0, v0, y, dy, forces):
    """dy/dτ of the bare chain."""
    inverse_mass, stiffness = slots.chain.inverse_mass, slots.chain.stiffness
    e = forces.e
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


@fresh
def rk4_by_hand(slots, ua, va, ub, vb, h, y, stages):
    """One RK4 step from y to stages.end."""
    k, stage, end, forces = stages.k, stages.stage, stages.end, stages.forces
    for i in range(y.size):
        stage[i] = y[i] + 0.5 * h * k[0, i]
    motion_by_hand(slots, ua, va, stage, k[1], forces)
    for i in range(y.size):
        stage[i] = y[i] + 0.5 * h * k[1, i]
    motion_by_hand(slots, ua, va, stage, k[2], forces)
    for i in range(y.size):
        stage[i] = y[i] + h * k[2, i]
    motion_by_hand(slots, ub, vb, stage, k[3], forces)
    for i in range(y.size):
        end[i] = y[i] + h / 6.0 * (k[0, i] + 2.0 * (k[1, i] + k[2, i]) + k[3, i])


@fresh
def displacement_by_hand(slots, drive, i, dtheta):
    """The driver's displacement at half-step index i, from the table or where it is empty from the phase."""
    return drive[i, 0] if drive.shape[0] > 0 else slots.driver.amplitude * sin(0.5 * dtheta * i)


@fresh
def velocity_by_hand(slots, drive, i, dtheta):
    """The driver's velocity there."""
    return drive[i, 1] if drive.shape[0] > 0 else slots.driver.amplitude * slots.driver.beta * cos(0.5 * dtheta * i)


@fresh
def whole_step_by_hand(slots, drive, j, dtheta, h, y, stages):
    """One RK4 step to stages.end; returns the driver there."""
    ua, va = displacement_by_hand(slots, drive, 2 * j + 1, dtheta), velocity_by_hand(slots, drive, 2 * j + 1, dtheta)
    ub, vb = displacement_by_hand(slots, drive, 2 * j + 2, dtheta), velocity_by_hand(slots, drive, 2 * j + 2, dtheta)
    rk4_by_hand(slots, ua, va, ub, vb, h, y, stages)
    return ub, vb


@fresh
def step_by_hand(method, slots, drive, j, theta, dtheta, h, y, stages, log, counts):
    """One RK4 step in place; how far its end lies behind the last state at which forces were followed."""
    ub, vb = whole_step_by_hand(slots, drive, j, dtheta, h, y, stages)
    k, end = stages.k, stages.end
    motion_by_hand(slots, ub, vb, end, k[3], stages.forces)
    for i in range(y.size):
        y[i], k[0, i] = end[i], k[3, i]
    counts[0] += 1
    counts[1] += 4
    return h


@fresh
def steps_by_hand(method, slots, drive, h, y, stages, log, counts, count):
    """`count` steps."""
    dtheta = 2.0 * np.pi / method.steps_per_period
    for j in range(count):
        step_by_hand(method, slots, drive, j, j * dtheta, dtheta, h, y, stages, log, counts)


@kernel
def steps_of_product(method, slots, drive, h, y, stages, log, counts, count):
    """`count` RK4 steps of the product's own kernel."""
    dtheta = 2.0 * np.pi / method.steps_per_period
    for j in range(count):
        step(method, slots, drive, j, j * dtheta, dtheta, h, y, stages, log, counts)


@fresh
def motions_by_hand(slots, y, dy, forces, count):
    """The slope, `count` times."""
    for j in range(count):
        motion_by_hand(slots, 0.01 * j, 0.01, y, dy, forces)


@kernel
def motions_of_product(slots, y, dy, forces, count):
    """The product's slope, `count` times."""
    for j in range(count):
        motion(slots, 0.01 * j, 0.01, y, dy, forces)
