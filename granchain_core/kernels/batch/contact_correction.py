"""Contacts that open or close within a step of a batch: the step is not split; its error is subtracted instead.

The contact is closed for a fraction r of the step, at its start or end, and its overlap changes at the speed v there.
Simpson's rule integrates force and damping across the kink. Its errors are

    impulse  K v^{3/2} h^{5/2} (B_{3/2}(r) + E(r)),   displacement  c v^p h^{p+1} B_p(r)   for G = c δ^p, p = 1 + a
    B_p(r) = (r^p + 4 [r − 1/2]_+^p)/6 − r^{p+1}/(p+1), over the step with the kink
    E(r): the same for s^{3/2} over the next step on the closed side, from s = r to r + 1

and subtracting them raises the order of RK4 in a batch from 2 to about 3 (docs/method.md).
"""

from __future__ import annotations

from ..compiling.dispatch import by_slot
from ..compiling.jit import inline_llvm
from ..effects.dissipation import LAWS, exponent, primitive_factor, primitive_power
from ..effects.preload import vector_overlap
from ..simd.functions import at_least_tiny, gate, larger, positive_part, root_by_series
from ..simd.vector import load_batch, positive_mask, store
from .unequal import over_mass, times_stiffness


@inline_llvm
def next_step_error(r):
    """The next step's part of B_{3/2}(r) + E(r), to 3e-8.

    This is (4 (r + 1/2)^{3/2} + (r + 1)^{3/2})/6 − (2/5)(r + 1)^{5/2} for 0 ≤ r ≤ 1. A polynomial through nine points
    saves two roots.
    """
    high = ((0.00291261 * r - 0.01588264) * r + 0.04025222) * r - 0.06753252
    middle = ((high * r + 0.10018871) * r - 0.25194466) * r - 0.33406599
    return (middle * r - 0.04288892) * r + 0.0023689


@inline_llvm
def impulse_error(r, r_power, mid_power):
    """B_{3/2}(r) + E(r) from r, r^{3/2} and [r − 1/2]_+^{3/2}; the two integrals of s^{3/2} up to r cancel."""
    return (r_power + 2.0 * mid_power) * (1.0 / 3.0) + next_step_error(r)


@inline_llvm
def three_halves_by_series(s):
    """s^{3/2} for s ≥ 0 in all members."""
    return s * root_by_series(at_least_tiny(s))


@by_slot
def displacement_error(law, r, r_mid, moved, h):
    """c (vh)^p h B_p(r) in all members, with vh = `moved`; `r_mid` is [r − 1/2]_+. Effect absent: 0."""
    return None


@displacement_error.of(*LAWS)
def _(law, r, r_mid, moved, h):
    r_power = primitive_power(law, r)
    with_kink = (r_power + 4.0 * primitive_power(law, r_mid)) * (1.0 / 6.0) - 1.0 / (2.0 + exponent(law)) * r * r_power
    return primitive_factor(law) * law.coefficient * h * primitive_power(law, moved) * with_kink


@by_slot
def correct_displacement(law, values, y, c, changed, shift):
    """Correct the displacements on both sides of contact c. Effect absent: nothing, since they have no such error."""


@correct_displacement.of(*LAWS)
def _(law, values, y, c, changed, shift):
    correct_two_beads(values, y, c, 0, gate(changed, shift))


@inline_llvm
def correct_two_beads(values, y, c, row, error):
    """Correct the two beads of contact c by a quadrature error, in the row of y that begins at `row`."""
    if c > 0:
        store(y, row + c, load_batch(y, row + c) + over_mass(values.unequal, c, error))
    if c < values.last:
        store(y, row + c + 1, load_batch(y, row + c + 1) - over_mass(values.unequal, c + 1, error))


@inline_llvm
def correct_contacts(values, y, overlaps, h, u0):
    """Correct a step at the contacts that changed in it; update `overlaps`, which are those before the step."""
    law, bodies = values.slots.dissipation, values.last + 2
    left = u0
    for c in range(values.last + 1):
        right = load_batch(y, c + 1)
        overlap = vector_overlap(values.slots.preload, left, right, c)
        before = load_batch(overlaps, c)
        store(overlaps, c, overlap)
        changed = -before * overlap
        if positive_mask(changed) != 0:
            moved = abs(overlap - before)
            r = larger(overlap, before) / moved
            r_mid = positive_part(r - 0.5)
            error = impulse_error(r, three_halves_by_series(r), three_halves_by_series(r_mid))
            impulse = h * three_halves_by_series(moved) * error
            impulse = times_stiffness(values.unequal, values.wall, c, c == values.last, impulse)
            shift = displacement_error(law, r, r_mid, moved, h)
            correct_two_beads(values, y, c, bodies, gate(changed, impulse))
            correct_displacement(law, values, y, c, changed, shift)
            right = load_batch(y, c + 1)
        left = right
