"""Benchmark of a curve: the peak of the elastic output force at 300 frequencies, over the last 20 of 120 periods from
rest.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import machine, problem
from .case import Case, Peaks
from .peers import granchain
from .tables import count, ratio, seconds, table

#: Answers count as equal if every peak differs from the accurate one by at most this relative amount.
EQUAL = 1e-4
#: A case is given up if one setting takes longer than this for its points [s].
PATIENCE = 12.0
#: Number of curves that are timed on all cores, and of those on one core.
_TURNS = 9
_ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Answer:
    """The result of one case, at the setting that gave equal answers or at the tightest one tried."""

    case: Case
    setting: float
    peaks: Peaks
    points: int
    compared: int
    worst: float
    whole: float
    whole_evaluations: int | None
    runs: int

    @property
    def is_equal(self) -> bool:
        """Whether all compared peaks agree with the accurate ones."""
        return self.worst <= EQUAL


def work(frequencies: np.ndarray) -> float:
    """Return the scaled time to be integrated for these points; a part is scaled to the whole in this proportion."""
    return float(sum(problem.period_of(f) for f in frequencies))


def chosen(case: Case, points: int, quick: bool) -> np.ndarray:
    """Return the indices of the points timed for a case: every `stride`-th, from the middle of the first stride."""
    stride = min(points // 5, case.stride * (2 if quick and case.stride > 1 else 1))
    return np.arange(stride // 2, points, stride)


def answer(case: Case, frequencies: np.ndarray, accurate: np.ndarray, periodic: np.ndarray, quick: bool) -> Answer:
    """Climb the ladder of settings until the peaks of the periodic points are equal to the accurate ones."""
    picked = chosen(case, frequencies.size, quick)
    mine, compare = frequencies[picked], periodic[picked]
    assert case.peaks is not None
    case.peaks(frequencies[-2:], case.curve_ladder[0])  # the first run may compile
    for setting in case.curve_ladder:
        peaks = case.peaks(mine, setting)
        off = np.abs(peaks.values / accurate[picked] - 1.0)[compare]
        worst = float(np.nan_to_num(off, nan=np.inf).max()) if off.size else float("nan")
        if worst <= EQUAL or peaks.seconds > PATIENCE:
            break
    runs = [peaks]
    if case.stride == 1:
        runs += [case.peaks(mine, setting) for _ in range(2 if quick else 4)]
        peaks = sorted(runs, key=lambda run: run.seconds)[len(runs) // 2]
    part = work(frequencies) / work(mine)
    evaluations = None if peaks.evaluations is None else round(part * peaks.evaluations)
    return Answer(case, setting, peaks, mine.size, int(compare.sum()), worst, part * peaks.seconds, evaluations,
                  len(runs))


def report(cases: list[Case], quick: bool, tell: Callable[[str], None]) -> str:
    """Return the tables of the curve and of granchain's own `resonance_curve`."""
    frequencies = problem.curve_frequencies(60 if quick else 300)
    tell("accurate peaks, all cores")
    machine.unpin()
    accurate, periodic = granchain.reference_peaks(frequencies)
    machine.pin()
    found = []
    for case in cases:
        if case.peaks is not None and not (quick and case.stride >= 60):
            tell(f"{case.label} ({case.form})")
            found.append(answer(case, frequencies, accurate, periodic, quick))
    found.sort(key=lambda row: row.whole)
    notes = [
        f"{periodic.sum()} of {periodic.size} points are periodic after {problem.PASSED + problem.WATCHED} periods; only "
        "their peaks are compared, since two methods cannot agree on an irregular motion.",
        "Rows with fewer points are scaled to the whole curve by the time integrated; a '!' marks a row whose answers "
        f"do not agree to {EQUAL:g} even at the tightest setting tried.",
        "Times are medians of several runs, except those marked 'n = 1'.",
    ]
    grids = [(frequencies, accurate, periodic)]
    if not quick:  # every 10 Hz as well: the cost of a curve depends on which slow transients its points meet
        tell("accurate peaks every 10 Hz, all cores")
        machine.unpin()
        every_10_hz = problem.curve_frequencies(298)
        grids.insert(0, (every_10_hz, *granchain.reference_peaks(every_10_hz)))
        machine.pin()
    return "\n".join([_table(found, frequencies.size, notes), product(grids, tell)])


def fastest_of_ours(found: list[Answer]) -> float:
    """Return the shortest time of a granchain row with equal answers, the unit of "× granchain"; NaN if none is."""
    return min((row.whole for row in found if row.case.label.startswith("granchain") and row.is_equal),
               default=float("nan"))


def _table(found: list[Answer], points: int, notes: list[str]) -> str:
    base = fastest_of_ours(found)
    rows = []
    for row in found:
        contacts = problem.BEADS + 1
        each = "–" if row.whole_evaluations is None else f"{1e9 * row.whole / row.whole_evaluations / contacts:.2f}"
        mark = "" if row.is_equal else " !"
        rows.append([row.case.label, row.case.form, f"{row.case.unit} {row.setting:.3g}", f"{row.points}",
                     f"{row.compared}", f"{row.worst:.0e}{mark}", seconds(row.whole) + (" n = 1" if row.runs == 1 else ""),
                     count(row.whole_evaluations), each, ratio(row.whole / base)])
    return table(f"Curve of {points} points, {problem.PASSED} + {problem.WATCHED} periods each, one core",
                 ["solver", "form", "setting", "points", "compared", "worst", "whole curve", "evaluations",
                  "ns/contact", "× granchain"], rows, notes)


def product(grids: list[tuple[np.ndarray, np.ndarray, np.ndarray]], tell: Callable[[str], None]) -> str:
    """Time `resonance_curve` as a user calls it: settled states with proof, on all cores and on one (product.py).

    Each of the `grids` has frequencies, their accurate peaks, and whether the points are periodic.
    """
    machine.unpin()
    rows = []
    for frequencies, accurate, periodic in grids:
        tell(f"resonance_curve of {frequencies.size} points, {_TURNS} turns")
        rows += _product_rows(frequencies, accurate, periodic)
    machine.pin()
    return table(f"The product: settled or shown irregular at every point, not {problem.PASSED + problem.WATCHED} periods",
                 ["call", "points", "cores", "median", "least", "periodic", "compared", "worst", "median error"], rows,
                 [f"In a separate process. Median and least of {_TURNS}, on all cores and on one alternately."])


def _product_rows(frequencies: np.ndarray, accurate: np.ndarray, periodic: np.ndarray) -> list[list[str]]:
    with tempfile.TemporaryDirectory() as folder:
        wanted = Path(folder, "frequencies.json")
        wanted.write_text(json.dumps(list(frequencies)), encoding="utf-8")
        answer = subprocess.run([sys.executable, "-m", "tests.benchmarks.product", str(_TURNS), str(wanted)], cwd=_ROOT,
                                capture_output=True, text=True, check=True)
    rows = []
    for workers, found in json.loads(answer.stdout.strip().splitlines()[-1]).items():
        settled = np.array(found["periodic"])
        both = settled & periodic
        off = np.abs(np.array(found["forces"]) / _force_unit() / accurate - 1.0)[both]
        rows.append(["resonance_curve", f"{frequencies.size}", f"{workers} threads", seconds(statistics.median(found["seconds"])),
                     seconds(min(found["seconds"])), f"{settled.sum()}", f"{both.sum()}", f"{off.max():.0e}",
                     f"{np.median(off):.0e}"])
    return rows


def _force_unit() -> float:
    return problem.STIFFNESS * problem.AMPLITUDE**1.5
