"""Every threshold has its row, all constants named in pages exist, and the multipliers in pages are computed."""

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
from granchain_core.kernels.batch import checks, record
from granchain_core.observers.drift import TRANSLATION
from granchain_core.results.regime import Regime
from granchain_core.steady import regime_criteria
from granchain_core.steady.settling import nearby_orbit, regime_decisions
from tools.numbers import with_numbers
from tools.thresholds import _REGIMES, marked_constants, printed

OBSERVERS, GLOSSARY = (" ".join((ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8").split())
                       for name in ("observers", "glossary"))


def test_every_mark_has_a_table() -> None:
    """A constant whose mark no table knows would be missing from all pages."""
    known = {*_REGIMES, "rotation", "response", "branch", "fit", "attractors", "safety factor", "step size", "no threshold"}
    assert {mark for one in marked_constants() for mark in one.mark.split(", ")} <= known


def test_every_number_with_a_name_beside_a_threshold_has_a_mark() -> None:
    """Names assigned together, as in `A, B = range(2)`, are columns and need none."""
    marked = {(one.file, one.name) for one in marked_constants()}
    for file in {file for file, _ in marked}:
        module = importlib.import_module("granchain_core." + file[:-3].replace("/", "."))
        numbers = {name for name in constants(Path(str(module.__file__)), ast.Name)
                   if isinstance(getattr(module, name), int | float)}
        assert not {name for name in numbers if (file, name) not in marked}, file


@pytest.mark.parametrize(("value", "as_printed"), [(3.0, "3"), (0.97, "0.97"), (1e-5, "1e-5"), (10**8, "1e8"), (1 / 3, "1/3")])
def test_a_threshold_is_printed_with_few_digits(value: float, as_printed: str) -> None:
    assert printed(value) == as_printed


def test_docstrings_say_up_to_how_many_beads_there_are_multipliers() -> None:
    most = nearby_orbit.MOST_BEADS_WITH_MULTIPLIERS
    for file, times in (("granchain_core/orbits/orbit.py", 3), ("granchain_core/analysis/lyapunov_spectrum.py", 1)):
        assert re.findall(r"(\d+) beads", (ROOT / file).read_text(encoding="utf-8")) == times * [str(most)], file
    assert f"20 to {lyapunov_spectrum.MOST_SPECTRUM_PERIODS:,}." in str(lyapunov_spectrum.lyapunov_spectrum.__doc__)
    assert lyapunov_spectrum._BLOCKS == 20


def test_docstrings_have_the_values_of_the_constants() -> None:
    """These are the values for a growth since the motion was examined, and for an extrapolation."""
    said = " ".join(str(regime_criteria.clearly_chaotic.__doc__).split())
    periods, growth = re.findall(r"In (\d+) periods, an exponent of ([\d.]+) per period", said)[0]
    assert (int(periods), float(growth)) == (regime_decisions.EXAMINED_AFTER, regime_criteria.CLEAR_GROWTH)
    multiplied = float(re.findall(r"multiplies a distance by ([\de]+)\.", said)[0])
    assert multiplied == float(f"{math.exp(regime_criteria.CLEAR_GROWTH * regime_decisions.EXAMINED_AFTER):.0e}")
    assert checks.FARTHEST_EXTRAPOLATION == 3 and "at most three times the distance that the contraction factor" in " ".join(
        Path(str(checks.__file__)).read_text(encoding="utf-8").split())


def test_a_number_before_a_mark_is_the_constants() -> None:
    assert with_numbers("5<!--steps._LARGEST_TURN-->°, 1<!--steps.LARGEST_CORRECTION:%--> %") \
        == "30<!--steps._LARGEST_TURN-->°, 30<!--steps.LARGEST_CORRECTION:%--> %"
    assert with_numbers("a half<!--job.FINE_STEPS_PER_COARSE:part--> of 1<!--periods_of_departure-->") \
        == "a third<!--job.FINE_STEPS_PER_COARSE:part--> of 16,000<!--periods_of_departure-->"
    for unknown in ("steps.NO_SUCH", "no_such", "advance.no"):
        with pytest.raises(KeyError):
            with_numbers(f"5<!--{unknown}-->")


@pytest.mark.parametrize(("accuracy", "noise"), [(1e-8, 1e-7), (1e-5, 1e-6)])
def test_run_passes_the_noise_of_its_accuracy_as_rounding(accuracy: float, noise: float, monkeypatch: pytest.MonkeyPatch) -> None:
    module, seen = importlib.import_module("granchain_core.runs.to_accuracy"), []

    def find_period(strobes: np.ndarray, rounding: float) -> Regime:
        seen.append(rounding)
        return Regime.unsettled(len(strobes) - 1)

    monkeypatch.setattr(module, "find_period", find_period)
    module.run(scene("sec2").evolve(N=2, accuracy=accuracy), periods=1, record=1, samples=8)
    assert seen == [pytest.approx(noise)]


def constants(file: Path, targets: type[ast.expr] = ast.expr) -> set[str]:
    """Return the names in capitals that a file assigns at its top level, with targets of one kind."""
    return {name.id for statement in ast.parse(file.read_text(encoding="utf-8")).body
            if isinstance(statement, ast.Assign | ast.AnnAssign)
            for target in (statement.targets if isinstance(statement, ast.Assign) else [statement.target])
            if isinstance(target, targets) for name in ast.walk(target)
            if isinstance(name, ast.Name) and name.id.isupper()}


@pytest.mark.parametrize("page", sorted((ROOT / "docs").glob("*.md")), ids=lambda page: page.stem)
def test_a_constant_that_a_page_names_is_in_the_file_beside_it(page: Path) -> None:
    """The form is “`NAME` in `file.py`”, with a path from the root or from `granchain_core`."""
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
    """They agree to the printed digits: a real multiplier with its sign, a complex pair by its modulus."""
    found = orbit(scene(name).evolve(f=f), observer=True).observer_multipliers
    first = complex(found[0])
    value = first.real if first.imag == 0.0 else abs(first)
    assert value == pytest.approx(float(leading.replace("−", "-")), abs=0.6e-3)
    assert all(re.search(re.escape(leading), page) for page in pages)


def test_the_share_of_a_drift_is_the_pages() -> None:
    """It is the number before “(`TRANSLATION` in …)”."""
    printed = re.findall(r"([\d.]+)[^\d|]*\(`TRANSLATION` in", OBSERVERS)
    assert [float(share) for share in printed] == [TRANSLATION]


@pytest.mark.parametrize("page", [OBSERVERS, GLOSSARY], ids=["observers", "glossary"])
def test_every_verdict_on_an_observer_is_named(page: str) -> None:
    assert all(f"`{verdict}`" in page for verdict in ("synchronises", "drifts", "breaks down", "neither yet"))
