"""Benchmark of one trajectory: 20 periods from rest at 340 Hz, every solver at its cheapest setting for a given error.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from . import compiled, problem
from .case import Case
from .machine import Timed, timed
from .peers import granchain
from .problem import Solved
from .tables import count, ratio, seconds, table

TARGETS = (6e-5, 2e-6, 1e-8, 1e-10)
#: Largest distance of the nearest other integrator from the reference: 2.5e-10 was measured for SciPy, and 8e-13 for
#: heyoka.
LARGEST_DISTANCE = 1e-9
#: A ladder is abandoned when one run takes longer than this [s].
PATIENCE, QUICK_PATIENCE = 0.7, 0.1


@dataclass(frozen=True)
class Rung:
    """One setting of one case: largest displacement error relative to the largest displacement, and time of one run
    [s].
    """

    setting: float
    error: float
    seconds: float
    evaluations: int | None
    run: Callable[[], Solved]


def error_of(states: np.ndarray, reference: np.ndarray) -> float:
    """Return the largest error of any displacement sample, relative to the largest displacement."""
    n = problem.BEADS
    if not np.isfinite(states[:, :n]).all():
        return float("inf")
    return float(np.abs(states[:, :n] - reference[:, :n]).max() / np.abs(reference[:, :n]).max())


def climb(case: Case, reference: np.ndarray, quick: bool = False) -> list[Rung]:
    """Climb a case's ladder until the smallest error is reached or patience runs out; with `quick`, take every third
    rung.
    """
    found: list[Rung] = []
    assert case.prepare is not None
    for setting in case.ladder[:: 3 if quick else 1]:
        run = case.prepare(setting)
        if not found:
            run()  # a compiler may be in the first run
        began = time.perf_counter()
        solved = run()
        spent = time.perf_counter() - began
        found.append(Rung(setting, error_of(solved.states, reference), spent, solved.evaluations, run))
        if found[-1].error <= TARGETS[-1] or spent > (QUICK_PATIENCE if quick else PATIENCE):
            break
    return found


def cheapest(rungs: Iterable[Rung], target: float) -> Rung | None:
    """Return the fastest rung that reaches the error, or None."""
    good = [rung for rung in rungs if rung.error <= target]
    return min(good, key=lambda rung: rung.seconds) if good else None


def second_opinion(reference: np.ndarray) -> dict[str, float]:
    """Return the distances from the reference of other integrators, which share no code with it, by name."""
    from .peers import heyoka, scipy

    times, beta = problem.trajectory_times(), problem.beta_of(problem.FREQUENCY)
    distances = {}
    for name, solve in (("scipy DOP853 in w at 1e-13", lambda: scipy.ivp("DOP853", compiled.slope_w, 1e-13)),
                        ("heyoka with events at 1e-16", lambda: heyoka.solver(1e-16))):
        if name.startswith("heyoka") and heyoka.missing():
            continue
        distances[name] = error_of(solve()(beta, times).states, reference)
    return distances


def confirmation(distances: dict[str, float]) -> str:
    """Return these distances in words, with the targets that none of them confirms.

    Raises `SystemExit` if all are large: every solver would be ranked by a wrong reference.
    """
    words = "; ".join(f"{name}: {distance:.1e}" for name, distance in distances.items())
    nearest = min(distances.values())
    if not nearest <= LARGEST_DISTANCE:
        raise SystemExit(f"No other integrator confirms the reference to {LARGEST_DISTANCE:g}: {words}")
    unconfirmed = ", ".join(f"{target:g}" for target in TARGETS if target < nearest)
    return words + (f" (!: not confirmed to {unconfirmed})" if unconfirmed else "")


def report(cases: list[Case], quick: bool, tell: Callable[[str], None]) -> str:
    """Return the tables for all target errors."""
    reference = granchain.reference().states
    opinion = confirmation(second_opinion(reference))
    rungs = {}
    for case in cases:
        if case.prepare is not None:
            tell(f"{case.label} ({case.form})")
            rungs[case.label, case.form] = (case, climb(case, reference, quick))
    note = f"Reference: granchain's dop853 at {granchain.FINEST:g}. Distance of others: "
    return "\n".join([note + opinion, *[_table(rungs, t, quick) for t in TARGETS]])


def _table(rungs: dict[tuple[str, str], tuple[Case, list[Rung]]], target: float, quick: bool) -> str:
    found: list[tuple[Case, Rung, Timed]] = []
    missed = []
    for case, ladder in rungs.values():
        rung = cheapest(ladder, target)
        if rung is None:
            missed.append(f"{case.label} ({case.form})")
        else:
            found.append((case, rung, timed(rung.run, 0.05 if quick else 0.25)))
    found.sort(key=lambda row: row[2].median)
    ours = [spent.median for case, _, spent in found if case.label.startswith("granchain")]
    base = min(ours) if ours else float("nan")
    rows = [[case.label, case.form, f"{case.unit} {rung.setting:.3g}", f"{rung.error:.1e}", seconds(spent.median),
             seconds(spent.least), count(rung.evaluations), ratio(spent.median / base)] for case, rung, spent in found]
    patience = QUICK_PATIENCE if quick else PATIENCE
    notes = [f"Not reached by any setting (or not within {patience:g} s per run): {', '.join(missed)}."] if missed else []
    return table(f"Trajectory at error {target:g}",
                 ["solver", "form", "setting", "error", "median", "least", "evaluations", "× granchain"], rows, notes)
