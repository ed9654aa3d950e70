"""One RK4 step of several chains, one per SIMD lane: four stages, each a pass along the chains.

In a pass, no contact waits for another, so that the processor computes several at once. The square-root instruction
computes one root in three in batches of eight, and two in three in batches of four. The others are computed from an
estimate and a series, where simd/functions.py has one. This keeps both the divider and the multiply–add units busy.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..batch_size import BATCH_SIZE
from ..compiling.dispatch import by_slot, by_type_inlined
from ..compiling.jit import inline_llvm
from ..effects.dissipation import JUMP_LAWS, LAWS, SMOOTH_LAWS, dashpot_force, unit_primitive
from ..effects.preload import vector_overlap
from ..equations.body_forces import force_on_bead
from ..forces.crossings import Approach, brief_touch, closing_rate
from ..forces.peaks import (
    INPUT,
    INPUT_JUMP,
    INPUT_UNRESOLVED,
    OUTPUT,
    OUTPUT_ELASTIC,
    OUTPUT_JUMP,
    OUTPUT_UNRESOLVED,
    update_batch_peak,
)
from ..simd.functions import at_least_tiny, gate, larger, positive_part, root, root_by_series
from ..simd.vector import blank, load_batch, positive_mask, store
from .unequal import over_mass, times_stiffness


class Values(NamedTuple):
    """Values of the members' scenes; one number per scene is a vector in a register.

    `wall` is the stiffness of the wall contact, `slots` the effects with a vector for each number, `unequal` the masses
    and stiffnesses (`Unequal`) or None, and `last` the number of the last contact.
    """

    wall: Any
    slots: Any
    unequal: Any
    last: Any


class LeftBead(NamedTuple):
    """The bead at which a pass arrives, in all members: its displacement, and e and G/λ of the contact on its left."""

    u: Any
    e: Any
    primitive: Any


#: The function for the last of three roots. The fastest shares by measurement: docs/benchmarks.md, "The step of a
#: batch".
third_root = root_by_series if BATCH_SIZE == 8 else root


@inline_llvm
def contact(values, root_of, left, right, c, is_wall):
    """Elastic force and primitive G/λ of contact c, with a root by `root_of`: `root` or `root_by_series`."""
    d = at_least_tiny(vector_overlap(values.slots.preload, left, right, c))
    r = root_of(d)
    e = times_stiffness(values.unequal, values.wall, c, is_wall, d * r)
    return e, unit_primitive(values.slots.dissipation, d, r)


@by_slot
def batch_velocity(law, unequal, i, w, difference):
    """v = w + (G_{i-1} − G_i)/m of bead i in all members, from the difference of the primitives G/λ."""
    return w


@batch_velocity.of(*LAWS)
def _(law, unequal, i, w, difference):
    return w + over_mass(unequal, i, law.coefficient * difference)


class Inner(NamedTuple):
    """One of the first three stages: `target` becomes y + ahead·slope."""

    y: Any
    target: Any
    ahead: Any


class Final(NamedTuple):
    """The fourth stage, which completes the step; y1, y2, y3 are the targets of the first three, `sixth` is h/6.

    No slopes need to be stored, since y + h (k1 + 2k2 + 2k3 + k4)/6 = (y1 + 2y2 + y3 − y)/3 + h k4/6.
    """

    y: Any
    y1: Any
    y2: Any
    y3: Any
    sixth: Any


@by_type_inlined
def use_slope(stage, row, slope):
    """Use the slope of one row of the state as the stage requires."""


@use_slope.of(Inner)
def _(stage, row, slope):
    store(stage.target, row, load_batch(stage.y, row) + stage.ahead * slope)


@use_slope.of(Final)
def _(stage, row, slope):
    others = load_batch(stage.y1, row) + 2.0 * load_batch(stage.y2, row) + load_batch(stage.y3, row)
    store(stage.y, row, (1.0 / 3.0) * (others - load_batch(stage.y, row)) + stage.sixth * slope)


@inline_llvm
def bead(values, root_of, stage, source, i, left, is_last):
    """Compute bead i of a stage whose state is `source`; return its velocity and the next bead's `LeftBead`."""
    bodies = values.last + 2
    right = load_batch(source, i + 1)
    e, right_primitive = contact(values, root_of, left.u, right, i, is_last)
    w, law = load_batch(source, bodies + i), values.slots.dissipation
    velocity = batch_velocity(law, values.unequal, i, w, left.primitive - right_primitive)
    use_slope(stage, i, velocity)
    force = force_on_bead(values.slots, i, left.e - e, left.u, velocity)
    use_slope(stage, bodies + i, over_mass(values.unequal, i, force))
    return velocity, LeftBead(right, e, right_primitive)


class ChainEnds(NamedTuple):
    """The chain's two ends in a stage: elastic forces and the beads' velocities."""

    first_elastic: Any
    v_first: Any
    last_elastic: Any
    v_last: Any


@inline_llvm
def run_stage(values, stage, source, driver):
    """Compute one stage at the state `source` with the driver at `driver`; return its `ChainEnds`."""
    last, u = values.last, load_batch(source, 1)
    e_first, first_primitive = contact(values, root_by_series, driver, u, 0, False)
    left, v_first = LeftBead(u, e_first, first_primitive), u
    if last > 1:
        v_first, left = bead(values, root_by_series, stage, source, 1, left, False)
    for i in range(2, last - 2, 3):
        _, left = bead(values, root, stage, source, i, left, False)
        _, left = bead(values, root_by_series, stage, source, i + 1, left, False)
        _, left = bead(values, third_root, stage, source, i + 2, left, False)
    for i in range(max(2, last - (last - 2) % 3), last):
        _, left = bead(values, root, stage, source, i, left, False)
    v_last, left = bead(values, root, stage, source, last, left, True)
    return ChainEnds(e_first, v_first if last > 1 else v_last, left.e, v_last)


@inline_llvm
def batch_step(values, y, stages, h, u0, middle, end):
    """Take one RK4 step in place, the driver at u0, `middle` and `end`; return the `ChainEnds` at its start.

    `stages` has room for the states of three stages.
    """
    y1, y2, y3 = stages
    chain_ends = run_stage(values, Inner(y, y1, 0.5 * h), y, u0)
    run_stage(values, Inner(y, y2, 0.5 * h), y1, middle)
    run_stage(values, Inner(y, y3, h), y2, middle)
    run_stage(values, Final(y, y1, y2, y3, (1.0 / 6.0) * h), y3, end)
    return chain_ends


@inline_llvm
def update_batch_peaks(values, h, first_overlap, last_overlap, v0, chain_ends, before, peaks):
    """Update the peaks of input force, output force and its elastic part in all members, at the start of a step."""
    law = values.slots.dissipation
    first, last = Approach(first_overlap, v0 - chain_ends.v_first), Approach(last_overlap, chain_ends.v_last)
    first_force = chain_ends.first_elastic + dashpot_force(law, first.overlap, first.rate)
    last_force = chain_ends.last_elastic + dashpot_force(law, last.overlap, last.rate)
    update_batch_peak(peaks, INPUT, first_force, INPUT_UNRESOLVED)
    update_batch_peak(peaks, OUTPUT, last_force, OUTPUT_UNRESOLVED)
    update_batch_peak(peaks, OUTPUT_ELASTIC, chain_ends.last_elastic, OUTPUT_UNRESOLVED)
    update_jumps(law, values, h, first, last, before, peaks)


@by_slot
def update_jumps(law, values, h, first, last, before, peaks):
    """Update the largest jumps of both end contacts with those of a step. Effect absent, or g(0) = 0: nothing."""


@update_jumps.of(*JUMP_LAWS)
def _(law, values, h, first, last, before, peaks):
    update_jump(law, over_mass(values.unequal, 1, law.coefficient), h, first, before, 0, peaks, INPUT_JUMP)
    update_jump(law, over_mass(values.unequal, values.last, law.coefficient), h, last, before, 2, peaks, OUTPUT_JUMP)


update_jumps.absent_for(*SMOOTH_LAWS)


@inline_llvm
def update_jump(law, own_damping, h, approach, before, row, peaks, peak):
    """Update the largest jump of one contact.

    Two rows of `before` are its overlap and rate one step ago; they are updated.
    """
    overlap, rate = approach
    overlap_before, rate_before = load_batch(before, row), load_batch(before, row + 1)
    store(before, row, overlap)
    store(before, row + 1, rate)
    zero, was, now = blank(overlap), positive_mask(overlap_before), positive_mask(overlap)
    if now & ~was != 0:
        undamped = rate + own_damping * positive_part(overlap)
        _, closing = closing_rate(overlap_before, overlap, rate_before, undamped, own_damping, h)
        closed = gate(zero - overlap_before, gate(overlap, law.coefficient * closing))
        store(peaks, peak, larger(load_batch(peaks, peak), closed))
    if ~now & ~was & positive_mask(rate_before) & positive_mask(zero - rate) != 0:
        touched = law.coefficient * brief_touch(overlap_before, overlap, rate_before, rate, h)
        open_still = gate(zero - overlap_before, gate(zero - overlap, gate(rate_before, gate(zero - rate, touched))))
        store(peaks, peak, larger(load_batch(peaks, peak), open_still))
