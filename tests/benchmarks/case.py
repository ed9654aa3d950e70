"""A row of the tables: one solver for one form of the equations, with its ladder of settings."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from . import problem
from .problem import Solved

#: Solves one initial value problem from rest: takes the drive rate β and times, and returns states and evaluations.
Solve = Callable[[float, np.ndarray], Solved]


@dataclass(frozen=True)
class Peaks:
    """Peaks at some points of the curve, the seconds they took, and the number of evaluations if it is known."""

    values: np.ndarray
    seconds: float
    evaluations: int | None = None


@dataclass(frozen=True)
class Case:
    """One solver for one form of the equations.

    `ladder` goes from loose to tight settings. `prepare(setting)` sets up the trajectory, untimed, and returns the
    function to be timed. `peaks(frequencies, setting)` computes points of the curve and times itself. `curve_ladder`
    lists the settings tried for the curve. If timing all points would take too long, every `stride`-th is timed.
    """

    label: str
    form: str
    ladder: Sequence[float] = ()
    prepare: Callable[[float], Callable[[], Solved]] | None = None
    peaks: Callable[[np.ndarray, float], Peaks] | None = None
    curve_ladder: Sequence[float] = ()
    stride: int = 1
    unit: str = "tolerance"


#: Step sizes that all fixed-step programs try for the curve: 0.2 in scaled time divided by these factors.
CURVE_REFINES = tuple(0.5 * 1.05**k for k in range(55))


def rungs(loose: float, tight: float, per_decade: int = 2) -> list[float]:
    """Return settings from loose to tight, in equal ratios."""
    steps = round(per_decade * math.log10(loose / tight))
    return [loose * 10.0 ** (-k / per_decade) for k in range(steps + 1)]


def case_of(label: str, form: str, solver: Callable[[float], Solve], ladder: Sequence[float],
            curve_ladder: Sequence[float] = (), stride: int = 1, warm: int = 0) -> Case:
    """Make a case of `solver(setting)`, which returns a function that solves one problem; `warm` runs are not timed."""

    def prepare(setting: float) -> Callable[[], Solved]:
        solve, times = solver(setting), problem.trajectory_times()
        beta = problem.beta_of(problem.FREQUENCY)
        return lambda: solve(beta, times)

    def peaks(frequencies: np.ndarray, setting: float) -> Peaks:
        solve, values, seconds, evaluations = solver(setting), [], 0.0, 0
        for frequency in frequencies:
            beta, times = problem.beta_of(frequency), problem.watched_times(frequency)
            for _ in range(warm):
                solve(beta, times)
            began = time.perf_counter()
            found = solve(beta, times)
            values.append(problem.output_peak(found.states))
            seconds += time.perf_counter() - began
            evaluations += found.evaluations or 0
        return Peaks(np.array(values), seconds, evaluations or None)

    return Case(label, form, ladder, prepare, peaks if curve_ladder else None, curve_ladder, stride)


def rest() -> np.ndarray:
    """Return the initial state: all zeros, in both forms."""
    return np.zeros(2 * problem.BEADS)
