"""A hard case: measurements and their limits, the oracle that judges them, and a small picture."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, ComputationError


@dataclass(frozen=True)
class Measurement:
    """One number that must not exceed its limit; NaN exceeds every limit. `note` states the finding in words."""

    name: str
    value: float
    limit: float
    note: str = ""


@dataclass(frozen=True, eq=False)
class Trace:
    """One curve of a picture: its label, and its values over the picture's x."""

    label: str
    values: np.ndarray


@dataclass(frozen=True, eq=False)
class Picture:
    """A small picture: our result and a naive solver's, over a common x."""

    x: np.ndarray
    x_label: str
    y_label: str
    traces: tuple[Trace, ...]


@dataclass(frozen=True)
class Case:
    """One hard case.

    `measure(quick)` returns the measurements, with smaller counts if `quick`; `picture()` returns the curves shown next
    to them. `hard` and `naive` are one line each for a student: what is hard, and what a naive solver does.
    """

    name: str
    hard: str
    naive: str
    oracle: str
    measure: Callable[[bool], Sequence[Measurement]]
    picture: Callable[[], Picture] | None = None


@dataclass(frozen=True)
class Check:
    """One measurement of a case with its verdict; `seconds` is the time of the whole case, given only in its first row.

    `case` and `measurement` are the names of the two.
    """

    case: str
    measurement: str
    value: float
    limit: float
    passed: bool
    seconds: float
    what_is_hard: str
    naive: str
    oracle: str
    note: str = ""

    @property
    def title(self) -> str:
        """Case and measurement: the row's name in the command line's JSON."""
        return f"{self.case}: {self.measurement}"


def run_case(case: Case, quick: bool) -> list[Check]:
    """Measure one case. A computation that fails or is refused becomes a failed row with the error message."""
    began = time.perf_counter()
    try:
        measurements = list(case.measure(quick))
    except (ComputationError, BadInput) as problem:
        measurements = [Measurement("could not be computed", math.nan, 0.0, str(problem))]
    spent = time.perf_counter() - began
    return [Check(case.name, measurement=f.name, value=f.value, limit=f.limit, passed=bool(f.value <= f.limit),
                  seconds=spent if i == 0 else 0.0, what_is_hard=case.hard, naive=case.naive, oracle=case.oracle,
                  note=f.note) for i, f in enumerate(measurements)]
