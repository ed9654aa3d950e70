"""The largest forces inside an accepted step with error control, on the dense output.

A force is evaluated at both ends of a step and, under the first two conditions below, in the middle. Around events, a
step begins just past one and ends just past the next, so these values are right limits, and they include the jump of a
closing contact. A maximum inside the step is searched for by golden section, as accurately as the dense output allows,
if

- a force at an end of the step is above `SEARCHED` times the largest so far,
- the cubic through values and slopes of some force is not monotone (`is_monotone`),
- that force may have its maximum inside the step (`may_hold_maximum`), and
- the larger of its middle value and the cubic's maximum is above `WORTH` times the largest so far.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..compiling.jit import inline_llvm, internal
from ..effects.contact import elastic_force, elastic_slope
from ..effects.dissipation import dashpot_force
from ..effects.preload import overlap
from ..effects.tension import cut_at_zero
from ..forces.largest import cubic_top, force_slope
from ..forces.peaks import row_of
from ..simd.functions import positive_part
from ..status import EVALUATIONS
from .bracket import maximum_inside, value_at
from .step import evaluate, prepare_dense, stages, write_dense_state

#: Golden sections around the maximum of a force; each shrinks the bracket by 0.618 and, since a maximum is flat, the
#: error of its value by 0.382.
FORCE_SECTIONS = 24
#: A step whose ends are below this part of the largest force so far is not searched.
SEARCHED = 0.3
#: A maximum is not searched if the cubic through the values and slopes at both ends puts it below this part of the
#: largest force so far.
WORTH = 0.98


class Force(NamedTuple):
    """Input, output or elastic output force (0, 1, 2) inside a step; evaluations are counted."""

    number: int
    counts: np.ndarray


@internal
def forces_of(slots, y, dy):
    """Input, output and elastic output force at state y, with the velocities in dy."""
    last = slots.chain.stiffness.size - 1
    first_overlap, last_overlap = overlap(slots.preload, y, 0), overlap(slots.preload, y, last)
    elastic = elastic_force(slots.chain.stiffness[0], positive_part(first_overlap))
    input_force = elastic + dashpot_force(slots.dissipation, first_overlap, dy[0] - dy[1])
    elastic = elastic_force(slots.chain.stiffness[last], positive_part(last_overlap))
    output_force = elastic + dashpot_force(slots.dissipation, last_overlap, dy[last] - dy[last + 1])
    return cut_at_zero(slots.tension, input_force), cut_at_zero(slots.tension, output_force), elastic


@internal
def forces_in_step(step, x):
    """The three forces at fraction x of the step, whose dense output is prepared."""
    slots, drive, _, workspace = step.trajectory
    write_dense_state(step, x)
    evaluate(slots, drive.beta, step.t + x * step.h, workspace.probe, workspace.slope, workspace.forces)
    return forces_of(slots, workspace.probe, workspace.slope)


@value_at.of(Force)
def _(quantity, step, x):
    quantity.counts[EVALUATIONS] += 1
    return forces_in_step(step, x)[quantity.number]


@internal
def write_end_elastic_forces(slots, y, dy, e):
    """Write the elastic forces, including those of a cut, of the two outermost contacts at either end."""
    last = slots.chain.stiffness.size - 1
    for q in range(4):
        c = min(q, last) if q < 2 else max(last + q - 3, 0)
        delta = overlap(slots.preload, y, c)
        damped = dashpot_force(slots.dissipation, delta, dy[c] - dy[c + 1])
        elastic = elastic_force(slots.chain.stiffness[c], positive_part(delta))
        e[c] = cut_at_zero(slots.tension, elastic + damped) - damped


@internal
def slopes_of(slots, y, dy, workspace):
    """Slopes Ḟ of the three forces at state y."""
    last = slots.chain.stiffness.size - 1
    write_end_elastic_forces(slots, y, dy, workspace.forces.e)
    e, d = workspace.forces.e, positive_part(overlap(slots.preload, y, last))
    elastic = elastic_slope(slots.chain.stiffness[last], d) * (dy[last] - dy[last + 1])
    return force_slope(slots, y, dy, e, 0, -1, False), force_slope(slots, y, dy, e, last, -1, False), elastic


@internal
def is_monotone(f0, s0, f1, s1, h):
    """Whether the cubic with values f0, f1 and slopes s0, s1 at the ends of a step of size h rises or falls throughout.

    Sufficient condition: both slopes have the chord's sign and are at most three times as steep (Fritsch & Carlson
    1980).
    """
    chord = 3.0 * (f1 - f0)
    return chord * s0 >= 0.0 and chord * s1 >= 0.0 and h * max(abs(s0), abs(s1)) <= abs(chord)


@inline_llvm
def may_hold_maximum(start, rises, middle, end, falls):
    """Whether a force may be largest inside a step: it rises at the start or to the middle, and falls towards the end.

    `rises` and `falls` are its slopes at the two ends. If it turns twice, the slopes alone would miss a maximum.
    """
    return (rises > 0.0 or middle > start) and (falls < 0.0 or middle > end)


@internal
def update_forces_in_step(step, ready, peaks, counts):
    """Raise the largest forces to those in the accepted step; return whether its dense output has been prepared.

    A force that only rises or only falls is largest at an end.
    """
    slots, _, y, workspace = step.trajectory
    slope, end_slope = workspace.k[0], workspace.k[stages(workspace)]
    start, end = forces_of(slots, y, slope), forces_of(slots, workspace.end, end_slope)
    large = False
    for q in range(3):
        peaks[row_of(q)] = max(peaks[row_of(q)], start[q], end[q])
        large = large or max(start[q], end[q]) > SEARCHED * peaks[row_of(q)]
    if not large:
        return ready
    rises = slopes_of(slots, y, slope, workspace)
    falls = slopes_of(slots, workspace.end, end_slope, workspace)
    turns = False
    for q in range(3):
        turns = turns or not is_monotone(start[q], rises[q], end[q], falls[q], step.h)
    if not turns:
        return ready
    if not ready:
        counts[EVALUATIONS] += prepare_dense(workspace, step)
    middle = forces_in_step(step, 0.5)
    counts[EVALUATIONS] += 1
    for q in range(3):
        peaks[row_of(q)] = max(peaks[row_of(q)], middle[q])
        guess = max(middle[q], cubic_top(start[q], rises[q], end[q], falls[q], step.h))
        if (may_hold_maximum(start[q], rises[q], middle[q], end[q], falls[q])
                and guess > WORTH * peaks[row_of(q)]):
            _, top = maximum_inside(Force(q, counts), step, 1.0, FORCE_SECTIONS)
            peaks[row_of(q)] = max(peaks[row_of(q)], top)
    return True
