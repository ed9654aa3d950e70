"""A chain pushed by a sampled force: fixed steps in w from sample to sample, split where a contact opens or closes.

Between two samples the force is one cubic, so that steps that end at the samples see a smooth right-hand side.
"""

from __future__ import annotations

from ..forces.largest import watch_state
from ..jit import kernel
from ..samples import first_not_finite, keep
from ..status import CANCELLED, DONE, NOT_FINITE, STEPS_BETWEEN_STOP_CHECKS
from .step import step


@kernel
def run_observed(method, slots, spans, pieces, substeps, y, stages, drive, samples, log, counts, stop):
    """Run through all intervals and keep the state at every sample, the first one included.

    Interval i lasts spans[i], its force is the cubic pieces[i] (constant term first) and it is taken in substeps[i]
    steps; `drive` is empty, so that the force is evaluated at every stage. Returns (status, rows filled).
    """
    m = slots.chain.inverse_mass.size
    taken = 0
    watch_state(slots, y, stages.k[0], stages.forces.e, 0.0, log)
    keep(slots, 0, y, stages.k[0], stages.forces.e, samples)
    for i in range(spans.size):
        for q in range(4):
            slots.driver.piece[q] = pieces[i, q]
        h = spans[i] / substeps[i]
        for j in range(substeps[i]):
            left = step(method, slots, drive, j, j * h, h, h, y, stages, log, counts)
            watch_state(slots, y, stages.k[0], stages.forces.e, left, log)
            taken += 1
            if taken % STEPS_BETWEEN_STOP_CHECKS == 0 and stop[0] != 0:
                return CANCELLED, i + 1
        if first_not_finite(y, m) != 0:
            return NOT_FINITE, i + 1
        keep(slots, i + 1, y, stages.k[0], stages.forces.e, samples)
    return DONE, spans.size + 1
