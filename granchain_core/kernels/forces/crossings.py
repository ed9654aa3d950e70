"""Closings of contacts for methods that do not locate events: jumps of the force between two states one step apart.

Without the contact's own damping, the rate of an overlap is smooth across a closing, and a parabola through it gives
the rate at the instant when the overlap is zero. A touch within a step shows as a maximum of the overlap between two
negative values.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_llvm, internal
from ..effects.dissipation import JUMP_LAWS, SMOOTH_LAWS
from ..effects.preload import overlap
from ..simd.functions import positive_part, root
from .largest import UNRESOLVED, record_closing


class Approach(NamedTuple):
    """Overlap of a contact and its rate, numbers or vectors."""

    overlap: Any
    rate: Any


@inline_llvm
def between_0_and_1(s):
    """The nearest number in [0, 1]; a NaN stays a NaN. For numbers and vectors up to 2^53; above, rounding gives 0."""
    least = positive_part(s)
    return least - positive_part(least - 1.0)


@inline_llvm
def closing_rate(before, after, rate, open_rate, own_damping, h):
    """Return (fraction, δ̇) where an overlap is zero that changes from `before` ≤ 0 to `after` > 0 in a step of size h.

    `rate` is δ̇ before the step. `open_rate` is δ̇ after it with the contact's own damping removed: δ̇ + own_damping·δ
    with own_damping = λ(1/m_c + 1/m_{c+1}). Without that damping, the rate is smooth across the closing and is
    approximated by a parabola whose integral is the overlap's change. Newton's method finds the crossing. It is
    confined to the step, because it would leave it where the rate at the crossing is almost zero, and the parabola is
    meaningless outside. For numbers and vectors.
    """
    s = before / (before - after)
    closed = 0.5 * (1.0 - s) * after
    for _ in range(2):
        bend = 6.0 * ((after + own_damping * h * closed - before) / h - 0.5 * (rate + open_rate))
        for _ in range(2):
            delta = before + h * s * (rate + s * (0.5 * (open_rate - rate + bend) - s * (bend * (1.0 / 3.0))))
            s = between_0_and_1(s - delta / (h * (rate + s * (open_rate - rate + bend - s * bend))))
        rate_there = rate + s * (open_rate - rate + bend - s * bend)
        left = 1.0 - s
        # ∫δ over the closed part, divided by h: the trapezoidal rule corrected by the slopes at both ends
        closed = left * (0.5 * after - left * h * (open_rate - own_damping * after - rate_there) * (1.0 / 12.0))
    return s, rate_there


@inline_llvm
def brief_touch(before, after, rate, rate_after, h):
    """Rate at which a contact closes for a touch within a step: √(2 a δ_max) if the overlap accelerates at −a.

    The overlap is negative at both ends of the step and turns in between. The result is 0 or a NaN if there is no
    touch. For numbers and vectors.
    """
    fall = (rate - rate_after) / h
    top = 0.5 * (before + after) + 0.25 * (rate * rate + rate_after * rate_after) / fall
    return root(positive_part(2.0 * fall * top))


@internal
def approach_of(slots, instant, c):
    """Overlap and rate of contact c."""
    return Approach(overlap(slots.preload, instant.y, c), instant.dy[c] - instant.dy[c + 1])


@by_slot
def end_approaches(law, slots, instant):
    """`Approach` of the first and last contact at the start of a step. Effect absent: 0, since no force jumps."""
    return 0.0


@end_approaches.of(*JUMP_LAWS)
def _(law, slots, instant):
    return approach_of(slots, instant, 0), approach_of(slots, instant, slots.chain.stiffness.size - 1)


@by_slot
def record_crossings(law, slots, before, end, span, log):
    """Record which end contacts closed between two instants one step apart; `before` are their `end_approaches`."""


@record_crossings.of(*JUMP_LAWS)
def _(law, slots, before, end, span, log):
    first, last = before
    if first.overlap <= 0.0:
        record_crossing(law, slots, 0, first, end, span, log)
    if last.overlap <= 0.0:
        record_crossing(law, slots, slots.chain.stiffness.size - 1, last, end, span, log)


@inline_llvm
def record_crossing(law, slots, c, before, end, span, log):
    """Record contact c, which was open at the start of the step, if it closed in it or touched."""
    after, h, last = approach_of(slots, end, c), span.h, slots.chain.stiffness.size - 1
    if after.overlap > 0.0:
        own_damping = law.coefficient * (slots.chain.inverse_mass[c] + slots.chain.inverse_mass[c + 1])
        undamped = after.rate + own_damping * after.overlap
        s, jump = closing_rate(before.overlap, after.overlap, before.rate, undamped, own_damping, h)
        record_closing(law, jump, c, last, span.theta + s * span.dtheta, log)
    elif before.rate > 0.0 and after.rate < 0.0:
        jump = brief_touch(before.overlap, after.overlap, before.rate, after.rate, h)
        record_closing(law, jump, c, last, span.theta + 0.5 * span.dtheta, log)
        log.counts[UNRESOLVED] += jump > 0.0


end_approaches.absent_for(*SMOOTH_LAWS)
record_crossings.absent_for(*SMOOTH_LAWS)
