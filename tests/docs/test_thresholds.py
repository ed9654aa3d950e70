"""Numbers that pages give beside the name of a constant are the code's, no page names a constant that is not there, and
the multipliers of two pages are computed.
"""

from __future__ import annotations

import ast
import importlib
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from documents import ROOT

from granchain_core import orbit, scene
from granchain_core.kernels.batch import record
from granchain_core.observe.drift import TRANSLATION
from granchain_core.regime import Regime
from granchain_core.steady.curve import resonance
from granchain_core.steady.settling import regime_decisions

MODEL, OBSERVERS, REGIMES, GLOSSARY = (" ".join((ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8").split())
                                       for name in ("model", "observers", "regimes", "glossary"))
#: Rows of the table of thresholds: the number, the constant's name and its file.
ROWS = re.findall(r"\| ([\d.e-]+) \| `(\w+)` in `([\w/]+)\.py` \|", REGIMES)
#: Numbers in the same files that decide no regime: the size of a record, a period that is never reached, how a
#: difference is computed, when a run is refined.
NO_THRESHOLDS = {"STROBES_KEPT", "NEVER", "_REFINEMENT", "_TOLERANCE", "_DIFFERENCE", "_ONE_SIDED_DIFFERENCE", "_RENEWAL_PART",
                 "_CHAOS_SUSPECTED_ABOVE", "_RESIDUAL_PER_ACCURACY", "_REFINED_COST_RATIO"}


@pytest.mark.parametrize(("printed", "name", "file"), ROWS)
def test_a_threshold_of_the_page_is_that_of_the_code(printed: str, name: str, file: str) -> None:
    module = importlib.import_module("granchain_core." + file.replace("/", "."))
    assert float(printed) == getattr(module, name)


def test_every_row_of_thresholds_is_read() -> None:
    assert len(ROWS) == REGIMES.count(".py` |") > 0


def test_every_number_with_a_name_in_these_files_is_on_the_page() -> None:
    """A new threshold is one that the page does not have yet. Names given together, `A, B = range(2)`, are columns."""
    for file in {file for _, _, file in ROWS}:
        module = importlib.import_module("granchain_core." + file.replace("/", "."))
        named = constants(Path(str(module.__file__)), ast.Name)
        numbers = {name for name in named if isinstance(getattr(module, name), int | float)}
        missing = {name for name in numbers - NO_THRESHOLDS if f"`{name}`" not in REGIMES}
        assert not missing, f"{file}.py: {missing}"


@pytest.mark.parametrize(("accuracy", "noise"), [(1e-8, 1e-7), (1e-5, 1e-6)])
def test_what_run_takes_for_no_change(accuracy: float, noise: float, monkeypatch: pytest.MonkeyPatch) -> None:
    module, seen = importlib.import_module("granchain_core.run.to_accuracy"), []

    def find_period(strobes: np.ndarray, rounding: float) -> Regime:
        seen.append(rounding)
        return Regime.unsettled(len(strobes) - 1)

    monkeypatch.setattr(module, "find_period", find_period)
    module.run(scene("sec2").evolve(N=2, accuracy=accuracy), periods=1, record=1, samples=8)
    assert seen == [pytest.approx(noise)]


def test_the_thresholds_of_a_response_are_those_of_the_code() -> None:
    """docs/orbits.md tells the rule of resonances; every number with a name in its two files is there."""
    text = (ROOT / "docs" / "orbits.md").read_text(encoding="utf-8")
    rows = re.findall(r"\| ([\d./]+) \| `(\w+)` in `([\w/]+)\.py` \|", text)
    assert len(rows) == text.count(".py` |\n") > 0
    for printed, name, file in rows:
        module = importlib.import_module("granchain_core." + file.replace("/", "."))
        assert float(Fraction(printed)) == pytest.approx(getattr(module, name), rel=1e-15)
    assert {name for _, name, file in rows if file == "steady/curve/resonance"} == {
        name for name, value in vars(resonance).items() if name.isupper() and isinstance(value, float)}


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


@pytest.mark.parametrize("page", ["orbits", "branches", "observers", "diagram"])
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
