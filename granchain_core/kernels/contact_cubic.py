"""An overlap within a step as a cubic through its values and rates at both ends: turning point and root."""

from __future__ import annotations

from math import sqrt

from .compiling.jit import inline_llvm, inline_numba, internal


@inline_llvm
def turns(closed, rising, rising_after):
    """True where an overlap moves towards zero at a step's start and away from it at the end: it may cross zero twice.

    `closed`, `rising` and `rising_after` are bits, one per contact, or 0 and 1 for a single contact: whether δ > 0 at
    both ends, whether δ̇ > 0 at the start, and whether δ̇ > 0 at the end.
    """
    return (rising ^ closed) & ~(rising_after ^ closed)


@inline_llvm
def hermite_value(d0, s0, d1, s1, x):
    """Value at x of the cubic with values d0, d1 and slopes s0, s1 at 0 and 1."""
    return d0 + x * (s0 + x * (3.0 * (d1 - d0) - 2.0 * s0 - s1 + x * (2.0 * (d0 - d1) + s0 + s1)))


@internal
def hermite_root(d0, s0, d1, s1, high):
    """Root in [0, high] of the cubic with values d0, d1 and slopes s0, s1 at 0 and 1; its sign changes there.

    Newton's method within a bracket, which is halved where a step would leave it. 40 iterations are enough: halvings
    alone would find the root to 1e-12, far below the error of the cubic itself.
    """
    low = 0.0
    a = 2.0 * (d0 - d1) + s0 + s1
    b = 3.0 * (d1 - d0) - 2.0 * s0 - s1
    x = d0 / (d0 - d1) if high == 1.0 else 0.5 * high
    for _ in range(40):
        value = d0 + x * (s0 + x * (b + x * a))
        if (value > 0.0) == (d0 > 0.0):
            low = x
        else:
            high = x
        slope = s0 + x * (2.0 * b + 3.0 * a * x)
        nearer = x - value / slope if slope != 0.0 else low
        if not (low < nearer < high):
            nearer = 0.5 * (low + high)
        if abs(nearer - x) < 1e-12:
            return nearer
        x = nearer
    return x


@internal
def hermite_turn(d0, s0, d1, s1):
    """Where the same cubic turns between ends at which its slopes have opposite signs."""
    a = 2.0 * (d0 - d1) + s0 + s1
    b = 3.0 * (d1 - d0) - 2.0 * s0 - s1
    # The root of s0 + 2b x + 3a x² = 0 between 0 and 1: the one farther from 0 where s0 and b have the same sign,
    # otherwise the nearer one. Both add |b| and the root of the discriminant, so that nothing cancels.
    q = abs(b) + sqrt(max(0.0, b * b - 3.0 * a * s0))
    return q / abs(3.0 * a) if (s0 > 0.0) == (b > 0.0) else abs(s0) / q


@inline_numba
def contact_root(d0, s0, d1, s1):
    """Fraction of a step at which a contact opens or closes; 2 if it does not.

    Where the overlap has the same sign at both ends, the test of `turns` comes first.
    """
    if d0 == 0.0:  # touching beads: the contact closes here if they are pushed together, and does not if they part
        if s0 > 0.0 and d1 > 0.0:
            return 0.0
        return 2.0
    if (d0 > 0.0) != (d1 > 0.0):
        return hermite_root(d0, s0, d1, s1, 1.0)
    away = s0 if d0 > 0.0 else -s0
    back = s1 if d0 > 0.0 else -s1
    if away >= 0.0 or back <= 0.0:
        return 2.0
    x = hermite_turn(d0, s0, d1, s1)
    if not 0.0 < x < 1.0:
        return 2.0
    if (hermite_value(d0, s0, d1, s1, x) > 0.0) == (d0 > 0.0):
        return 2.0
    return hermite_root(d0, s0, d1, s1, x)
