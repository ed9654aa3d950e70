"""The curve: 300 frequencies, 100 + 20 periods each from rest, the peak of the elastic output force over the last 20.
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

#: Largest relative difference of a peak from the accurate one at which answers count as equal.
EQUAL = 1e-4
#: A case is left when a setting takes longer than this on its points, seconds.
PATIENCE = 12.0
#: Curves that are timed on all cores, and as many on one.
_TURNS = 9
_ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Answer:
    """One case on its points at the setting that gave equal answers, or at the tightest tried."""

    case: Case
    setting: float
    peaks: Peaks
    points: int
    compared: int
    worst: float
    whole: float
    whole_evaluations: int | None
    runs: int


def work(frequencies: np.ndarray) -> float:
    """Scaled time to be integrated for these points: what a part is scaled to the whole with."""
    return float(sum(problem.period_of(f) for f in frequencies))


def chosen(case: Case, points: int, quick: bool) -> np.ndarray:
    """Indices of the points a case is timed on: every `stride`-th, from the middle of the first stride."""
    stride = min(points // 5, case.stride * (2 if quick and case.stride > 1 else 1))
    return np.arange(stride // 2, points, stride)


def answer(case: Case, frequencies: np.ndarray, accurate: np.ndarray, periodic: np.ndarray, quick: bool) -> Answer:
    """Walk the ladder of settings until the peaks of the periodic points are equal to the accurate ones."""
    picked = chosen(case, frequencies.size, quick)
    mine, compare = frequencies[picked], periodic[picked]
    assert case.peaks is not None
    case.peaks(frequencies[-2:], case.curve_ladder[0])  # a compiler may be in the first run
    for setting in case.curve_ladder:
        peaks = case.peaks(mine, setting)
        off = np.abs(peaks.values / accurate[picked] - 1.0)[compare]
        worst = float(np.nan_to_num(off, nan=np.inf).max()) if off.size else float("nan")
        if worst <= EQUAL or peaks.seconds > PATIENCE:
            break
    runs = [peaks]
    if case.stride == 1:
        runs += [case.peaks(mine, setting) for _ in range(2 if quick else 4)]
        peaks = sorted(runs, key=lambda one: one.seconds)[len(runs) // 2]
    part = work(frequencies) / work(mine)
    evaluations = None if peaks.evaluations is None else round(part * peaks.evaluations)
    return Answer(case, setting, peaks, mine.size, int(compare.sum()), worst, part * peaks.seconds, evaluations,
                  len(runs))


def report(cases: list[Case], quick: bool, tell: Callable[[str], None]) -> str:
    """The table of the curve and the row of the product itself."""
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
    found.sort(key=lambda one: one.whole)
    notes = [
        f"{periodic.sum()} of {periodic.size} points are periodic after {problem.PASSED + problem.WATCHED} periods; only "
        "their peaks are compared, an irregular motion has no answer that two methods share.",
        "Rows with fewer points are scaled to the whole curve by the time integrated; a '!' marks a row whose answers "
        f"are not equal to {EQUAL:g} at the tightest setting tried.",
        "Times are medians of several runs, those marked 'n = 1' of one.",
    ]
    grids = [(frequencies, accurate, periodic)]
    if not quick:  # every 10 Hz as well: what a curve costs depends on which slow transients its points meet
        tell("accurate peaks every 10 Hz, all cores")
        machine.unpin()
        every_10_hz = problem.curve_frequencies(298)
        grids.insert(0, (every_10_hz, *granchain.reference_peaks(every_10_hz)))
        machine.pin()
    return "\n".join([_table(found, frequencies.size, notes), product(grids, tell)])


def _table(found: list[Answer], points: int, notes: list[str]) -> str:
    ours = [one.whole for one in found if one.case.label.startswith("granchain")]
    base = min(ours) if ours else float("nan")
    rows = []
    for one in found:
        each = "–" if one.whole_evaluations is None else f"{1e9 * one.whole / one.whole_evaluations / 12:.2f}"
        mark = "" if one.worst <= EQUAL else " !"
        rows.append([one.case.label, one.case.form, f"{one.case.unit} {one.setting:.3g}", f"{one.points}",
                     f"{one.compared}", f"{one.worst:.0e}{mark}", seconds(one.whole) + (" n = 1" if one.runs == 1 else ""),
                     count(one.whole_evaluations), each, ratio(one.whole / base)])
    return table(f"Curve of {points} points, 100 + 20 periods each, one core",
                 ["solver", "form", "setting", "points", "compared", "worst", "whole curve", "evaluations",
                  "ns/contact", "× granchain"], rows, notes)


def product(grids: list[tuple[np.ndarray, np.ndarray, np.ndarray]], tell: Callable[[str], None]) -> str:
    """`resonance_curve` as a user calls it: settled states with proof, on all cores and on one (product.py).

    `grids` are frequencies with their accurate peaks and whether these are periodic.
    """
    machine.unpin()
    rows = []
    for frequencies, accurate, periodic in grids:
        tell(f"resonance_curve of {frequencies.size} points, {_TURNS} turns")
        rows += _product_rows(frequencies, accurate, periodic)
    machine.pin()
    return table("The product: settled or shown irregular at every point, not 120 periods",
                 ["call", "points", "cores", "median", "least", "periodic", "compared", "worst", "median error"], rows,
                 [f"In a process of its own. Median and least of {_TURNS}, the two in turns."])


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
