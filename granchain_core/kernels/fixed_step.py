"""Fixed-step methods: classical Runge–Kutta of order 4 in w, plain or with its step split at contact events.

The drive phase comes from an integer step count: `drive` holds (u_0, v_0) at every half step of one period, or is
empty where a period has so many steps that the table would not fit, and the driver is asked instead.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from .effects.driver import driver_displacement, driver_velocity
from .effects.preload import overlap
from .jit import kernel, term
from .motion import motion


class Rk4(NamedTuple):
    """Method slot: RK4 in w without looking for events; order 2 at the kinks of opening and closing contacts."""

    steps_per_period: int


class Rk4Split(NamedTuple):
    """Method slot: RK4 in w whose step is split where a contact opens or closes."""

    steps_per_period: int


class Stages(NamedTuple):
    """Workspace of one step: slopes k (4, M), a stage state and the step's end (M,), force arrays.

    `along` is the workspace of steps with SIMD along the chain (along.py), None where the scene or method cannot.
    """

    k: np.ndarray
    stage: np.ndarray
    end: np.ndarray
    forces: Any
    along: Any


#: More contacts than this many changing in one step: the rest of the step is taken whole.
_MOST_SPLITS = 64
#: Events nearer to the step's ends than this fraction are not worth a split.
_NEAR_END = 1e-6


@kernel
def drive_displacement(slots, drive, i, dtheta):
    """u_0 at half-step index i of the period."""
    return drive[i, 0] if drive.shape[0] > 0 else driver_displacement(slots.driver, 0.5 * dtheta * i)


@kernel
def drive_velocity(slots, drive, i, dtheta):
    """v_0 at half-step index i of the period."""
    return drive[i, 1] if drive.shape[0] > 0 else driver_velocity(slots.driver, 0.5 * dtheta * i)


@kernel
def rk4(slots, ua, va, ub, vb, h, y, stages):
    """One RK4 step from y, whose slope is stages.k[0], to stages.end; (u, v)_a at mid-step, _b at its end."""
    k, stage, end, forces = stages.k, stages.stage, stages.end, stages.forces
    for i in range(y.size):
        stage[i] = y[i] + 0.5 * h * k[0, i]
    motion(slots, ua, va, stage, k[1], forces)
    for i in range(y.size):
        stage[i] = y[i] + 0.5 * h * k[1, i]
    motion(slots, ua, va, stage, k[2], forces)
    for i in range(y.size):
        stage[i] = y[i] + h * k[2, i]
    motion(slots, ub, vb, stage, k[3], forces)
    for i in range(y.size):
        end[i] = y[i] + h / 6.0 * (k[0, i] + 2.0 * (k[1, i] + k[2, i]) + k[3, i])


@kernel
def hermite_root(d0, s0, d1, s1):
    """Root in [0, 1] of the cubic with values d0, d1 of opposite sign and slopes s0, s1 at the ends."""
    low, high = 0.0, 1.0
    a = 2.0 * (d0 - d1) + s0 + s1
    b = 3.0 * (d1 - d0) - 2.0 * s0 - s1
    x = d0 / (d0 - d1)
    for _ in range(30):
        value = d0 + x * (s0 + x * (b + x * a))
        if (value > 0.0) == (d0 > 0.0):
            low = x
        else:
            high = x
        slope = s0 + x * (2.0 * b + 3.0 * a * x)
        nearer = x - value / slope if slope != 0.0 else low
        if not (low < nearer < high):
            nearer = 0.5 * (low + high)
        if abs(nearer - x) < 1e-12:
            return nearer
        x = nearer
    return x


@kernel
def any_change(slots, y, end):
    """Whether a contact is open at one end of the step and closed at the other."""
    changed = 0
    for c in range(slots.chain.stiffness.size):
        before = overlap(slots.preload, y, c) > 0.0
        after = overlap(slots.preload, end, c) > 0.0
        changed += before != after
    return changed > 0


@kernel
def first_change(slots, h, y, slope, end, end_slope):
    """Fraction of the step at which the first contact opens or closes; 2 if none does inside."""
    first = 2.0
    for c in range(slots.chain.stiffness.size):
        d0 = overlap(slots.preload, y, c)
        d1 = overlap(slots.preload, end, c)
        if (d0 > 0.0) == (d1 > 0.0) or d0 == 0.0:
            continue
        root = hermite_root(d0, h * (slope[c] - slope[c + 1]), d1, h * (end_slope[c] - end_slope[c + 1]))
        if _NEAR_END < root < 1.0 - _NEAR_END and root < first:
            first = root
    return first


@term
def step(method, slots, drive, j, theta, dtheta, h, y, stages, counts):
    """Advance y by one step from half-step index 2j of the drive table; slope in stages.k[0] before and after."""
    raise NotImplementedError


@kernel
def whole_step(slots, drive, j, dtheta, h, y, stages):
    """One RK4 step from half-step index 2j to stages.end; returns the driver's displacement and velocity there."""
    ua, va = drive_displacement(slots, drive, 2 * j + 1, dtheta), drive_velocity(slots, drive, 2 * j + 1, dtheta)
    ub, vb = drive_displacement(slots, drive, 2 * j + 2, dtheta), drive_velocity(slots, drive, 2 * j + 2, dtheta)
    rk4(slots, ua, va, ub, vb, h, y, stages)
    return ub, vb


@step.of(Rk4)
def _(method, slots, drive, j, theta, dtheta, h, y, stages, counts):
    ub, vb = whole_step(slots, drive, j, dtheta, h, y, stages)
    for i in range(y.size):
        y[i] = stages.end[i]
    motion(slots, ub, vb, y, stages.k[0], stages.forces)
    counts[0] += 1
    counts[1] += 4


@step.of(Rk4Split)
def _(method, slots, drive, j, theta, dtheta, h, y, stages, counts):
    ub, vb = whole_step(slots, drive, j, dtheta, h, y, stages)
    counts[0] += 1
    counts[1] += 4
    if any_change(slots, y, stages.end):
        split_rest(slots, theta, dtheta, ub, vb, h, y, stages, counts)
    else:
        for i in range(y.size):
            y[i] = stages.end[i]
        motion(slots, ub, vb, y, stages.k[0], stages.forces)


@kernel
def split_rest(slots, theta, dtheta, u_end, v_end, h, y, stages, counts):
    """Finish a step in which contacts change: step to the first change, start again there, to the step's end."""
    done = 0.0
    for _ in range(_MOST_SPLITS):
        rest = 1.0 - done
        motion(slots, u_end, v_end, stages.end, stages.k[3], stages.forces)
        counts[1] += 1
        first = first_change(slots, h * rest, y, stages.k[0], stages.end, stages.k[3])
        if first > 1.0:
            break
        part = first * rest
        middle = theta + dtheta * (done + 0.5 * part)
        there = theta + dtheta * (done + part)
        u, v = driver_displacement(slots.driver, there), driver_velocity(slots.driver, there)
        rk4(slots, driver_displacement(slots.driver, middle), driver_velocity(slots.driver, middle),
            u, v, h * part, y, stages)
        for i in range(y.size):
            y[i] = stages.end[i]
        motion(slots, u, v, y, stages.k[0], stages.forces)
        done += part
        middle = theta + dtheta * 0.5 * (1.0 + done)
        rk4(slots, driver_displacement(slots.driver, middle), driver_velocity(slots.driver, middle),
            u_end, v_end, h * (1.0 - done), y, stages)
        counts[1] += 8
        counts[2] += 1
    for i in range(y.size):
        y[i] = stages.end[i]
        stages.k[0, i] = stages.k[3, i]
    motion(slots, u_end, v_end, y, stages.k[0], stages.forces)
