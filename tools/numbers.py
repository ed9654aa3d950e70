"""Numbers of the code in sentences of the docs, which `python -m tools.update` writes.

A mark behind a number names its constant by the module's last name: `400<!--regime_decisions.EXAMINED_AFTER-->`. A
unit behind a colon says how the number is written: `30<!--steps.LARGEST_CORRECTION:%-->`. A number that follows from
several constants is one of `DERIVED`.
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

_CORE = Path(__file__).resolve().parents[1] / "granchain_core"
#: A number, or a word for one, and its mark.
_MARKED = re.compile(r"[\w.,-]+<!--([a-z_0-9]+\.\w+|\w+)(?::(\S+?))?-->")
#: How a number is written in other units, and as a word.
_UNITS: dict[str, Callable[[float], str]] = {
    "": lambda value: _plain(value),
    "%": lambda value: f"{100.0 * value:g}",
    "ms": lambda value: f"{1e3 * value:g}",
    "part": lambda value: {2: "half", 3: "third", 4: "quarter"}[int(value)],
}


def _plain(value: float) -> str:
    """As the pages write numbers: 16,000 and 1e-4."""
    if isinstance(value, int) and value >= 10_000:
        return f"{value:,}"
    power = f"{value:.0e}".replace("e-0", "e-")
    return power if 0.0 < value < 0.01 and float(power) == value else printed(value)


def _least_width_over_range() -> float:
    """The width that is narrow enough between two orbits at which the knob is 0, over the larger end of its range."""
    at_zero, axis = SimpleNamespace(knob=0.0), SimpleNamespace(high=1.0)
    return special_search._wanted(axis, at_zero, at_zero)  # type: ignore[arg-type]


#: Numbers that follow from several constants.
DERIVED: dict[str, Callable[[], float]] = {
    #: Below this exponent the drive periods of a comparison would be more than `_LONGEST_COMPARISON`.
    "smallest_exponent": lambda: round(regime_criteria._BOUNDED_GROWTH / regime_criteria._LONGEST_COMPARISON, 4),
    "least_width_over_range": _least_width_over_range,
    "hard_cases": lambda: len(CASES),
    "periods_of_departure": lambda: regime_decisions.MOST_SETTLING_PERIODS * regime_decisions._DEPARTURE_FACTOR,
    "periods_with_one_limit": lambda: regime_criteria._BOUNDED_GROWTH / regime_criteria._LARGEST_NEUTRAL_EXPONENT,
    "largest_assumed_contraction": lambda: Regime("periodic", 1, 1.0, None, 1).assumed_contraction,
    "usual_assumed_contraction": lambda: Regime("periodic", 1, None, None, 1).assumed_contraction,
}


def with_numbers(text: str) -> str:
    """A page's text with the numbers before its marks as the code has them. KeyError for a mark that names none."""
    def as_it_is(match: re.Match[str]) -> str:
        mark = match[0].partition("<")[2]
        return f"{_UNITS[match[2] or ''](value_of(match[1]))}<{mark}"

    return _MARKED.sub(as_it_is, text)


def marks(text: str) -> list[str]:
    """What the marks of a text name."""
    return [match[1] for match in _MARKED.finditer(text)]


@cache
def value_of(name: str) -> float:
    """The value of `module.CONSTANT`, which must be in one file only, or of one of `DERIVED`."""
    if name in DERIVED:
        return DERIVED[name]()
    module, _, constant = name.partition(".")
    has = re.compile(rf"^{constant}\b[^=\n]*=", re.MULTILINE)
    files = [path for path in _CORE.rglob(f"{module}.py") if has.search(path.read_text(encoding="utf-8"))]
    if len(files) != 1:
        raise KeyError(f"{name} is in {len(files)} files")
    found = importlib.import_module(".".join(files[0].relative_to(_CORE.parent).with_suffix("").parts))
    return getattr(found, constant)  # type: ignore[no-any-return]
