"""One step of the Dormand–Prince method of order 8: stages, error estimate, dense output."""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from ..compiling.jit import inline_llvm, inline_numba, internal
from ..error_control.step import attempt, dense_value, error_order, evaluate, prepare_dense, stages
from .tableau import ALL_STAGES, DENSE_EVALUATIONS, DENSE_WEIGHTS, E3, E5, STAGES, A, C


class Dop853(NamedTuple):
    """Method slot: relative tolerance of one step and the largest step."""

    tolerance: float
    largest_step: float


class Dop853Workspace(NamedTuple):
    """Workspace as error_control/step.py describes it, with 16 slopes k, a stage (M,) and the dense output (7, M)."""

    k: np.ndarray
    stage: np.ndarray
    end: np.ndarray
    probe: np.ndarray
    slope: np.ndarray
    dense: np.ndarray
    scale: np.ndarray
    next_step: np.ndarray
    forces: Any


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


@stages.of(Dop853Workspace)
def _(workspace):
    return STAGES


@error_order.of(Dop853)
def _(method):
    return 8.0


@attempt.of(Dop853)
def _(method, step):
    slots, drive, y, workspace = step.trajectory
    for s in range(1, STAGES + 1):  # row 12 is the step itself, and its slope the first of the next step
        combine(y, step.h, workspace.k, s, workspace.end)
        evaluate(slots, drive.beta, step.t + C[s] * step.h, workspace.end, workspace.k[s], workspace.forces)
    return error_norm(method.tolerance, step.h, y, workspace, slots.chain.inverse_mass.size)


@inline_numba
def error_norm(tolerance, h, y, workspace, bodies):
    """The combined error estimate of orders 5 and 3 in units of the tolerance, as a root mean square over the beads."""
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
    # as in Hairer's dop853.f: 0.01 weights the error of order 3, which keeps the quotient regular where order 5 is tiny
    return abs(h) * fifth / sqrt((fifth + 0.01 * third) * (2 * (bodies - 2)))


@prepare_dense.of(Dop853Workspace)
def _(workspace, step):
    slots, drive, y, _ = step.trajectory
    for s in range(STAGES + 1, ALL_STAGES):
        combine(y, step.h, workspace.k, s, workspace.stage)
        evaluate(slots, drive.beta, step.t + C[s] * step.h, workspace.stage, workspace.k[s], workspace.forces)
    dense_coefficients(step.h, y, workspace)
    return DENSE_EVALUATIONS


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


@dense_value.of(Dop853Workspace)
def _(workspace, y, h, x, i):
    dense = workspace.dense
    rows = (dense[0, i], dense[1, i], dense[2, i], dense[3, i], dense[4, i], dense[5, i], dense[6, i])
    return interpolant(y[i], rows, x)
