"""Verdicts on the largest forces of runs, curve points and map cells: comparison of true and stated errors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from granchain_core import ComputationError, Scene, resonance_curve, run
from granchain_core.errors import OverBudget
from granchain_core.parameter_maps.cells import ERRORS, cell_of
from granchain_core.parameter_maps.compute import iter_parameter_map
from granchain_core.parameter_maps.grid import Axis, Grid
from granchain_core.scene.state import State

from .draw import LONGEST, Draw, draw, draw_steady, strength
from .located import TooLong, located

COLUMNS = ("input", "output", "elastic")
#: Tolerances of the two reference computations.
_TIGHT, _LOOSE = 1e-12, 1e-10
#: An error counts as larger than the stated one if it exceeds it by more than this many times the uncertainty of the
#: reference. This is an allowance, not derived: two computations may by chance differ by less than either's error.
_ALLOWANCE = 3.0
#: A force is judged if the uncertainty of the reference is below this fraction of the stated error. The allowance is
#: then below the stated error, since 3 × 0.3 < 1.
_KNOWN_FRACTION = 0.3
#: The smallest stated error in that comparison: the two reference computations agree to this if neither amplifies
#: errors (measured, tests/numerics/test_force_errors.py).
_REFERENCE_AGREES = 1e-9
#: The reference is given up after this many steps.
MOST_STEPS = 1_000_000
#: Maximum number of drive periods for relaxing onto an orbit.
_PATIENCE = 4000
#: A point is judged at this relative distance from its orbit.
_ON_ORBIT = 1e-9
#: A force is silently wrong if its error exceeds this plus so many times the stated error: a definition, which
#: docs/accuracy.md quotes.
SILENT, _TIMES_STATED = 1e-3, 10.0
#: Relative change of a force per relative distance of displacements: 3/2 of an overlap's change, and an overlap is the
#: difference of two displacements.
_FORCE_PER_DISTANCE = 3.0
#: Time allowed for a run [s].
BUDGET = 6.0
#: Points of a curve, columns and rows of a map.
_POINTS, _ACROSS, _DOWN = 8, 4, 2


@dataclass(frozen=True)
class Verdict:
    """One scene: the true and stated relative errors of its three forces (NaN if none is stated), and the uncertainty
    of the reference.
    """

    kind: str
    index: int
    scene: Scene
    what: str
    error: np.ndarray
    stated: np.ndarray
    known: np.ndarray

    @property
    def strength(self) -> float:
        """The scaled damping λ."""
        return strength(self.scene)

    @property
    def judged(self) -> np.ndarray:
        """Columns whose reference is known well enough to judge the stated error or, if none is stated, SILENT."""
        expected = np.where(np.isnan(self.stated), SILENT, np.maximum(self.stated, _REFERENCE_AGREES))
        return self.known < _KNOWN_FRACTION * expected

    @property
    def bounded(self) -> np.ndarray:
        """Columns whose error is within the stated one."""
        return self.error <= self.stated + _ALLOWANCE * self.known

    @property
    def silent(self) -> np.ndarray:
        """Columns that are silently wrong, by more than SILENT plus ten times the stated error."""
        return self.error > SILENT + _TIMES_STATED * np.nan_to_num(self.stated) + _ALLOWANCE * self.known


def apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return differences relative to b: 0 where both are 0, very large where only b is."""
    a, b = np.maximum(a, 0.0), np.maximum(b, 0.0)  # an open contact has zero force, not −∞
    return np.where(a == b, 0.0, np.abs(a - b) / np.where(b > 0.0, b, 1e-300))


def judge_run(drawn: Draw, most_steps: int = MOST_STEPS, budget: float = BUDGET) -> Verdict | str:
    """Judge a whole motion, or return the reason why not; the reference is given up after `most_steps`."""
    chosen = drawn.scene
    try:
        found = run(chosen, drawn.periods, drawn.record, 16, budget=budget)
    except (ComputationError, OverBudget):
        return "refused or failed, and said so"
    try:
        true, nearly = (located(chosen, drawn.periods, drawn.record, 1, tolerance, most_steps=most_steps).maxima
                        for tolerance in (_TIGHT, _LOOSE))
    except (TooLong, FloatingPointError):
        return "truth not known"
    return Verdict("run", drawn.index, chosen, f"{found.status} {drawn.periods}+{drawn.record}", apart(forces(found), true),
                   np.array(found.force_errors.row), apart(nearly, true))


def forces(found: Any) -> np.ndarray:
    """Return the three largest forces of a run or a curve point."""
    return np.array([found.max_input_force, found.max_output_force, found.max_output_force_elastic])


def on_orbit(chosen: Scene, state: State, n: int) -> tuple[State, float] | None:
    """Return a state near the orbit of period n and its relative distance; None if the motion does not come near it."""
    before = None
    for _ in range(max(8, _PATIENCE // n)):
        after = located(chosen, n, 0, 1, 1e-11, state, MOST_STEPS // 8).state
        change = max(float(np.abs(getattr(after, x) - getattr(state, x)).max() / max(np.abs(getattr(after, x)).max(), 1e-300))
                     for x in ("displacement", "velocity"))
        factor = 0.99 if before is None else min(max(change / before, 0.1), 0.999) if before > 0.0 else 0.1
        if change * factor / (1.0 - factor) < _ON_ORBIT:
            return after, change * factor / (1.0 - factor)
        before, state = change, after
    return None


def judge_point(kind: str, index: int, chosen: Scene, state: State, n: int, maxima: np.ndarray, stated: np.ndarray) -> Verdict | str:
    """Judge a periodic point, or return the reason why not."""
    try:
        orbit = on_orbit(chosen, state, n)
        if orbit is None:
            return "not periodic within the patience"
        true, nearly = (located(chosen, 0, n, 1, tolerance, orbit[0], MOST_STEPS).maxima for tolerance in (_TIGHT, _LOOSE))
    except (TooLong, FloatingPointError):
        return "truth not known"
    return Verdict(kind, index, chosen, f"period {n}", apart(maxima, true), stated, apart(nearly, true) + _FORCE_PER_DISTANCE * orbit[1])


def judge_curve(seed: int, index: int, structures: list) -> Iterator[Verdict | str]:
    """Judge the periodic points of one short curve from rest."""
    base = draw_steady(seed, index, structures)
    frequencies = base.f * np.geomspace(1.0, 1.3, _POINTS)
    for point in resonance_curve(base, frequencies).points:
        if point.failure or point.regime.period is None:
            continue
        yield judge_point("curve", index, base.evolve(f=point.frequency), point.state, point.regime.period, forces(point),
                          np.array(point.force_errors.row))


def judge_map(seed: int, index: int, structures: list) -> Iterator[Verdict | str]:
    """Judge the periodic cells of one small map."""
    base = draw_steady(seed, index, structures)
    grid = Grid(base, Axis.of("f", base.f * np.geomspace(1.0, 1.3, _ACROSS)), Axis.of("D", base.D * np.geomspace(0.5, 1.0, _DOWN)))
    for result in iter_parameter_map(grid, workers=1):
        cell = cell_of(result)
        if result.failure or result.regime.period is None:
            continue
        stated = np.array([cell[name] for name in ERRORS])
        maxima = np.array([cell["max_input_force"], cell["max_output_force"], cell["max_output_force_elastic"]])
        yield judge_point("map", index, result.scene, result.state, result.regime.period, maxima, stated)


def verdicts(kind: str, count: int, seed: int, structures: list, first: int = 0, longest: float = LONGEST,
             budget: float = BUDGET) -> Iterator[Verdict | str]:
    """Judge draws `first` to `first + count − 1` of one kind; yield a verdict for each, or the reason why not.

    `longest` and `budget` apply to runs.
    """
    for index in range(first, first + count):
        if kind == "run":
            yield judge_run(draw(seed, index, structures, longest), budget=budget)
        else:
            yield from (judge_curve if kind == "curve" else judge_map)(seed, index, structures)
