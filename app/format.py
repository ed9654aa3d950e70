"""Numbers as text for a person: SI prefixes, errors to one significant figure, durations to three."""

from __future__ import annotations

import math

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"),
             (1e-12, "p"), (1e-15, "f"), (1e-18, "a"))


def prefixed(largest: float) -> tuple[float, str]:
    """Return factor and letter of the SI prefix that puts `largest` between 1 and 1000, rounded to three figures."""
    for factor, letter in _PREFIXES:
        if largest >= 0.9995 * factor:  # 999.6 would read "1e+03"; the same in parts/toolkit/round_numbers.js
            return factor, letter
    return 1.0, ""


def short_error(error: float) -> str:
    """Return an error or accuracy to one figure, "3e-7"."""
    mantissa, exponent = f"{error:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def duration(seconds: float) -> str:
    """Return a time to three figures, with an SI prefix below 1 s; in whole seconds from 1000 s on."""
    if seconds >= 999.5:
        return f"{seconds:.0f} s"
    factor, letter = prefixed(min(seconds, 1.0))
    return f"{seconds / factor:.3g} {letter}s"


#: The range of numbers that are written without a power of ten.
_SMALLEST_PLAIN, _LARGEST_PLAIN = 1e-6, 1e9


def with_figures(value: float, figures: int) -> str:
    """Return a number to `figures` significant figures, trailing zeros included: "5.040", "150".

    Very large and very small numbers are written with a power of ten.
    """
    if not math.isfinite(value):
        return f"{value}"
    if value and not _SMALLEST_PLAIN <= abs(value) < _LARGEST_PLAIN:
        mantissa, exponent = f"{value:.{figures - 1}e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    rounded = float(f"{value:.{figures - 1}e}")
    return with_decimals(rounded, figures - 1 - math.floor(math.log10(abs(rounded))) if rounded else 0)


def with_decimals(value: float, decimals: int) -> str:
    """Return a number rounded to `decimals` places (left of the point if negative), with a true minus sign."""
    return f"{round(value, decimals) + 0.0:.{max(0, decimals)}f}".replace("-", "\N{MINUS SIGN}")


#: Figures of a number whose error is not known.
UNSURE_FIGURES = 2


def figures_of(relative_error: float | None, most: int = 4) -> int:
    """Return how many figures a relative error leaves: at least two, at most `most`; two if the error is unknown."""
    if relative_error is None or not math.isfinite(relative_error):
        return UNSURE_FIGURES
    if relative_error <= 10.0 ** -most:
        return most
    return max(UNSURE_FIGURES, math.ceil(-math.log10(relative_error)))


def in_words(value: float, unit: str, figures: int = 4) -> str:
    """Return a value in SI with its prefix, "597.2 mN"."""
    factor, letter = prefixed(abs(value))
    return f"{with_figures(value / factor, figures)} {letter}{unit}"


def given_in_words(value: float, unit: str, figures: int = 4) -> str:
    """Return the same for a measured number, without zeros that nobody wrote: "5.5 N"."""
    factor, letter = prefixed(abs(value))
    return f"{value / factor:.{figures}g} {letter}{unit}"


def signed_in_words(value: float, unit: str, figures: int = 3) -> str:
    """Return a difference in SI with its sign and prefix, "+500 mN"."""
    return f"{'−' if value < 0.0 else '+'}{in_words(abs(value), unit, figures)}"
