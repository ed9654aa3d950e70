"""One step of the fixed-step methods: classical RK4 in w, plain or split at contact events.

`rk4` is the formula. `step` is each method's step: a plain one, or a whole step that is undone and then `split`
wherever a contact opens or closes in it. The drive phase follows from an integer count of steps, so that rounding
errors do not accumulate in the time.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot, by_type_inlined
from ..compiling.jit import inline_numba, internal
from ..contact_cubic import turns
from ..effects.driver import driver_displacement, driver_velocity
from ..effects.energy_account import DRIVER_WORK, EnergyAccount
from ..effects.preload import overlap
from ..equations.motion import copy, motion
from ..forces.crossings import end_approaches, record_crossings
from ..forces.largest import Instant, Span, update_forces_across_event
from ..status import EVALUATIONS, EVENTS, STEPS
from ..step_ends import DISPLACEMENT_ERROR, MOMENTUM_ERROR, OVERLAP, OVERLAP_END, RATE, RATE_END
from .contact_events import (
    MOST_SPLITS,
    add_quadrature_errors,
    first_event,
    nearer_event,
    reset_corrections,
)


class Rk4(NamedTuple):
    """Method slot: RK4 in w, ignoring contact events; its order is in `integrate.METHODS`."""

    steps_per_period: int


class Rk4Split(NamedTuple):
    """Method slot: RK4 in w with steps split where a contact opens or closes."""

    steps_per_period: int


class Rk4Workspace(NamedTuple):
    """Workspace of one step: slopes k (4, M), a stage state and the step's end (M,), force arrays.

    `ends` (6, N+1) are overlaps, rates and quadrature errors of a split step; step_ends.py names the rows. `simd` is
    the workspace of steps with SIMD along the chain (short_chain.py, long_chain.py), or None.
    """

    k: np.ndarray
    stage: np.ndarray
    end: np.ndarray
    ends: np.ndarray
    forces: Any
    simd: Any


class DriveTable(NamedTuple):
    """The driver in equal steps: its (u_0, v_0) at every half step of a period, the phase per step, the step size.

    `values` has no rows if a period has too many steps for a table; the driver is then evaluated at every step.
    """

    values: np.ndarray
    dtheta: float
    h: float


@internal
def tabulated_displacement(slots, drive, i):
    """u_0 at half-step index i of the period."""
    values, dtheta, _ = drive
    return values[i, 0] if values.shape[0] > 0 else driver_displacement(slots.driver, 0.5 * dtheta * i)


@internal
def tabulated_velocity(slots, drive, i):
    """v_0 at half-step index i of the period."""
    values, dtheta, _ = drive
    return values[i, 1] if values.shape[0] > 0 else driver_velocity(slots.driver, 0.5 * dtheta * i)


@internal
def rk4(slots, ua, va, ub, vb, h, y, workspace):
    """Take one RK4 step of size h from y, whose slope is workspace.k[0], to workspace.end.

    The driver's displacement and velocity are (ua, va) at mid-step and (ub, vb) at the end.
    """
    k, stage, end, forces = workspace.k, workspace.stage, workspace.end, workspace.forces
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


@inline_numba
def may_change(slots, y, slope, end, end_slope):
    """Whether a contact may open or close within the step: its overlap has another sign at the end, or turns.

    docs/method.md has a table of this test in the other integrators; tests/kernels/test_event_predicates.py compares
    them. The loop has no branches, so that the compiler can vectorise it.
    """
    changed = 0
    for c in range(slots.chain.stiffness.size):
        before, after = int(overlap(slots.preload, y, c) > 0.0), int(overlap(slots.preload, end, c) > 0.0)
        rising, risen = int(slope[c] - slope[c + 1] > 0.0), int(end_slope[c] - end_slope[c + 1] > 0.0)
        changed |= (before ^ after) | turns(before, rising, risen)
    return changed != 0


@internal
def write_overlaps(slots, y, slope, ends, overlaps, rates):
    """Write overlaps and their rates at one end of a step."""
    for c in range(slots.chain.stiffness.size):
        ends[overlaps, c] = overlap(slots.preload, y, c)
        ends[rates, c] = slope[c] - slope[c + 1]


@internal
def correct_state(slots, ends, v0, y):
    """Subtract from y the quadrature errors next to contact events; the driver moves at v0."""
    inverse_mass = slots.chain.inverse_mass
    bodies = inverse_mass.size
    for i in range(1, bodies - 1):
        y[i] += inverse_mass[i] * (ends[DISPLACEMENT_ERROR, i] - ends[DISPLACEMENT_ERROR, i - 1])
        y[bodies + i] += inverse_mass[i] * (ends[MOMENTUM_ERROR, i] - ends[MOMENTUM_ERROR, i - 1])
    correct_work(slots.account, ends[MOMENTUM_ERROR, 0] * v0, y)


@by_slot
def correct_work(account, excess, y):
    """Subtract the error of contact 0's impulse, times v_0, from the driver's work.

    Effect absent: no work is recorded.
    """


@correct_work.of(EnergyAccount)
def _(account, excess, y):
    y[DRIVER_WORK] -= excess


@by_type_inlined
def step(method, trajectory, j, out):
    """Advance y by step j of the period, with the driver in rows 2j to 2j + 2 of its table.

    workspace.k[0] is dy/dt at y before and after. The largest forces and jumps inside the step go into the log. Returns
    the time from the last state that the log has covered to the step's end.
    """


@internal
def whole_step(trajectory, j):
    """Take an RK4 step, step j of the period, to workspace.end; return the driver's displacement and velocity."""
    slots, drive, y, workspace = trajectory
    ua, va = tabulated_displacement(slots, drive, 2 * j + 1), tabulated_velocity(slots, drive, 2 * j + 1)
    ub, vb = tabulated_displacement(slots, drive, 2 * j + 2), tabulated_velocity(slots, drive, 2 * j + 2)
    rk4(slots, ua, va, ub, vb, drive.h, y, workspace)
    return ub, vb


@internal
def span_of(drive, j):
    """`Span` of step j of the period."""
    return Span(drive.h, j * drive.dtheta, drive.dtheta)


@step.of(Rk4)
def _(method, trajectory, j, out):
    slots, drive, y, workspace = trajectory
    now = Instant(y, workspace.k[0])
    before = end_approaches(slots.dissipation, slots, now)
    ub, vb = whole_step(trajectory, j)
    copy(workspace.end, y)
    motion(slots, ub, vb, y, workspace.k[0], workspace.forces)
    record_crossings(slots.dissipation, slots, before, now, span_of(drive, j), out.log)
    out.counts[STEPS] += 1
    out.counts[EVALUATIONS] += 4
    return drive.h


@step.of(Rk4Split)
def _(method, trajectory, j, out):
    slots, drive, y, workspace = trajectory
    ub, vb = whole_step(trajectory, j)
    k, end, since = workspace.k, workspace.end, drive.h
    motion(slots, ub, vb, end, k[3], workspace.forces)
    out.counts[STEPS] += 1
    out.counts[EVALUATIONS] += 4
    if may_change(slots, y, k[0], end, k[3]):
        since = split(trajectory, j, ub, vb, out)
    for i in range(y.size):
        y[i], k[0, i] = end[i], k[3, i]
    return since


@internal
def split(trajectory, j, u_end, v_end, out):
    """Repeat step j of the period, in which contacts open or close, from event to event; its end is workspace.end.

    `split_short_step` (short_chain_steps.py) is the same in vectors, and is tested against this function. The driver is
    at u_end, moving at v_end, at the end. Returns the time from the last event to the step's end.
    """
    slots, drive, y, workspace = trajectory
    ends, end, k, h, dtheta = workspace.ends, workspace.end, workspace.k, drive.h, drive.dtheta
    theta, done, last = j * dtheta, 0.0, slots.chain.stiffness.size - 1
    reset_corrections(ends)
    write_overlaps(slots, y, k[0], ends, OVERLAP, RATE)
    for _ in range(MOST_SPLITS):
        write_overlaps(slots, end, k[3], ends, OVERLAP_END, RATE_END)
        contact, first = first_event(ends, last + 1, h * (1.0 - done))
        if first > 1.0:
            break
        part = first * (1.0 - done)
        for _ in range(2):
            stepped = part
            middle, theta_event = theta + dtheta * (done + 0.5 * part), theta + dtheta * (done + part)
            u, v = driver_displacement(slots.driver, theta_event), driver_velocity(slots.driver, theta_event)
            rk4(slots, driver_displacement(slots.driver, middle), driver_velocity(slots.driver, middle),
                u, v, h * part, y, workspace)
            motion(slots, u, v, end, k[3], workspace.forces)
            write_overlaps(slots, end, k[3], ends, OVERLAP, RATE)
            out.counts[EVALUATIONS] += 4
            part = nearer_event(slots.dissipation, ends, contact, last, part, 1.0 - done, h)
            if part == stepped:
                break
        done += stepped
        copy(end, y)
        copy(k[3], k[0])
        update_forces_across_event(slots, y, k[0], workspace.forces.e, h * stepped, contact, theta_event, out.log)
        add_quadrature_errors(slots.dissipation, slots.chain.stiffness[contact], ends, contact, h, done)
        middle = theta + dtheta * 0.5 * (1.0 + done)
        rk4(slots, driver_displacement(slots.driver, middle), driver_velocity(slots.driver, middle),
            u_end, v_end, h * (1.0 - done), y, workspace)
        correct_state(slots, ends, v_end, end)
        motion(slots, u_end, v_end, end, k[3], workspace.forces)
        out.counts[EVALUATIONS] += 4
        out.counts[EVENTS] += 1
    return h * (1.0 - done)
