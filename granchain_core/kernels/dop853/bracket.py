"""A bracketed sign change, narrowed step by step: regula falsi that halves the end that stays (Illinois)."""

from __future__ import annotations

from ..jit import kernel


@kernel
def between(low, high, f_low, f_high):
    """Where the straight line through both ends is zero; the middle where rounding has it outside."""
    x = (low * f_high - high * f_low) / (f_high - f_low)
    return x if low <= x <= high else 0.5 * (low + high)


@kernel
def narrowed(low, high, f_low, f_high, side, x, f):
    """(low, high, f_low, f_high, side) once x has the value f; `side` is the end that moved, −1 or 1."""
    if (f > 0.0) == (f_low > 0.0):
        return x, high, f, 0.5 * f_high if side < 0 else f_high, -1
    return low, x, 0.5 * f_low if side > 0 else f_low, f, 1
