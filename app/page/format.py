"""Numbers as the page says them: one figure of an error, three of a duration."""

from __future__ import annotations


def short_error(error: float) -> str:
    """An error or accuracy to one figure, "3e-7"."""
    mantissa, exponent = f"{error:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def duration(seconds: float) -> str:
    """Seconds to three figures, in milliseconds or microseconds where that reads better."""
    if seconds >= 1.0:
        return f"{seconds:.3g} s"
    return f"{1e3 * seconds:.3g} ms" if seconds >= 1e-3 else f"{1e6 * seconds:.3g} µs"
