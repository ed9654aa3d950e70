"""A hard case: figures against bars, the oracle they are measured against, and a small picture."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, NumbersFailed


@dataclass(frozen=True)
class Figure:
    """One number that must not be above its bar; NaN is above every bar. `note` is the finding in words."""

    name: str
    value: float
    bar: float
    note: str = ""


@dataclass(frozen=True, eq=False)
class Trace:
    """One line of a picture: its label and its values over the picture's x."""

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

    `measure(quick)` computes the figures, with smaller counts where it is quick; `picture()` the lines drawn beside
    them. `hard` and `naive` are one line each for a student: what is hard, and what a naive solver does there.
    """

    name: str
    hard: str
    naive: str
    oracle: str
    measure: Callable[[bool], Sequence[Figure]]
    picture: Callable[[], Picture] | None = None


@dataclass(frozen=True)
class Check:
    """One figure of a case with its verdict; `seconds` is the whole case's time, on its first row only."""

    case: str
    figure: float
    bar: float
    passed: bool
    seconds: float
    what_is_hard: str
    naive: str
    oracle: str
    note: str = ""


def run_case(case: Case, quick: bool) -> list[Check]:
    """Measure one case; a computation that fails or is refused is a row that did not pass, with its sentence."""
    began = time.perf_counter()
    try:
        figures = list(case.measure(quick))
    except (NumbersFailed, BadInput) as problem:
        figures = [Figure("could not be computed", math.nan, 0.0, str(problem))]
    spent = time.perf_counter() - began
    return [Check(f"{case.name}: {f.name}", f.value, f.bar, bool(f.value <= f.bar), spent if i == 0 else 0.0,
                  case.hard, case.naive, case.oracle, f.note) for i, f in enumerate(figures)]
