"""Numbers as text for a person: SI prefixes, errors to one significant figure, durations to three."""

from __future__ import annotations

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"),
             (1e-12, "p"), (1e-15, "f"), (1e-18, "a"))


def prefixed(largest: float) -> tuple[float, str]:
    """The factor and letter of the SI prefix in which `largest` reads between 1 and 1000, rounded to three figures."""
    for factor, letter in _PREFIXES:
        if largest >= 0.9995 * factor:  # 999.6 would read "1e+03"; the same in parts/plot.js
            return factor, letter
    return 1.0, ""


def short_error(error: float) -> str:
    """An error or accuracy to one figure, "3e-7"."""
    mantissa, exponent = f"{error:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def duration(seconds: float) -> str:
    """Seconds to three figures, in milliseconds, microseconds … where that reads better; whole ones from 1000 on."""
    if seconds >= 999.5:
        return f"{seconds:.0f} s"
    factor, letter = prefixed(min(seconds, 1.0))
    return f"{seconds / factor:.3g} {letter}s"


def in_words(value: float, unit: str, figures: int = 4) -> str:
    """A value in SI with its prefix, "597.2 mN"."""
    factor, letter = prefixed(abs(value))
    return f"{value / factor:.{figures}g} {letter}{unit}"


def signed_in_words(value: float, unit: str, figures: int = 3) -> str:
    """A difference in SI with its sign and prefix, "+500 mN"."""
    return f"{'−' if value < 0.0 else '+'}{in_words(abs(value), unit, figures)}"
