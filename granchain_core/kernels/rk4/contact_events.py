"""Contact events inside a fixed step: their times, and the quadrature error of a step next to an event.

Within a step, an overlap is the cubic through its values and rates at both ends. After a closing at s = 0, the elastic
force grows as s^{3/2}, which Simpson's rule, and therefore RK4, integrates with an error proportional to h^{5/2}. Since
the speed is known, so is this error, and it is subtracted. For laws with a > 0, the corresponding error of ∫G dt is
subtracted from the displacement.
"""

from __future__ import annotations

from math import copysign, sqrt

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_llvm, inline_numba, internal
from ..contact_cubic import contact_root
from ..effects.contact import TINY, three_halves
from ..effects.dissipation import JUMP_LAWS, SMOOTH_LAWS, exponent, primitive_factor, primitive_power
from ..step_ends import DISPLACEMENT_ERROR, MOMENTUM_ERROR, OVERLAP, OVERLAP_END, RATE, RATE_END

#: Most events located in one step. The rest of the step is taken whole, at order 2. This shows in the difference from a
#: computation with half the step, and therefore in the stated error.
MOST_SPLITS = 64


@internal
def first_event(ends, contacts, h):
    """Return (contact, fraction) of the first opening or closing in a step of size h; (−1, 2) if there is none."""
    contact, first = -1, 2.0
    for c in range(contacts):
        root = contact_root(ends[OVERLAP, c], h * ends[RATE, c], ends[OVERLAP_END, c], h * ends[RATE_END, c])
        if root < first:
            contact, first = c, root
    return contact, first


@by_slot
def nearer_event(law, ends, c, last, part, most, h):
    """Improve the fraction of a step of size h at which contact c closes, after a trial step to fraction `part`.

    This is one Newton step from the overlap and the rate at `part`; the result is below `most`, and `last` is the last
    contact. The end of the cubic may lie beyond a kink of the velocity: its root, and the rate there, are then off by a
    term of order h². This matters where a recorded force jumps with the rate. For other contacts, openings and laws
    without a jump, `part` is returned.
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
    """Add the errors of contact c, which changes at fraction `done` of a step of size h, at its rate in `ends`.

    Simpson's rule is inexact over the part of the step on which the contact is closed, and over the whole steps beyond
    it.
    """
    rate = ends[RATE, c]
    ends[OVERLAP, c] = copysign(TINY, rate)  # so that the cubic's remainder does not count as a second event
    speed, part = abs(rate), 1.0 - done if rate > 0.0 else done
    ends[MOMENTUM_ERROR, c] += stiffness * speed * sqrt(speed) * h * h * sqrt(h) * three_halves_excess(part)
    add_displacement_error(law, ends, c, speed, h, part)


@inline_llvm
def simpson_excess(r, p, half, one, inner, middle, far):
    """Excess of Simpson's rule over the integral of s^p, over a fraction r of a step from 0 and the next two steps.

    `half` is 2^{−p}; `one`, `middle` and `far` are s^p at r, r + 1 and r + 2; `inner` is the sum of s^p at
    r + 1/2 and r + 3/2.
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
    """Add the error of Simpson's rule for ∫G dt. Effect absent, or G linear: nothing."""


add_displacement_error.absent_for(*JUMP_LAWS)


@add_displacement_error.of(*SMOOTH_LAWS)
def _(law, ends, c, speed, h, part):
    scale = primitive_factor(law) * law.coefficient * primitive_power(law, speed) * h * primitive_power(law, h)
    ends[DISPLACEMENT_ERROR, c] += scale * primitive_excess(law, part)
