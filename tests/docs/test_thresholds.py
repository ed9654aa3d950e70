"""Every threshold has its row, no page names a constant that is not there, and the multipliers of a
page are computed.
"""

from __future__ import annotations

import ast
import importlib
import math
import re
from pathlib import Path

import numpy as np
import pytest
from documents import ROOT

from granchain_core import orbit, scene
from granchain_core.analysis import lyapunov_spectrum
from granchain_core.integrate.fixed import SHORT_CHAIN
from granchain_core.kernels.batch import checks, record
from granchain_core.observers.drift import TRANSLATION
from granchain_core.orbits.branch import ends, normal_forms, special_search, steps
from granchain_core.parameter_maps import scheduled
from granchain_core.results.regime import Regime
from granchain_core.steady import exponent_measurements, regime_criteria, residuals
from granchain_core.steady.batch import job, jobs_in_batch, threads
from granchain_core.steady.curve import resonance_curve
from granchain_core.steady.settling import nearby_orbit, regime_decisions, single_chain
from tools.thresholds import _REGIMES, marked_constants, printed

OBSERVERS, GLOSSARY = (" ".join((ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8").split())
                       for name in ("observers", "glossary"))


def test_every_mark_has_a_table() -> None:
    """A mark that no table knows would leave its constant out of all pages."""
    known = {*_REGIMES, "rotation", "response", "branch", "safety factor", "step size", "no threshold"}
    assert {mark for one in marked_constants() for mark in one.mark.split(", ")} <= known


def test_every_number_with_a_name_beside_a_threshold_has_a_mark() -> None:
    """Names given together, `A, B = range(2)`, are columns."""
    marked = {(one.file, one.name) for one in marked_constants()}
    for file in {file for file, _ in marked}:
        module = importlib.import_module("granchain_core." + file[:-3].replace("/", "."))
        numbers = {name for name in constants(Path(str(module.__file__)), ast.Name)
                   if isinstance(getattr(module, name), int | float)}
        assert not {name for name in numbers if (file, name) not in marked}, file


@pytest.mark.parametrize(("value", "as_printed"), [(3.0, "3"), (0.97, "0.97"), (1e-5, "1e-5"), (10**8, "1e8"), (1 / 3, "1/3")])
def test_how_a_threshold_is_printed(value: float, as_printed: str) -> None:
    assert printed(value) == as_printed


def test_the_text_on_branches_has_the_values_of_the_constants() -> None:
    """Beside the generated table the numbers stand where they are explained."""
    text = " ".join((ROOT / "docs" / "branches.md").read_text(encoding="utf-8").split())
    said = {
        r"t turns by about ([\d.]+)°": steps._TURN_OF_STEP, r"about ([\d.]+) % of the step away": 100.0 * steps._MISS_OF_STEP,
        r"goes farther than ([\d.]+) % of the step": 100.0 * steps.LARGEST_CORRECTION,
        r"if t turns by more than ([\d.]+)°": steps._LARGEST_TURN, r"The longest step is ([\d.]+),": steps.LONGEST_STEP,
        r"the shortest ([\de-]+)\.": steps.SHORTEST_STEP, r"method aims at ([\de-]+);": residuals.RESIDUAL_GOAL,
        r"below ([\de-]+) the orbit is accepted": residuals.ACCEPTED_RESIDUAL,
        r"whose knobs differ by at most ([\de-]+) of the knob \(": special_search.RELATIVE_WIDTH,
        r"for at most (\d+) levels of bisection": special_search._MOST_LEVELS,
        r"back to the starting orbit within ([\de-]+):": ends._CLOSING_DISTANCE,
        r"first differences only: ξ = ([\de-]+)\.": normal_forms._SMALL_AMPLITUDE,
        r"The others have ξ = ([\de-]+),": normal_forms._AMPLITUDE,
        r"differ by more than (\d+) % of their mean": 100.0 * normal_forms._LARGEST_ERROR,
        r"another multiplier is within ([\de-]+) of the unit circle": normal_forms._AT_CIRCLE,
        r"\|μᵏ − 1\| < ([\d.]+) for a k": normal_forms._STRONG_RESONANCE,
    }
    for pattern, value in said.items():
        found = re.findall(pattern, text)
        assert len(found) == 1 and float(found[0]) == pytest.approx(value, rel=1e-12), pattern


def test_docstrings_and_pages_say_up_to_how_many_beads_there_are_multipliers() -> None:
    most = nearby_orbit.MOST_BEADS_WITH_MULTIPLIERS
    for file, times in (("granchain_core/orbits/orbit.py", 3), ("granchain_core/analysis/lyapunov_spectrum.py", 1)):
        assert re.findall(r"(\d+) beads", (ROOT / file).read_text(encoding="utf-8")) == times * [str(most)], file
    for page, words in (("orbits", f"Up to {most} beads the whole derivative"), ("stability", f"of more than {most} beads only"),
                        ("regimes", f"up to {most} beads if the claim"), ("regimes", f"*Run:* up to {most} beads")):
        assert words in " ".join((ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8").split()), page
    assert f"20 to {lyapunov_spectrum.MOST_SPECTRUM_PERIODS:,}." in str(lyapunov_spectrum.lyapunov_spectrum.__doc__)
    assert lyapunov_spectrum._BLOCKS == 20


PARTS = {2: "half", 3: "a third", 4: "a quarter"}
NUMBERS = {2: "two", 3: "three", 4: "four"}
#: The exponent below which P would be above `_LONGEST_COMPARISON`, as it is printed.
SMALLEST_EXPONENT = round(regime_criteria._BOUNDED_GROWTH / regime_criteria._LONGEST_COMPARISON, 4)


@pytest.mark.parametrize(("file", "said"), [
    ("docs/design.md", {
        r"empties every ([\d.]+) ms": 1e3 * threads._INTERVAL,
        r"each task is a block of (\d+) points": resonance_curve.POINTS_IN_TASK,
        r"at most (\d+) periods before Python looks": regime_decisions.EXAMINED_AFTER,
        r"motion continues with (a \w+) of the step": PARTS[job.FINE_STEPS_PER_COARSE],
        r"coarse steps for (\d+) periods beside": exponent_measurements.MEASURED_PERIODS,
        r"at best to ([\de-]+) \(`CURVE_ACCURACY`": single_chain.CURVE_ACCURACY}),
    ("docs/orbits.md", {
        r"stops at a residual of ([\de-]+),": residuals.RESIDUAL_GOAL,
        r"If it ends above ([\de-]+), it fails": residuals.ACCEPTED_RESIDUAL,
        r"is less exact, has ([\de-]+) and": residuals.FIXED_STEP_RESIDUAL_GOAL,
        r"is less exact, has 1e-9 and ([\de-]+)\.": residuals.ACCEPTED_FIXED_STEP_RESIDUAL}),
    ("docs/parameter-map.md", {r"sends blocks of (\d+) cells": scheduled.CELLS_IN_TASK}),
    ("docs/regime-evidence.md", {
        r"The measurement begins after (\d+) periods": regime_decisions.EXAMINED_AFTER,
        r"with at least (\d+) strobes": regime_criteria.SLOW_RECORD,
        r"Its first (\d+) periods do not count": exponent_measurements.TURNING_PERIODS}),
    ("docs/regimes.md", {
        r"drive periods, at most \| (\d+); \d+ for a draft": regime_decisions.MOST_SETTLING_PERIODS,
        r"\| \d+; (\d+) for a draft": jobs_in_batch._DRAFT_PERIODS,
        r"for a draft \| (\d+); [\d,]+ near an unstable": regime_decisions.MOST_SETTLING_PERIODS,
        r"; ([\d,]+) near an unstable orbit \|": f"{regime_decisions.MOST_SETTLING_PERIODS * regime_decisions._DEPARTURE_FACTOR:,}",
        r"The orbit near the motion\.\* After (\d+) periods Newton": regime_decisions.EXAMINED_AFTER,
        r"not decided after (\d+) periods is settled alone": regime_decisions.MOST_SETTLING_PERIODS,
        r"above 0, below ([\d.]+) \| P would be above `_LONGEST_COMPARISON`": SMALLEST_EXPONENT,
        r"computed it is r, at most ([\d.]+), and": Regime("periodic", 1, 1.0, None, 1).assumed_contraction,
        r"decay was seen it is ([\d.]+) \(": Regime("periodic", 1, None, None, 1).assumed_contraction,
        r"\| ([\d.]+) or more \| measured": SMALLEST_EXPONENT,
        r"below ([\d.]+) \+ 3σ": SMALLEST_EXPONENT,
        r"Up to (\d+) periods the limit": regime_criteria._BOUNDED_GROWTH / regime_criteria._LARGEST_NEUTRAL_EXPONENT}),
    ("granchain_core/steady/regime_criteria.py", {
        r"After (\d+) periods a growth": regime_decisions.EXAMINED_AFTER,
        r"a growth of ([\d.]+) a period": regime_criteria.CLEAR_GROWTH,
        r"multiplied a distance by ([\de]+)\.": float(f"{math.exp(regime_criteria.CLEAR_GROWTH * regime_decisions.EXAMINED_AFTER):.0e}")}),
    ("docs/cost.md", {
        r"such a cell runs (\d+) periods or more": regime_decisions.EXAMINED_AFTER,
        r"exponent, (\d+) periods at a time": exponent_measurements.MEASURED_PERIODS,
        r"up to (\d+) periods for the coarse run": regime_decisions.MOST_SETTLING_PERIODS,
        r"from rest; (\d+) points are one task": resonance_curve.POINTS_IN_TASK,
        r"blocks of (\d+) points": resonance_curve.POINTS_IN_TASK,
        r"blocks of (\d+) cells": scheduled.CELLS_IN_TASK, r"; (\d+) cells are one task": scheduled.CELLS_IN_TASK}),
    ("docs/hard-cases.md", {r"irregular run \((\d+) periods of two": exponent_measurements.MEASURED_PERIODS}),
    ("docs/glossary.md", {r"up to (\d+) beads in one vector": SHORT_CHAIN}),
    ("granchain_core/kernels/batch/checks.py", {
        r"at most (\w+) times the distance that the contraction factor": NUMBERS[int(checks.FARTHEST_EXTRAPOLATION)]}),
], ids=lambda given: given if isinstance(given, str) else "")
def test_prose_has_the_values_of_the_constants(file: str, said: dict[str, float | str]) -> None:
    """Numbers in sentences of the docs and of docstrings, where a name in their place would not be read."""
    text = " ".join((ROOT / file).read_text(encoding="utf-8").split())
    for pattern, value in said.items():
        found = re.findall(pattern, text)
        assert len(found) == 1, pattern
        if isinstance(value, str):
            assert found[0] == value, pattern
        else:
            assert float(found[0]) == pytest.approx(value, rel=1e-12), pattern


def test_the_definitions_have_the_values_of_the_constants_they_name() -> None:
    text = " ".join((ROOT / "docs" / "regimes.md").read_text(encoding="utf-8").split())
    named = re.findall(r"([\d.]+) is `(_?[A-Z_]+)`", text)
    assert {name for _, name in named} == {"STANDARD_ERRORS", "_BOUNDED_GROWTH", "_LARGEST_NEUTRAL_EXPONENT"}
    assert all(float(value) == getattr(regime_criteria, name) for value, name in named)


@pytest.mark.parametrize(("accuracy", "noise"), [(1e-8, 1e-7), (1e-5, 1e-6)])
def test_what_run_takes_for_no_change(accuracy: float, noise: float, monkeypatch: pytest.MonkeyPatch) -> None:
    module, seen = importlib.import_module("granchain_core.runs.to_accuracy"), []

    def find_period(strobes: np.ndarray, rounding: float) -> Regime:
        seen.append(rounding)
        return Regime.unsettled(len(strobes) - 1)

    monkeypatch.setattr(module, "find_period", find_period)
    module.run(scene("sec2").evolve(N=2, accuracy=accuracy), periods=1, record=1, samples=8)
    assert seen == [pytest.approx(noise)]


def constants(file: Path, targets: type[ast.expr] = ast.expr) -> set[str]:
    """Names in capitals that a file gives a value at its top level, by assignments to a target of one kind."""
    return {name.id for statement in ast.parse(file.read_text(encoding="utf-8")).body
            if isinstance(statement, ast.Assign | ast.AnnAssign)
            for target in (statement.targets if isinstance(statement, ast.Assign) else [statement.target])
            if isinstance(target, targets) for name in ast.walk(target)
            if isinstance(name, ast.Name) and name.id.isupper()}


@pytest.mark.parametrize("page", sorted((ROOT / "docs").glob("*.md")), ids=lambda page: page.stem)
def test_a_constant_that_a_page_names_is_in_the_file_beside_it(page: Path) -> None:
    """“`NAME` in `file.py`”; the path begins at the root or in `granchain_core`."""
    text = " ".join(page.read_text(encoding="utf-8").split())
    for name, file in re.findall(r"`(_?[A-Z][A-Z_]+)` (?:in|of) `([\w/]+\.py)`", text):
        path = next(place for place in (ROOT / "granchain_core" / file, ROOT / file) if place.exists())
        assert name in constants(path), f"{file} has no {name}"


@pytest.mark.parametrize("page", ["orbits", "branches", "observers", "parameter-map"])
def test_a_constant_that_a_page_names_without_a_file_exists(page: str) -> None:
    named = set(re.findall(r"`(_?[A-Z][A-Z_]{2,})`", (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")))
    if named:
        every = set[str]().union(*(constants(path) for folder in ("granchain_core", "app")
                                   for path in (ROOT / folder).rglob("*.py")))
        assert named <= every, named - every


def test_a_batch_keeps_the_strobes_on_which_a_decision_is_based() -> None:
    assert record.STROBES_KEPT >= regime_decisions.REMEMBERED


@pytest.mark.parametrize(("name", "f", "leading", "pages"), [
    ("fig11-free", 100.0, "4.418", (OBSERVERS,)), ("fig11-founded", 100.0, "0.760", (OBSERVERS,)),
    ("fig11-free", 200.0, "−2.212", (OBSERVERS,)), ("fig11-founded", 200.0, "0.996", (OBSERVERS,)),
])
def test_the_observers_multipliers_are_the_pages(name: str, f: float, leading: str, pages: tuple[str, ...]) -> None:
    """To the digits that are printed: a real one with its sign, of a pair the modulus."""
    found = orbit(scene(name).evolve(f=f), observer=True).observer_multipliers
    first = complex(found[0])
    value = first.real if first.imag == 0.0 else abs(first)
    assert value == pytest.approx(float(leading.replace("−", "-")), abs=0.6e-3)
    assert all(re.search(re.escape(leading), page) for page in pages)


def test_the_share_of_a_drift_is_the_pages() -> None:
    """The number before “(`TRANSLATION` in …)”."""
    printed = re.findall(r"([\d.]+)[^\d|]*\(`TRANSLATION` in", OBSERVERS)
    assert [float(share) for share in printed] == [TRANSLATION]


@pytest.mark.parametrize("page", [OBSERVERS, GLOSSARY], ids=["observers", "glossary"])
def test_every_verdict_on_an_observer_is_named(page: str) -> None:
    assert all(f"`{verdict}`" in page for verdict in ("synchronises", "drifts", "breaks down", "neither yet"))
