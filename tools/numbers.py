"""Numbers from the code in sentences of the docs, written by `python -m tools.update`.

A mark after a number gives its constant with the last part of the module's name:
`400<!--regime_decisions.EXAMINED_AFTER-->`. A unit after a colon says how the number is written:
`30<!--steps.LARGEST_CORRECTION:%-->`. A number that follows from several constants is one of `DERIVED`.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import SimpleNamespace

from granchain_core.hard_cases import CASES
from granchain_core.orbits.branch import special_search
from granchain_core.results.regime import Regime
from granchain_core.steady import regime_criteria
from granchain_core.steady.settling import regime_decisions
from tools.thresholds import printed

_ROOT = Path(__file__).resolve().parents[1]
#: A number, or a word for a number, and its mark.
_MARKED = re.compile(r"[\w.,-]+<!--([a-z_0-9]+\.\w+|\w+)(?::(\S+?))?-->")
#: Functions that write a number in other units, or as a word.
_UNITS: dict[str, Callable[[float], str]] = {
    "": lambda value: _plain(value),
    "%": lambda value: f"{100.0 * value:g}",
    "ms": lambda value: f"{1e3 * value:g}",
    "part": lambda value: {2: "half", 3: "third", 4: "quarter"}[int(value)],
}


def _plain(value: float) -> str:
    """Return a number as the pages write it: 16,000 or 1e-4."""
    if isinstance(value, int) and value >= 10_000:
        return f"{value:,}"
    power = f"{value:.0e}".replace("e-0", "e-")
    return power if 0.0 < value < 0.01 and float(power) == value else printed(value)


def _least_width_over_range() -> float:
    """Return the width that is narrow enough between two orbits at which the knob is 0, over its range's upper end."""
    at_zero, axis = SimpleNamespace(knob=0.0), SimpleNamespace(high=1.0)
    return special_search._wanted(axis, at_zero, at_zero)  # type: ignore[arg-type]


#: Numbers that follow from several constants.
DERIVED: dict[str, Callable[[], float]] = {
    #: Below this exponent, a comparison would take more drive periods than `_LONGEST_COMPARISON`.
    "smallest_exponent": lambda: round(regime_criteria._BOUNDED_GROWTH / regime_criteria._LONGEST_COMPARISON, 4),
    "least_width_over_range": _least_width_over_range,
    "hard_cases": lambda: len(CASES),
    "periods_of_departure": lambda: regime_decisions.MOST_SETTLING_PERIODS * regime_decisions._DEPARTURE_FACTOR,
    "periods_with_one_limit": lambda: regime_criteria._BOUNDED_GROWTH / regime_criteria._LARGEST_NEUTRAL_EXPONENT,
    "largest_assumed_contraction": lambda: Regime("periodic", 1, 1.0, None, 1).assumed_contraction,
    "usual_assumed_contraction": lambda: Regime("periodic", 1, None, None, 1).assumed_contraction,
}


def with_numbers(text: str) -> str:
    """Return a page's text with the code's numbers before its marks. Raise KeyError for a mark of no constant."""
    def as_it_is(match: re.Match[str]) -> str:
        mark = match[0].partition("<")[2]
        return f"{_UNITS[match[2] or ''](value_of(match[1]))}<{mark}"

    return _MARKED.sub(as_it_is, text)


def marks(text: str) -> list[str]:
    """Return the names in the marks of a text."""
    return [match[1] for match in _MARKED.finditer(text)]


@cache
def value_of(name: str) -> float:
    """Return the value of `module.CONSTANT`, which must be in exactly one file, or of one of `DERIVED`."""
    if name in DERIVED:
        return DERIVED[name]()
    module, _, constant = name.partition(".")
    has = re.compile(rf"^{constant}\b[^=\n]*=", re.MULTILINE)
    files = [path for package in ("granchain_core", "app") for path in (_ROOT / package).rglob(f"{module}.py")
             if has.search(path.read_text(encoding="utf-8"))]
    if len(files) != 1:
        raise KeyError(f"{name} is in {len(files)} files")
    found = importlib.import_module(".".join(files[0].relative_to(_ROOT).with_suffix("").parts))
    return getattr(found, constant)  # type: ignore[no-any-return]
