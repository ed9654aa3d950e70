"""The picture of the trade: error against time for every method and setting, and how sure the reference is.

The reference is the certified method at its finest; SciPy's DOP853, another implementation without event location, is
run beside it, and how far the two are apart says how well the reference itself is known.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from ..errors import NumbersFailed
from ..integrate import Engine, Setting
from ..integrate.engine import Counts, new_stop
from ..scene import Scene
from .scipy_methods import SOLVERS, solve

#: Periods from rest, and samples a period at which displacements are compared.
PERIODS, SAMPLES = 10, 16
_FIXED = ("verlet-naive", "rk4-naive", "rk4", "rk4-split")
_REFINES = (1, 2, 4, 8, 16)
_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
_SCIPY_TOLERANCES = (1e-3, 1e-5, 1e-7, 1e-9)
_REFERENCE = Setting("dop853", tolerance=3e-15)
_SECOND = ("DOP853", 1e-12)


@dataclass(frozen=True)
class Row:
    """One method at one setting: largest displacement error over the largest displacement, seconds, evaluations."""

    method: str
    setting: str
    error: float
    wall_s: float
    rhs: int


@dataclass(eq=False)
class WorkPrecision:
    """All rows, the reference's method and its agreement with a second one."""

    scene: Scene
    reference: str
    agreement: float
    rows: list[Row] = field(default_factory=list)

    def cheapest(self, error: float) -> Row | None:
        """The fastest of granchain's and SciPy's settings that is at least this accurate."""
        good = [row for row in self.rows if row.error <= error]
        return min(good, key=lambda row: row.wall_s) if good else None


def work_precision(scene: Scene, stop: np.ndarray | None = None,
                   progress: Callable[[float], None] | None = None) -> WorkPrecision:
    """Measure every method on `scene` from rest, here and now. Raises `NumbersFailed` and `Cancelled`."""
    flag = new_stop() if stop is None else stop
    jobs = [(m, Setting(m, refine=r)) for m in _FIXED for r in _REFINES]
    jobs += [("dop853", Setting("dop853", tolerance=t)) for t in _TOLERANCES]
    others = [(solver, t) for solver in SOLVERS for t in _SCIPY_TOLERANCES]
    total, done = len(jobs) + len(others) + 2, 0

    def advance() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done / total)

    exact, _, _ = _ours(scene, _REFERENCE, flag)
    advance()
    second, _ = solve(scene, *_SECOND, PERIODS, SAMPLES)
    advance()
    found = WorkPrecision(scene, f"dop853 with located events, tolerance {_REFERENCE.tolerance:g}",
                          _distance(second, exact))
    for row in _rows(scene, exact, jobs, others, flag):
        found.rows.append(row)
        advance()
    return found


def _rows(scene: Scene, exact: np.ndarray, jobs: list[tuple[str, Setting]], others: list[tuple[str, float]],
          stop: np.ndarray) -> Iterator[Row]:
    for name, setting in jobs:
        label = f"tolerance {setting.tolerance:g}" if setting.tolerance else f"{setting.refine} × the live steps"
        try:
            moved, seconds, counts = _ours(scene, setting, stop)
        except NumbersFailed:
            yield Row(name, label, float("inf"), 0.0, 0)
            continue
        yield Row(name, label, _distance(moved, exact), seconds, counts.rhs)
    for solver, tolerance in others:
        began = time.perf_counter()
        moved, counts = solve(scene, solver, tolerance, PERIODS, SAMPLES)
        seconds = time.perf_counter() - began
        yield Row(f"scipy {solver}", f"tolerance {tolerance:g}", _distance(moved, exact), seconds, counts.rhs)


def _ours(scene: Scene, setting: Setting, stop: np.ndarray) -> tuple[np.ndarray, float, Counts]:
    """Displacements, seconds (the faster of two runs, so that no compiler is measured) and counts."""
    best = float("inf")
    for _ in range(2):
        engine = Engine(scene, setting, SAMPLES, stop=stop)
        began = time.perf_counter()
        moved = engine.record(PERIODS * SAMPLES).displacement
        best = min(best, time.perf_counter() - began)
    return moved, best, engine.counts


def _distance(moved: np.ndarray, exact: np.ndarray) -> float:
    """Largest displacement error over the largest displacement; infinite where the method did not get through."""
    if not np.isfinite(moved).all():
        return float("inf")
    return float(np.abs(moved - exact).max() / np.abs(exact).max())
