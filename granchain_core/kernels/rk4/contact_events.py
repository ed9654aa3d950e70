"""Contact events inside a step of fixed size: their times, and the quadrature error of a step next to one.

An overlap is a cubic in between, from its values and rates at the step's two ends. After a closing at s = 0 the
elastic force grows like s^{3/2}, whose integral Simpson's rule (and RK4 with it) misses by a part of h^{5/2}: that
part is known, because the speed is, and is subtracted. For laws with a > 0 the corresponding error of ∫G dt is
subtracted from the displacement.
"""

from __future__ import annotations

from math import copysign, sqrt

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_llvm, inline_numba, internal
from ..contact_cubic import contact_root
from ..effects.contact import three_halves
from ..effects.dissipation import JUMP_LAWS, SMOOTH_LAWS, exponent, primitive_factor, primitive_power
from ..step_ends import DISPLACEMENT_ERROR, MOMENTUM_ERROR, OVERLAP, OVERLAP_END, RATE, RATE_END, TINY

#: Most events located in one step. The rest of the step is taken whole, at order 2; that shows in the difference from a
#: computation with half the step, and so in the stated error.
MOST_SPLITS = 64


@internal
def first_event(ends, contacts, h):
    """(contact, fraction) of the first opening or closing in a step of size h; (−1, 2) if there is none."""
    contact, first = -1, 2.0
    for c in range(contacts):
        root = contact_root(ends[OVERLAP, c], h * ends[RATE, c], ends[OVERLAP_END, c], h * ends[RATE_END, c])
        if root < first:
            contact, first = c, root
    return contact, first


@by_slot
def nearer_event(law, ends, c, last, part, most, h):
    """A better fraction of a step of size h, below `most`, for the closing of contact c, after a trial step to `part`.

    It is one Newton step from the overlap and the rate that were reached there; `last` is the last contact. The cubic's
    end may lie beyond a kink of the velocity: its root is off by h², and so is the rate there. That matters
    where a force jumps with the rate and is recorded. Other contacts, openings and laws without a jump: `part`.
    """
    return part


@nearer_event.of(*JUMP_LAWS)
def _(law, ends, c, last, part, most, h):
    rate = ends[RATE, c]
    if rate > 0.0 and (c == 0 or c == last):
        nearer = part - ends[OVERLAP, c] / (h * rate)
        if 0.0 < nearer < most:
            return nearer
    return part


nearer_event.absent_for(*SMOOTH_LAWS)


@internal
def reset_corrections(ends):
    """Reset the accumulated quadrature errors."""
    for c in range(ends.shape[1]):
        ends[MOMENTUM_ERROR, c] = 0.0
        ends[DISPLACEMENT_ERROR, c] = 0.0


@inline_numba
def add_quadrature_errors(law, stiffness, ends, c, h, done):
    """Contact c changes at the part `done` of a step of size h, at the rate in `ends`.

    Simpson's rule fails over the part of the step on the contact's closed side and over the whole steps beyond it.
    """
    rate = ends[RATE, c]
    ends[OVERLAP, c] = copysign(TINY, rate)  # the cubic's remainder must not count as a second event
    speed, part = abs(rate), 1.0 - done if rate > 0.0 else done
    ends[MOMENTUM_ERROR, c] += stiffness * speed * sqrt(speed) * h * h * sqrt(h) * three_halves_excess(part)
    add_displacement_error(law, ends, c, speed, h, part)


@inline_llvm
def simpson_excess(r, p, half, one, inner, middle, far):
    """Excess of Simpson's rule over the integral of s^p, over a part r of a step from 0 and the two steps after it.

    `half` is 2^{−p}; `one`, `middle` and `far` are s^p at r, r + 1 and r + 2, `inner` its sum at r + 1/2 and r + 3/2.
    """
    part = r * (one + 4.0 * half * one)
    full_steps = one + 4.0 * inner + 2.0 * middle + far
    return (part + full_steps) / 6.0 - 1.0 / (p + 1.0) * (r + 2.0) * far


@internal
def three_halves_excess(r):
    """`simpson_excess` of s^{3/2}."""
    inner = three_halves(r + 0.5) + three_halves(r + 1.5)
    return simpson_excess(r, 1.5, three_halves(0.5), three_halves(r), inner, three_halves(r + 1.0),
                          three_halves(r + 2.0))


@inline_llvm
def primitive_excess(law, r):
    """`simpson_excess` of s^{1+a}."""
    inner = primitive_power(law, r + 0.5) + primitive_power(law, r + 1.5)
    return simpson_excess(r, 1.0 + exponent(law), primitive_power(law, 0.5), primitive_power(law, r), inner,
                          primitive_power(law, r + 1.0), primitive_power(law, r + 2.0))


@by_slot
def add_displacement_error(law, ends, c, speed, h, part):
    """Add the error of Simpson's rule for ∫G dt. Absent, and where G is linear: nothing."""


add_displacement_error.absent_for(*JUMP_LAWS)


@add_displacement_error.of(*SMOOTH_LAWS)
def _(law, ends, c, speed, h, part):
    scale = primitive_factor(law) * law.coefficient * primitive_power(law, speed) * h * primitive_power(law, h)
    ends[DISPLACEMENT_ERROR, c] += scale * primitive_excess(law, part)
