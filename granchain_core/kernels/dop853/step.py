"""One step of the Dormand–Prince method of order 8: stages, error estimate, dense output."""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from ..compiling.jit import by_type, inline_llvm, inline_numba, internal, kernel
from ..effects.driver import driver_displacement, driver_velocity
from ..effects.preload import overlap
from ..equations.motion import motion
from .bracket import Bracket, maximum_inside, root_inside, value_at
from .tableau import ALL_STAGES, DENSE_WEIGHTS, E3, E5, STAGES, A, C

#: Golden sections around a turning point of an overlap.
TURN_SECTIONS = 40
#: An overlap's root is found when its fraction of the step changes by less than this.
_ROOT_CHANGE = 1e-15
#: Largest factor from one step to the next.
_LARGEST_GROWTH = 6.0
#: Smallest factor from one step to the next.
_SMALLEST_GROWTH = 0.1
#: Part of the step at which the error is expected to be the tolerance.
_SAFETY = 0.9


class Dop853(NamedTuple):
    """Method slot: relative tolerance of one step and the largest step."""

    tolerance: float
    largest_step: float


class Dop853Workspace(NamedTuple):
    """Workspace: slopes k (16, M), stage, step end, probe and its slope (M,), dense output (7, M), forces.

    `scale` (2,) is the largest displacement and the largest w so far, to which the tolerance is relative;
    `next_step` (1,) is the size of the next step to try.
    """

    k: np.ndarray
    stage: np.ndarray
    end: np.ndarray
    probe: np.ndarray
    slope: np.ndarray
    dense: np.ndarray
    scale: np.ndarray
    next_step: np.ndarray
    forces: Any


#: ε in the resolution of t, ε·(t + 1/β): the spacing of floating-point numbers at 1.
RESOLUTION = 2.2e-16
#: A step that ends closer to a goal (the period's end, a sample) than this, in periods, ends there: the difference is
#: the rounding of a sum of steps.
GOAL_TOLERANCE = 1e-13


class DriveCycle(NamedTuple):
    """The driver's cycle in scaled time: its rate β, and its period 2π/β."""

    beta: float
    period: float


class Step(NamedTuple):
    """A step of size h from the state of a trajectory at local time t of the period; the rest is in the workspace."""

    trajectory: Any
    t: float
    h: float


class Overlap(NamedTuple):
    """The overlap of a contact inside a step, times a sign."""

    contact: int
    sign: float


@kernel
def evaluate(slots, beta, t, y, dy, forces):
    """Slope at local time t of the period; the drive phase is βt."""
    motion(slots, driver_displacement(slots.driver, beta * t), driver_velocity(slots.driver, beta * t), y, dy, forces)


@internal
def combine(y, h, k, row, out):
    """out = y + h Σ_s A[row, s] k_s, the state at which slope `row` is taken."""
    for i in range(y.size):
        out[i] = y[i]
    for s in range(row):
        a = h * A[row, s]
        if a != 0.0:
            for i in range(y.size):
                out[i] += a * k[s, i]


@internal
def attempt(method, step):
    """Try a step from y, whose slope is workspace.k[0]; the result is workspace.end, its slope workspace.k[12].

    Returns the error over the tolerance: at most 1 for a step to accept, NaN if the numbers failed.
    """
    slots, drive, y, workspace = step.trajectory
    for s in range(1, STAGES + 1):  # row 12 is the step itself, its slope the next step's first
        combine(y, step.h, workspace.k, s, workspace.end)
        evaluate(slots, drive.beta, step.t + C[s] * step.h, workspace.end, workspace.k[s], workspace.forces)
    return error_norm(method.tolerance, step.h, y, workspace, slots.chain.inverse_mass.size)


@internal
def shrunk(h, error):
    """A smaller step after one with too large an error."""
    return h * max(_SMALLEST_GROWTH, _SAFETY * error ** (-1.0 / 8.0))


@internal
def growth(error):
    """Step-size factor after an accepted step; an error below 1e-12 allows no more than the largest factor anyway."""
    return min(_LARGEST_GROWTH, _SAFETY * max(error, 1e-12) ** (-1.0 / 8.0))


@inline_numba
def error_norm(tolerance, h, y, workspace, bodies):
    """The method's combined error of orders 5 and 3 in units of the tolerance, root mean square over the beads."""
    k = workspace.k
    fifth, third = 0.0, 0.0
    for row in range(2):
        largest = workspace.scale[row]
        for i in range(row * bodies + 1, row * bodies + bodies - 1):
            largest = max(largest, abs(workspace.end[i]))
        unit = 1.0 / (tolerance * largest)
        for i in range(row * bodies + 1, row * bodies + bodies - 1):
            e5, e3 = 0.0, 0.0
            for s in range(STAGES + 1):
                e5 += E5[s] * k[s, i]
                e3 += E3[s] * k[s, i]
            fifth += (e5 * unit) ** 2
            third += (e3 * unit) ** 2
    if fifth == 0.0 and third == 0.0:
        return 0.0
    # as in Hairer's dop853.f: 0.01 weighs the error of order 3, which keeps the quotient regular where order 5 is tiny
    return abs(h) * fifth / sqrt((fifth + 0.01 * third) * (2 * (bodies - 2)))


@internal
def prepare_dense(step):
    """Fill workspace.dense for the step from y to workspace.end: three more slopes and seven coefficients."""
    slots, drive, y, workspace = step.trajectory
    for s in range(STAGES + 1, ALL_STAGES):
        combine(y, step.h, workspace.k, s, workspace.stage)
        evaluate(slots, drive.beta, step.t + C[s] * step.h, workspace.stage, workspace.k[s], workspace.forces)
    dense_coefficients(step.h, y, workspace)


@inline_numba
def dense_coefficients(h, y, workspace):
    """Fill workspace.dense from the step's end and all its slopes."""
    k, dense = workspace.k, workspace.dense
    for i in range(y.size):
        difference = workspace.end[i] - y[i]
        dense[0, i] = difference
        dense[1, i] = h * k[0, i] - difference
        dense[2, i] = 2.0 * difference - h * (k[STAGES, i] + k[0, i])
    for row in range(4):
        for i in range(y.size):
            dense[3 + row, i] = 0.0
        for s in range(ALL_STAGES):
            a = h * DENSE_WEIGHTS[row, s]
            if a != 0.0:
                for i in range(y.size):
                    dense[3 + row, i] += a * k[s, i]


@inline_llvm
def interpolant(start, rows, x):
    """The polynomial of the dense output at fraction x of the step, from its value at the start and its seven rows.

    Hairer, Nørsett & Wanner 1993, eq. (II.6.20). For numbers and vectors.
    """
    back = 1.0 - x
    value = rows[6] * x
    value = (value + rows[5]) * back
    value = (value + rows[4]) * x
    value = (value + rows[3]) * back
    value = (value + rows[2]) * x
    value = (value + rows[1]) * back
    return start + (value + rows[0]) * x


@internal
def dense_value(dense, y0, x, i):
    """Component i at fraction x of the step."""
    rows = (dense[0, i], dense[1, i], dense[2, i], dense[3, i], dense[4, i], dense[5, i], dense[6, i])
    return interpolant(y0, rows, x)


@internal
def interpolate(y, workspace, x):
    """Write the state at fraction x of the step from y into workspace.probe."""
    for i in range(y.size):
        workspace.probe[i] = dense_value(workspace.dense, y[i], x, i)


@by_type
def drive_phase(step, x):
    """Drive phase at fraction x of the step."""


@drive_phase.of(Step)
def _(step, x):
    return step.trajectory.drive.beta * (step.t + x * step.h)


@value_at.of(Overlap)
def _(quantity, step, x):
    slots, _, y, workspace = step.trajectory
    probe, c = workspace.probe, quantity.contact
    for i in range(c, c + 2):
        probe[i] = dense_value(workspace.dense, y[i], x, i)
    if c == 0:  # the driver's own motion is known exactly
        probe[0] = driver_displacement(slots.driver, drive_phase(step, x))
    return quantity.sign * overlap(slots.preload, probe, c)


@internal
def turning_point(signed_overlap, step):
    """Fraction at which an overlap is largest inside the step."""
    x, _ = maximum_inside(signed_overlap, step, 1.0, TURN_SECTIONS)
    return x


@internal
def crossing(signed_overlap, step, low, high):
    """Fraction between `low` and `high` at which an overlap changes sign."""
    f_low, f_high = value_at(signed_overlap, step, low), value_at(signed_overlap, step, high)
    return root_inside(signed_overlap, step, Bracket(low, high, f_low, f_high, 0), _ROOT_CHANGE)


@internal
def new_scale(y, workspace, bodies):
    """Raise the scale of the tolerance to the largest values of y."""
    for row in range(2):
        for i in range(row * bodies + 1, row * bodies + bodies - 1):
            workspace.scale[row] = max(workspace.scale[row], abs(y[i]))
