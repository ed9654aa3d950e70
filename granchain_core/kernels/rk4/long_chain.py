"""SIMD along a long chain: RK4 steps in which no contact opens or closes, eight bodies at a time.

Rows of bodies are blocks of eight. Shuffling one block with the next pairs the two bodies of each contact, so every
memory access is aligned. The signs of all overlaps are compared from step to step. A step in which one of them changes
is left to the scalar method, which splits it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_numba, internal
from ..effects.contact import elastic_force
from ..effects.dissipation import LAWS, dashpot_force, primitive
from ..effects.preload import vector_overlap
from ..equations.body_forces import force_on_bead
from ..forces.peaks import INPUT, OUTPUT, OUTPUT_ELASTIC, update_peak
from ..simd.functions import positive_part
from ..simd.vector import BLOCK_WIDTH, from_left, from_right, load8, positive_mask, splat8, store, with_first
from .step import tabulated_displacement, tabulated_velocity


class LongChain(NamedTuple):
    """Workspace in blocks of eight bodies: states (2B, 8) hold B blocks of displacements, then B of w.

    Chain values are padded with zeros: inverse mass, stiffness and static overlap (B, 8). `overlap`, `velocity` and
    `elastic` (B, 8) are the overlaps, the bodies' velocities and the elastic forces at the last step's start, and
    `signs` (B,) the signs of the overlaps.
    """

    inverse_mass: np.ndarray
    stiffness: np.ndarray
    preload: Any
    now: np.ndarray
    before: np.ndarray
    acc: np.ndarray
    first: np.ndarray
    second: np.ndarray
    overlap: np.ndarray
    velocity: np.ndarray
    elastic: np.ndarray
    signs: np.ndarray


@inline_numba
def steps_without_events(simd, trajectory, j, count, peaks):
    """Take up to `count` steps from step j of the period; return the number of steps taken."""
    slots, drive, y, _ = trajectory
    h, now, before, blocks = drive.h, simd.now, simd.before, simd.inverse_mass.shape[0]
    bodies = slots.chain.inverse_mass.size
    unpack(y, bodies, now, blocks)
    done, first, last = 0, False, False
    while True:
        i = 2 * (j + done)
        changed = first_stage(simd, slots, tabulated_displacement(slots, drive, i), h)
        v0 = tabulated_velocity(slots, drive, i)
        first_before, last_before = first, last
        first, last = comes_nearer(simd, slots, v0)
        if done > 0:
            # an overlap that approached zero and now moves away may have crossed it in between
            if changed or (first_before and not first) or (last_before and not last):
                pack(before, blocks, y, bodies)
                return done - 1
            update_long_chain_peaks(slots, simd, v0, peaks)
        if done == count:
            pack(now, blocks, y, bodies)
            return done
        middle, end = tabulated_displacement(slots, drive, i + 1), tabulated_displacement(slots, drive, i + 2)
        later_stage(simd, slots, middle, simd.first, simd.second, h, 0.5, 1.0 / 3.0)
        later_stage(simd, slots, middle, simd.second, simd.first, h, 1.0, 1.0 / 3.0)
        later_stage(simd, slots, end, simd.first, simd.second, h, 0.0, 1.0 / 6.0)
        for b in range(2 * blocks):
            store(before, b, load8(now, b))
            store(now, b, load8(simd.acc, b))
        done += 1


@inline_numba
def first_stage(simd, slots, u0, h):
    """Evaluate the slope at a step's start into acc and the mid-step state; return whether a contact has changed."""
    blocks, law, now = simd.inverse_mass.shape[0], slots.dissipation, simd.now
    here, e_before = with_first(load8(now, 0), u0), splat8(0.0)
    G_before, changed = primitive(law, e_before), np.int64(0)
    half, sixth = 0.5 * h, h / 6.0
    for b in range(blocks):
        ahead = load8(now, b + 1) if b + 1 < blocks else splat8(0.0)
        overlap = vector_overlap(simd.preload, here, from_right(here, ahead), b)
        signs = positive_mask(overlap)
        changed |= signs ^ simd.signs[b]
        simd.signs[b] = signs
        d = positive_part(overlap)
        e, G = elastic_force(load8(simd.stiffness, b), d), primitive(law, d)
        inverse = load8(simd.inverse_mass, b)
        du = long_chain_velocity(law, load8(now, blocks + b), inverse, G_before, G)
        dw = inverse * force_on_bead(slots, None, from_left(e_before, e) - e, here, du)
        store(simd.overlap, b, overlap)
        store(simd.velocity, b, du)
        store(simd.elastic, b, e)
        for row, slope in ((b, du), (blocks + b, dw)):
            start = load8(now, row)
            store(simd.first, row, start + half * slope)
            store(simd.acc, row, start + sixth * slope)
        here, e_before, G_before = ahead, e, G
    return changed != 0


@internal
def later_stage(simd, slots, u0, y, out, h, forward, weight):
    """Evaluate a later stage at state y: out = now + forward·h·slope, acc += weight·h·slope."""
    blocks, law, now = simd.inverse_mass.shape[0], slots.dissipation, simd.now
    here, e_before = with_first(load8(y, 0), u0), splat8(0.0)
    G_before = primitive(law, e_before)
    reach, share = forward * h, weight * h
    for b in range(blocks):
        ahead = load8(y, b + 1) if b + 1 < blocks else splat8(0.0)
        d = positive_part(vector_overlap(simd.preload, here, from_right(here, ahead), b))
        e, G = elastic_force(load8(simd.stiffness, b), d), primitive(law, d)
        inverse = load8(simd.inverse_mass, b)
        du = long_chain_velocity(law, load8(y, blocks + b), inverse, G_before, G)
        dw = inverse * force_on_bead(slots, None, from_left(e_before, e) - e, here, du)
        for row, slope in ((b, du), (blocks + b, dw)):
            store(out, row, load8(now, row) + reach * slope)
            store(simd.acc, row, load8(simd.acc, row) + share * slope)
        here, e_before, G_before = ahead, e, G


@by_slot
def long_chain_velocity(law, w, inverse_mass, before, G):
    """v = w + (G_{i-1} − G_i)/m for a block of bodies."""
    return w


@long_chain_velocity.of(*LAWS)
def _(law, w, inverse_mass, before, G):
    return w + inverse_mass * (from_left(before, G) - G)


@inline_numba
def comes_nearer(simd, slots, v0):
    """Whether the overlaps of the first and the last contact move towards zero at the last step's start.

    This is half of the test in `may_change` (step.py), for the two contacts whose touch within a step must not be
    missed.
    """
    last = slots.chain.stiffness.size - 1
    first_overlap, last_overlap = simd.overlap[0, 0], simd.overlap[last // BLOCK_WIDTH, last % BLOCK_WIDTH]
    first_rate, last_rate = v0 - simd.velocity[0, 1], simd.velocity[last // BLOCK_WIDTH, last % BLOCK_WIDTH]
    return (first_rate > 0.0) != (first_overlap > 0.0), (last_rate > 0.0) != (last_overlap > 0.0)


@internal
def update_long_chain_peaks(slots, simd, v0, peaks):
    """Update the peaks of input force, output force and its elastic part at the last step's start."""
    last = slots.chain.stiffness.size - 1
    block, lane = last // BLOCK_WIDTH, last % BLOCK_WIDTH
    damped = dashpot_force(slots.dissipation, simd.overlap[0, 0], v0 - simd.velocity[0, 1])
    update_peak(peaks, INPUT, simd.elastic[0, 0] + damped)
    elastic = simd.elastic[block, lane]
    damped = dashpot_force(slots.dissipation, simd.overlap[block, lane], simd.velocity[block, lane])
    update_peak(peaks, OUTPUT, elastic + damped)
    update_peak(peaks, OUTPUT_ELASTIC, elastic)


@inline_numba
def unpack(y, bodies, blocked, blocks):
    """Copy two rows of bodies into two rows of blocks."""
    for row in range(2):
        for i in range(bodies):
            blocked[row * blocks + i // BLOCK_WIDTH, i % BLOCK_WIDTH] = y[row * bodies + i]


@internal
def pack(blocked, blocks, y, bodies):
    """Copy two rows of blocks back into two rows of bodies."""
    for row in range(2):
        for i in range(bodies):
            y[row * bodies + i] = blocked[row * blocks + i // BLOCK_WIDTH, i % BLOCK_WIDTH]
