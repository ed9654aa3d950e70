"""Steps of a short chain in one vector: whole ones, those split at contact events, and the forces at the two ends."""

from __future__ import annotations

import numpy as np

from ..effects.contact import positive_part
from ..effects.dissipation import damping
from ..effects.driver import driver_displacement, driver_velocity
from ..forces.largest import watch_ends_at_event
from ..forces.peaks import HIGHEST, INPUT, OUTPUT, OUTPUT_ELASTIC, watch
from ..jit import inline_llvm, inline_numba, internal
from ..simd.functions import larger
from ..simd.subnormals import flush_subnormals, restore_subnormals
from ..simd.vector import at, blank, positive_mask
from ..status import EVALUATIONS, EVENTS, STEPS
from .contact_events import (
    DISPLACEMENT_ERROR,
    MOMENTUM_ERROR,
    MOST_SPLITS,
    add_quadrature_errors,
    first_event,
    nearer_event,
    reset_corrections,
)
from .short_chain import (
    BEGIN,
    BLOCK,
    DU,
    ELASTIC,
    END,
    NET_FORCE,
    U,
    W,
    load_row,
    load_state,
    row_at,
    row_correction,
    row_of,
    row_step,
    store_state,
)
from .step import drive_displacement, drive_velocity


@inline_numba
def split_row(wide, trajectory, j, u_end, v_end, out):
    """Repeat step j in the workspace from contact event to contact event; its end is written there anew.

    The driver is at u_end, moving at v_end, at the end.
    """
    slots, drive, _, _ = trajectory
    h, dtheta, theta = drive.h, drive.dtheta, j * drive.dtheta
    ends, row, driver, done = wide.ends, row_of(wide, slots), slots.driver, 0.0
    last = slots.chain.stiffness.size - 1
    reset_corrections(ends)
    for _ in range(MOST_SPLITS):
        first, contact = first_event(ends, last + 1, h * (1.0 - done))
        if first > 1.0:
            return
        part, start = first * (1.0 - done), load_state(wide, BEGIN)
        for _ in range(2):
            stepped = part
            middle, there = theta + dtheta * (done + 0.5 * part), theta + dtheta * (done + part)
            event = row_step(row, driver_displacement(driver, middle), driver_displacement(driver, there),
                             driver_velocity(driver, there), h * part, start, blank(start.u), blank(start.w))
            store_state(wide, BEGIN, event)
            out.counts[EVALUATIONS] += 4
            part = nearer_event(slots.dissipation, ends, contact, last, part, 1.0 - done, h)
            if part == stepped:
                break
        done += stepped
        add_quadrature_errors(slots.dissipation, wide.stiffness[0, contact], ends, contact, h, done)
        # after add_quadrature_errors, which gives the overlap the sign that it has after the event
        watch_ends_at_event(slots, ends, contact, there, out.log)
        middle = theta + dtheta * 0.5 * (1.0 + done)
        end = row_step(row, driver_displacement(driver, middle), u_end, v_end, h * (1.0 - done), event,
                       row_correction(row, load_row(wide.width, ends, DISPLACEMENT_ERROR)),
                       row_correction(row, load_row(wide.width, ends, MOMENTUM_ERROR)))
        store_state(wide, END, end)
        out.counts[EVALUATIONS] += 4
        out.counts[EVENTS] += 1


@inline_llvm
def keep_forces(wide, row, last, k, x):
    """Write input force, output force and its elastic part at step k of a block; returns them."""
    gap, rate, elastic = at(x.gap, last), at(x.rate, last), at(x.elastic, last)
    pushed = at(x.elastic, 0) + damping(row.dissipation, positive_part(at(x.gap, 0))) * at(x.rate, 0)
    passed = elastic + damping(row.dissipation, positive_part(gap)) * rate
    wide.forces[0, k], wide.forces[1, k], wide.forces[2, k] = pushed, passed, elastic
    return pushed, passed, elastic


@internal
def watch_block(values, count, largest, peaks, first):
    """Follow one force through the steps of a block; step by step only where a largest value may be among them."""
    skipped = 0 if HIGHEST * largest > peaks[first] else max(0, count - 4)
    for k in range(skipped, count):
        watch(peaks, first, values[k])


@inline_numba
def follow_block(wide, count, tops, peaks):
    """Follow the three forces through the last `count` steps, whose largest values are `tops`."""
    watch_block(wide.forces[0], count, tops[0], peaks, INPUT)
    watch_block(wide.forces[1], count, tops[1], peaks, OUTPUT)
    watch_block(wide.forces[2], count, tops[2], peaks, OUTPUT_ELASTIC)


@inline_llvm
def start_row(wide, row, trajectory, j):
    """The chain in the trajectory's state at step j."""
    slots, drive, y, _ = trajectory
    rows, m = wide.rows, slots.chain.inverse_mass.size
    for i in range(m):
        rows[U, i], rows[W, i] = y[i], y[m + i]
    return row_at(row, drive_displacement(slots, drive, 2 * j), drive_velocity(slots, drive, 2 * j),
                  load_row(wide.width, rows, U), load_row(wide.width, rows, W))


@inline_numba
def end_row(wide, x, trajectory, j):
    """Write the chain at step j into the trajectory: state, slope and elastic forces."""
    slots, drive, y, stages = trajectory
    rows, dy, e, m = wide.rows, stages.k[0], stages.forces.e, slots.chain.inverse_mass.size
    store_state(wide, BEGIN, x)
    for i in range(1, m - 1):
        y[i], y[m + i], dy[i] = rows[U, i], rows[W, i], rows[DU, i]
        dy[m + i] = wide.inverse_mass[0, i] * rows[NET_FORCE, i]
        e[i] = rows[ELASTIC, i]
    e[0] = rows[ELASTIC, 0]
    y[0] = drive_displacement(slots, drive, 2 * j)
    dy[0] = drive_velocity(slots, drive, 2 * j)


@inline_numba
def run_short_chain(wide, trajectory, j, count, out):
    """Take `count` steps from step index j of the period, slope and forces at the end included.

    The stop flag leaves them incomplete.
    """
    slots, drive, _, _ = trajectory
    row, before, last = row_of(wide, slots), flush_subnormals(), slots.chain.stiffness.size - 1
    x = start_row(wide, row, trajectory, j)
    closed, rising, nothing = positive_mask(x.gap), positive_mask(x.rate), blank(x.w)
    taken = count
    for first in range(j, j + count, BLOCK):
        block = min(BLOCK, j + count - first)
        top_in, top_out, top_elastic = -np.inf, -np.inf, -np.inf
        for k in range(block):
            i = 2 * (first + k)
            ua, ub = drive_displacement(slots, drive, i + 1), drive_displacement(slots, drive, i + 2)
            vb = drive_velocity(slots, drive, i + 2)
            end = row_step(row, ua, ub, vb, drive.h, x, nothing, nothing)
            closed_after, rising_after = positive_mask(end.gap), positive_mask(end.rate)
            # another sign, or moving towards zero at the start and away from it at the end
            if (closed_after ^ closed) | ((rising ^ closed) & ~(rising_after ^ closed)) != 0:
                store_state(wide, BEGIN, x)
                store_state(wide, END, end)
                split_row(wide, trajectory, first + k, ub, vb, out)
                end = load_state(wide, END)
                closed_after, rising_after = positive_mask(end.gap), positive_mask(end.rate)
            x, closed, rising = end, closed_after, rising_after
            pushed, passed, elastic = keep_forces(wide, row, last, k, x)
            top_in, top_out = larger(top_in, pushed), larger(top_out, passed)
            top_elastic = larger(top_elastic, elastic)
        follow_block(wide, block, (top_in, top_out, top_elastic), out.log.peaks)
        if out.stop[0] != 0:
            taken = first + block - j
            break
    restore_subnormals(before)
    out.counts[STEPS] += taken
    out.counts[EVALUATIONS] += 4 * taken
    end_row(wide, x, trajectory, j + taken)
