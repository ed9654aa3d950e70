"""One Runge–Kutta step of several chains, one in each SIMD lane, in a single sweep along them."""

from __future__ import annotations

from typing import Any, NamedTuple

from ..effects.dissipation import JUMP_LAWS, LAWS, SMOOTH_LAWS, dashpot_force, shape
from ..effects.foundation import add_foundation_force
from ..effects.preload import batch_overlap
from ..forces.crossings import Approach, brief_touch, closing_rate
from ..forces.peaks import INPUT, INPUT_JUMP, OUTPUT, OUTPUT_ELASTIC, OUTPUT_JUMP, watch_batch
from ..jit import by_slot, inline_llvm
from ..simd.functions import above_zero, clip, gate, larger, root, root_by_series
from ..simd.vector import blank, load_batch, positive_mask, store
from .unequal import over_mass, times_stiffness


class Values(NamedTuple):
    """Values of the members' scenes; those that are one number for each scene are in registers."""

    wall: Any
    law: Any
    foundation: Any
    preload: Any
    unequal: Any
    last: Any


class Bead(NamedTuple):
    """One bead of one Runge–Kutta stage in all members: state, elastic force and shape of the contact on its left."""

    u: Any
    w: Any
    e: Any
    G: Any


@inline_llvm
def by_divider(d):
    """√d by the square-root instruction."""
    return root(d)


@inline_llvm
def by_multipliers(d):
    """√d, d > 0, by multiplications (simd/functions.py)."""
    return root_by_series(d)


@inline_llvm
def contact(values, root_of, left, right, c):
    """Elastic force and shape of G of contact c; `root_of` computes the root."""
    d = above_zero(batch_overlap(values.preload, left, right, c))
    r = root_of(d)
    return times_stiffness(values.unequal, values.wall, c, values.last, d * r), shape(values.law, d, r)


@inline_llvm
def first_bead(values, root_of, u0, u, w):
    """Bead 1 of a stage with the driver at u0."""
    e, G = contact(values, root_of, u0, u, 0)
    return Bead(u, w, e, G)


@inline_llvm
def bead_slope(values, root_of, bead, i, right, right_w):
    """Slope of bead i, which is `bead`, between its neighbours; and the next bead with the contact between them."""
    e, G = contact(values, root_of, bead.u, right, i)
    du = batch_velocity(values.law, values.unequal, i, bead.w, bead.G - G)
    dw = over_mass(values.unequal, i, add_foundation_force(values.foundation, bead.e - e, bead.u))
    return du, dw, Bead(right, right_w, e, G)


@by_slot
def batch_velocity(law, unequal, i, w, difference):
    """v = w + (G_{i-1} − G_i)/m of bead i in all members, from the difference of shapes."""
    return w


@batch_velocity.of(*LAWS)
def _(law, unequal, i, w, difference):
    return w + over_mass(unequal, i, law.coefficient * difference)


class Ends(NamedTuple):
    """The chain's two ends at the start of a step: elastic forces and the beads' velocities."""

    pushed: Any
    v_first: Any
    passed: Any
    v_last: Any


@inline_llvm
def batch_step(values, y, h, u0, middle, end):
    """One RK4 step in place, the driver at u0, at `middle` and at `end`; returns the `Ends` where it began.

    The four stages run along the chain one bead behind another, so that a step goes through memory once. The stages'
    states y1, y2, y3 are enough for the result: y + h (k1 + 2k2 + 2k3 + k4)/6 = (y1 + 2y2 + y3 − y)/3 + h k4/6.
    """
    m, n = values.last + 2, values.last
    half, sixth, third = 0.5 * h, (1.0 / 6.0) * h, 1.0 / 3.0
    zero = blank(h)
    nothing = Bead(zero, zero, zero, shape(values.law, zero, zero))
    two, three, four = nothing, nothing, nothing
    one = first_bead(values, by_multipliers, u0, load_batch(y, 1), load_batch(y, m + 1))
    pushed, v_first, v_last = one.e, zero, zero
    sum_u, sum_w, whole_u, whole_w = zero, zero, zero, zero
    for i in range(1, n + 4):
        u1, w1, u2, w2, u3, w3 = zero, zero, zero, zero, zero, zero
        if i <= n:
            u, w = one.u, one.w
            v_last, dw, one = bead_slope(values, by_multipliers, one, i, load_batch(y, i + 1), load_batch(y, m + i + 1))
            u1, w1 = u + half * v_last, w + half * dw
        if i == 1:
            v_first = v_last
            two = first_bead(values, by_divider, middle, u1, w1)
            continue
        if i <= n + 1:
            before = two
            du, dw, two = bead_slope(values, by_divider, two, i - 1, u1, w1)
            u2, w2 = load_batch(y, i - 1) + half * du, load_batch(y, m + i - 1) + half * dw
            new_u, new_w = before.u + 2.0 * u2, before.w + 2.0 * w2
        else:
            new_u, new_w = zero, zero
        if i == 2:
            three = first_bead(values, by_multipliers, middle, u2, w2)
            sum_u, sum_w = new_u, new_w
            continue
        if i <= n + 2:
            du, dw, three = bead_slope(values, by_multipliers, three, i - 2, u2, w2)
            u, w = load_batch(y, i - 2), load_batch(y, m + i - 2)
            u3, w3 = u + h * du, w + h * dw
            newer_u, newer_w = sum_u + (u3 - u), sum_w + (w3 - w)
        else:
            newer_u, newer_w = zero, zero
        sum_u, sum_w = new_u, new_w
        if i == 3:
            four = first_bead(values, by_divider, end, u3, w3)
            whole_u, whole_w = newer_u, newer_w
            continue
        du, dw, four = bead_slope(values, by_divider, four, i - 3, u3, w3)
        store(y, i - 3, third * whole_u + sixth * du)
        store(y, m + i - 3, third * whole_w + sixth * dw)
        whole_u, whole_w = newer_u, newer_w
    return Ends(pushed, v_first, one.e, v_last)


@inline_llvm
def watch_batch_ends(values, h, first_overlap, last_overlap, v0, ends, before, peaks):
    """Follow input force, output force and its elastic part in all members, where a step began."""
    first, last = Approach(first_overlap, v0 - ends.v_first), Approach(last_overlap, ends.v_last)
    watch_batch(peaks, INPUT, ends.pushed + dashpot_force(values.law, first.overlap, first.rate))
    watch_batch(peaks, OUTPUT, ends.passed + dashpot_force(values.law, last.overlap, last.rate))
    watch_batch(peaks, OUTPUT_ELASTIC, ends.passed)
    watch_jumps(values.law, values, h, first, last, before, peaks)


@by_slot
def watch_jumps(law, values, h, first, last, before, peaks):
    """Follow the jumps of both end contacts over the last step. Absent, and where g(0) = 0: forces have none."""


@watch_jumps.of(*JUMP_LAWS)
def _(law, values, h, first, last, before, peaks):
    watch_jump(law, over_mass(values.unequal, 1, law.coefficient), h, first, before, 0, peaks, INPUT_JUMP)
    watch_jump(law, over_mass(values.unequal, values.last, law.coefficient), h, last, before, 2, peaks, OUTPUT_JUMP)


watch_jumps.absent_for(*SMOOTH_LAWS)


@inline_llvm
def watch_jump(law, own, h, approach, before, row, peaks, peak):
    """Follow the jump of one contact; overlap and rate a step ago are rows of `before`, and become those of now."""
    overlap, rate = approach
    overlap_before, rate_before = load_batch(before, row), load_batch(before, row + 1)
    store(before, row, overlap)
    store(before, row + 1, rate)
    zero, was, now = blank(overlap), positive_mask(overlap_before), positive_mask(overlap)
    if now & ~was != 0:
        _, closing = closing_rate(overlap_before, overlap, rate_before, rate + own * clip(overlap), own, h)
        closed = gate(zero - overlap_before, gate(overlap, law.coefficient * closing))
        store(peaks, peak, larger(load_batch(peaks, peak), closed))
    if ~now & ~was & positive_mask(rate_before) & positive_mask(zero - rate) != 0:
        touched = law.coefficient * brief_touch(overlap_before, overlap, rate_before, rate, h)
        open_still = gate(zero - overlap_before, gate(zero - overlap, gate(rate_before, gate(zero - rate, touched))))
        store(peaks, peak, larger(load_batch(peaks, peak), open_still))
