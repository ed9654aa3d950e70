"""Runs of a fixed-step method over whole periods or samples, with the largest forces in between."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot_inlined
from ..compiling.jit import internal, kernel
from ..effects.contact import elastic_force
from ..effects.preload import overlap
from ..equations.motion import contact_force, motion
from ..forces.largest import SAMPLE, update_forces
from ..forces.peaks import INPUT, OUTPUT, OUTPUT_ELASTIC, next_period, update_peak, write_largest_forces
from ..samples import Samples, first_not_finite, write_sample, write_strobe
from ..simd.functions import positive_part
from ..status import CANCELLED, DONE, EVALUATIONS, NOT_FINITE, STEPS, STEPS_BETWEEN_STOP_CHECKS
from .long_chain import LongChain, steps_without_events
from .short_chain import ShortChain
from .short_chain_steps import run_short_chain
from .step import step, tabulated_displacement, tabulated_velocity


@by_slot_inlined
def advance(simd, method, trajectory, j, count, out):
    """Take `count` steps from step index j of the period. Without SIMD along the chain: one by one.

    The stop flag is read every `STEPS_BETWEEN_STOP_CHECKS` steps; once it is set, fewer steps are taken. Calls for long
    chains are short (integrate/parts.py).
    """
    slots, _, y, workspace = trajectory
    for i in range(j, j + count):
        since = step(method, trajectory, i, out)
        update_forces(slots, y, workspace.k[0], workspace.forces.e, since, out.log)
        if i % STEPS_BETWEEN_STOP_CHECKS == 0 and out.stop[0] != 0:
            break


@advance.of(ShortChain)
def _(simd, method, trajectory, j, count, out):
    run_short_chain(simd, trajectory, j, count, out)


@advance.of(LongChain)
def _(simd, method, trajectory, j, count, out):
    slots, drive, y, workspace = trajectory
    done = 0
    while done < count and out.stop[0] == 0:
        most = min(count - done, STEPS_BETWEEN_STOP_CHECKS)
        smooth = steps_without_events(simd, trajectory, j + done, most, out.log.peaks)
        if smooth > 0:
            done += smooth
            out.counts[STEPS] += smooth
            out.counts[EVALUATIONS] += 4 * smooth
            i = 2 * (j + done)
            u0, v0 = tabulated_displacement(slots, drive, i), tabulated_velocity(slots, drive, i)
            motion(slots, u0, v0, y, workspace.k[0], workspace.forces)
        if done < count:
            update_forces(slots, y, workspace.k[0], workspace.forces.e, 0.0, out.log)
            since = step(method, trajectory, j + done, out)
            update_forces(slots, y, workspace.k[0], workspace.forces.e, since, out.log)
            update_peaks_at_step_end(slots, y, workspace.k[0], workspace.forces.e, out.log.peaks)
            done += 1


@internal
def update_peaks_at_step_end(slots, y, dy, e, peaks):
    """Update the peaks of the three forces at the end of one of several equal steps (forces/peaks.py)."""
    last = e.size - 1
    update_peak(peaks, INPUT, contact_force(slots, y, dy, e, 0))
    update_peak(peaks, OUTPUT, contact_force(slots, y, dy, e, last))
    d = positive_part(overlap(slots.preload, y, last))
    update_peak(peaks, OUTPUT_ELASTIC, elastic_force(slots.chain.stiffness[last], d))


class RunRecord(NamedTuple):
    """Arrays that a run fills: either samples, or strobes and maxima of whole periods; the others have no rows.

    `samples` has T rows, the first for the start. `strobes` (P + 1, 2, N + 2) are displacement and velocity, the start
    first; `maxima` (P, 3) are the largest forces in the order of `peaks`.
    """

    samples: Samples
    strobes: np.ndarray
    maxima: np.ndarray


@kernel
def run_steps(method, trajectory, first_step, stride, record, out):
    """Run a fixed-step method from step index `first_step` of the period, recording every stride-th state.

    One kernel serves both samples and whole periods, because most of its code is for the steps. Closings are logged.
    Returns (status, samples filled or periods done).
    """
    slots, _, y, workspace = trajectory
    bodies, log, j = slots.chain.inverse_mass.size, out.log, first_step
    sampled = record.samples.displacement.shape[0] > 0
    update_forces(slots, y, workspace.k[0], workspace.forces.e, 0.0, log)
    if sampled:
        write_sample(slots, 0, y, workspace.k[0], workspace.forces.e, record.samples)
    else:
        write_strobe(y, workspace.k[0], record.strobes[0])
    for i in range(record.samples.displacement.shape[0] - 1 if sampled else record.maxima.shape[0]):
        if first_not_finite(y, bodies) != 0:  # before a step spreads the failure, so that the bead can be reported
            return NOT_FINITE, i
        if sampled:
            log.counts[SAMPLE] = i
        else:
            next_period(log.peaks)
        advance(workspace.simd, method, trajectory, j, stride, out)
        j = 0 if j + stride == method.steps_per_period else j + stride
        done = i + 1 if sampled else i
        if out.stop[0] != 0:
            return CANCELLED, done
        if first_not_finite(y, bodies) != 0:
            return NOT_FINITE, done
        if sampled:
            write_sample(slots, i + 1, y, workspace.k[0], workspace.forces.e, record.samples)
        else:
            write_strobe(y, workspace.k[0], record.strobes[i + 1])
            write_largest_forces(log.peaks, record.maxima[i])
    return DONE, max(record.samples.displacement.shape[0], record.maxima.shape[0])
