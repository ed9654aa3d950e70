"""Contacts that open or close within a step of a batch: the step is not split, its error is subtracted.

A contact is closed for a part r of the step, at its beginning or at its end, and its overlap grows or falls as v s.
Simpson's rule integrates its force and its damping through the kink; the quadrature errors are

    impulse  K v^{3/2} h^{5/2} (B_{3/2}(r) + E(r)),   displacement  c v^p h^{p+1} B_p(r)   for G = c δ^p, p = 1 + a
    B_p(r) = (r^p + 4 [r − 1/2]_+^p)/6 − r^{p+1}/(p+1)
    E: Simpson's error of s^{3/2} over the whole step on the closed side

and subtracting them raises the order of RK4 in a batch from 2 to about 3 (docs/model.md).
"""

from __future__ import annotations

from ..effects.contact import three_halves
from ..effects.dissipation import LAWS, exponent, primitive_factor, primitive_power
from ..effects.preload import batch_overlap
from ..jit import by_slot, inline_llvm
from ..simd.functions import clip, gate, larger
from ..simd.vector import blank, load_batch, positive_mask, store
from .unequal import over_mass, times_stiffness


@inline_llvm
def momentum_error(r, power, half_power):
    """B_{3/2}(r) + E(r) from r, r^{3/2} and [r − 1/2]_+^{3/2}."""
    inside = (power + 4.0 * half_power) * (1.0 / 6.0) - 0.4 * r * power
    one = r + 1.0
    far = three_halves(one)
    closed = (power + 4.0 * three_halves(r + 0.5) + far) * (1.0 / 6.0) - 0.4 * (one * far - r * power)
    return inside + closed


@by_slot
def displacement_error(law, r, half, speed, h):
    """c v^p h^{p+1} B_p(r) in all members; `half` is [r − 1/2]_+. Absent: nothing."""
    return None


@displacement_error.of(*LAWS)
def _(law, r, half, speed, h):
    here = primitive_power(law, r)
    inside = (here + 4.0 * primitive_power(law, half)) * (1.0 / 6.0) - 1.0 / (2.0 + exponent(law)) * r * here
    return primitive_factor(law) * law.coefficient * h * primitive_power(law, speed * h) * inside


@by_slot
def correct_displacement(law, values, y, c, changed, shift):
    """Subtract the displacement error from both sides of contact c. Absent: there is none."""


@correct_displacement.of(*LAWS)
def _(law, values, y, c, changed, shift):
    correct_state(values, y, c, 0, gate(changed, shift))


@inline_llvm
def correct_state(values, y, c, row, excess):
    """Correct the two beads of contact c by the error `excess`, in the row of y that begins at `row`."""
    if c > 0:
        store(y, row + c, load_batch(y, row + c) + over_mass(values.unequal, c, excess))
    if c < values.last:
        store(y, row + c + 1, load_batch(y, row + c + 1) - over_mass(values.unequal, c + 1, excess))


@inline_llvm
def correct_contacts(values, y, overlaps, h, u0):
    """Correct the last step at contacts that changed in it; `overlaps` are the overlaps before it."""
    m = values.last + 2
    left = u0
    for c in range(values.last + 1):
        right = load_batch(y, c + 1)
        overlap = batch_overlap(values.preload, left, right, c)
        before = load_batch(overlaps, c)
        store(overlaps, c, overlap)
        changed = blank(overlap) - before * overlap
        if positive_mask(changed) != 0:
            rise = overlap - before
            speed = larger(rise, blank(overlap) - rise) / h
            r = larger(overlap, before) / (speed * h)
            half = clip(r - 0.5)
            power, half_power = three_halves(r), three_halves(half)
            impulse = h * three_halves(speed * h) * momentum_error(r, power, half_power)
            impulse = times_stiffness(values.unequal, values.wall, c, values.last, impulse)
            shift = displacement_error(values.law, r, half, speed, h)
            correct_state(values, y, c, m, gate(changed, impulse))
            correct_displacement(values.law, values, y, c, changed, shift)
            right = load_batch(y, c + 1)
        left = right
