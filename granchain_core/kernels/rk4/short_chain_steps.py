"""Steps of a short chain in one vector, whole or split at contact events, and the forces at the chain's two ends."""

from __future__ import annotations

import numpy as np

from ..compiling.jit import inline_llvm, inline_numba, internal
from ..contact_cubic import turns
from ..effects.dissipation import dashpot_force
from ..effects.driver import driver_displacement, driver_velocity
from ..equations.chain_in_vector import chain_values, load_row
from ..forces.largest import update_end_forces_at_event
from ..forces.peaks import HIGHEST, INPUT, OUTPUT, OUTPUT_ELASTIC, update_peak
from ..simd.functions import larger
from ..simd.subnormals import flush_subnormals, restore_subnormals
from ..simd.vector import at, blank, positive_mask
from ..status import EVALUATIONS, EVENTS, STEPS
from ..step_ends import DISPLACEMENT_ERROR, MOMENTUM_ERROR
from .contact_events import (
    MOST_SPLITS,
    add_quadrature_errors,
    first_event,
    nearer_event,
    reset_corrections,
)
from .short_chain import (
    BEGIN,
    DU,
    ELASTIC,
    END,
    NET_FORCE,
    STEPS_IN_BLOCK,
    U,
    W,
    chain_at,
    chain_correction,
    chain_step,
    load_state,
    store_state,
)
from .step import tabulated_displacement, tabulated_velocity


@inline_numba
def split_short_step(short, trajectory, j, u_end, v_end, out):
    """Repeat step j in the workspace from contact event to contact event, and overwrite its end there.

    `split` (step.py) is the same in scalar code, and the reference; tests/kernels/simd/test_simd.py compares runs. The
    loops are separate because one has the state in vectors, the other in the trajectory's arrays. The driver is at
    u_end, moving at v_end, at the step's end.
    """
    slots, drive, _, _ = trajectory
    h, dtheta, theta = drive.h, drive.dtheta, j * drive.dtheta
    ends, values, driver, done = short.ends, chain_values(short, slots), slots.driver, 0.0
    last = slots.chain.stiffness.size - 1
    reset_corrections(ends)
    for _ in range(MOST_SPLITS):
        contact, first = first_event(ends, last + 1, h * (1.0 - done))
        if first > 1.0:
            return
        part, start = first * (1.0 - done), load_state(short, BEGIN)
        for _ in range(2):
            stepped = part
            middle, theta_event = theta + dtheta * (done + 0.5 * part), theta + dtheta * (done + part)
            event = chain_step(values, driver_displacement(driver, middle), driver_displacement(driver, theta_event),
                               driver_velocity(driver, theta_event), h * part, start, blank(start.u), blank(start.w))
            store_state(short, BEGIN, event)
            out.counts[EVALUATIONS] += 4
            part = nearer_event(slots.dissipation, ends, contact, last, part, 1.0 - done, h)
            if part == stepped:
                break
        done += stepped
        add_quadrature_errors(slots.dissipation, short.stiffness[0, contact], ends, contact, h, done)
        # after add_quadrature_errors, which gives the overlap its sign after the event
        update_end_forces_at_event(slots, ends, contact, theta_event, out.log)
        middle = theta + dtheta * 0.5 * (1.0 + done)
        end = chain_step(values, driver_displacement(driver, middle), u_end, v_end, h * (1.0 - done), event,
                         chain_correction(values, load_row(short.width, ends, DISPLACEMENT_ERROR)),
                         chain_correction(values, load_row(short.width, ends, MOMENTUM_ERROR)))
        store_state(short, END, end)
        out.counts[EVALUATIONS] += 4
        out.counts[EVENTS] += 1


@inline_llvm
def keep_forces(short, values, last, k, x):
    """Write input force, output force and its elastic part at step k of a block, and return them."""
    overlap, rate, elastic = at(x.overlap, last), at(x.rate, last), at(x.elastic, last)
    input_force = at(x.elastic, 0) + dashpot_force(values.slots.dissipation, at(x.overlap, 0), at(x.rate, 0))
    output_force = elastic + dashpot_force(values.slots.dissipation, overlap, rate)
    short.forces[0, k], short.forces[1, k], short.forces[2, k] = input_force, output_force, elastic
    return input_force, output_force, elastic


@internal
def update_block_peak(values, count, largest, peaks, first):
    """Update the peak of one force with the steps of a block, one by one only if they may contain a new maximum."""
    skipped = 0 if HIGHEST * largest > peaks[first] else max(0, count - 4)
    for k in range(skipped, count):
        update_peak(peaks, first, values[k])


@inline_numba
def update_block_peaks(short, count, maxima, peaks):
    """Update the peaks of the three forces with the last `count` steps, whose largest values are `maxima`."""
    update_block_peak(short.forces[0], count, maxima[0], peaks, INPUT)
    update_block_peak(short.forces[1], count, maxima[1], peaks, OUTPUT)
    update_block_peak(short.forces[2], count, maxima[2], peaks, OUTPUT_ELASTIC)


@inline_llvm
def start_chain(short, values, trajectory, j):
    """Evaluate the chain in the trajectory's state at step j."""
    slots, drive, y, _ = trajectory
    rows, bodies = short.rows, slots.chain.inverse_mass.size
    for i in range(bodies):
        rows[U, i], rows[W, i] = y[i], y[bodies + i]
    return chain_at(values, tabulated_displacement(slots, drive, 2 * j), tabulated_velocity(slots, drive, 2 * j),
                    load_row(short.width, rows, U), load_row(short.width, rows, W))


@inline_numba
def write_chain(short, x, trajectory, j):
    """Write the chain at step j into the trajectory: state, slope and elastic forces."""
    slots, drive, y, workspace = trajectory
    rows, dy, e, bodies = short.rows, workspace.k[0], workspace.forces.e, slots.chain.inverse_mass.size
    store_state(short, BEGIN, x)
    for i in range(1, bodies - 1):
        y[i], y[bodies + i], dy[i] = rows[U, i], rows[W, i], rows[DU, i]
        dy[bodies + i] = short.inverse_mass[0, i] * rows[NET_FORCE, i]
        e[i] = rows[ELASTIC, i]
    e[0] = rows[ELASTIC, 0]
    y[0] = tabulated_displacement(slots, drive, 2 * j)
    dy[0] = tabulated_velocity(slots, drive, 2 * j)


@inline_numba
def run_short_chain(short, trajectory, j, count, out):
    """Take `count` steps from step index j of the period; also write slope and forces at the end.

    Fewer steps are taken if the stop flag is set.
    """
    slots, drive, _, _ = trajectory
    values, before, last = chain_values(short, slots), flush_subnormals(), slots.chain.stiffness.size - 1
    x = start_chain(short, values, trajectory, j)
    closed, rising, zero = positive_mask(x.overlap), positive_mask(x.rate), blank(x.w)
    taken = count
    for first in range(j, j + count, STEPS_IN_BLOCK):
        block = min(STEPS_IN_BLOCK, j + count - first)
        top_in, top_out, top_elastic = -np.inf, -np.inf, -np.inf
        for k in range(block):
            i = 2 * (first + k)
            ua, ub = tabulated_displacement(slots, drive, i + 1), tabulated_displacement(slots, drive, i + 2)
            vb = tabulated_velocity(slots, drive, i + 2)
            end = chain_step(values, ua, ub, vb, drive.h, x, zero, zero)
            closed_after, rising_after = positive_mask(end.overlap), positive_mask(end.rate)
            if (closed ^ closed_after) | turns(closed, rising, rising_after) != 0:  # `may_change` (step.py) in bits
                store_state(short, BEGIN, x)
                store_state(short, END, end)
                split_short_step(short, trajectory, first + k, ub, vb, out)
                end = load_state(short, END)
                closed_after, rising_after = positive_mask(end.overlap), positive_mask(end.rate)
            x, closed, rising = end, closed_after, rising_after
            input_force, output_force, elastic = keep_forces(short, values, last, k, x)
            top_in, top_out = larger(top_in, input_force), larger(top_out, output_force)
            top_elastic = larger(top_elastic, elastic)
        update_block_peaks(short, block, (top_in, top_out, top_elastic), out.log.peaks)
        if out.stop[0] != 0:
            taken = first + block - j
            break
    restore_subnormals(before)
    out.counts[STEPS] += taken
    out.counts[EVALUATIONS] += 4 * taken
    write_chain(short, x, trajectory, j + taken)
