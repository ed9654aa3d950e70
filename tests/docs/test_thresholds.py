"""What docs/regimes.md says of regimes are the constants of the code, and no page names a constant that is not there;
the multipliers of two pages are computed.
"""

from __future__ import annotations

import ast
import importlib
import math
import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from documents import ROOT

from granchain_core import orbit, scene
from granchain_core.integrate import methods
from granchain_core.kernels.batch import record
from granchain_core.observe.drift import TRANSLATION
from granchain_core.regime import Regime
from granchain_core.steady import regime_criteria
from granchain_core.steady.curve import resonance
from granchain_core.steady.settling import nearby_orbit, refine_orbit, regime_decisions

MODEL, OBSERVERS, DESIGN, REGIMES, GLOSSARY = (" ".join((ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8").split())
                                     for name in ("model", "observers", "design", "regimes", "glossary"))
#: Rows of the table of thresholds: the number, the constant's name and its file.
ROWS = re.findall(r"\| ([\d.e-]+) \| `(\w+)` in `([\w/]+)\.py` \|", REGIMES)
#: Numbers in the same files that decide no regime: columns of an array, sizes of a record, how a difference is
#: computed, when a run is refined.
NO_THRESHOLDS = {
    "CHECK_PERIOD", "CHECK_DECAY", "CHECK_DISTANCE", "CHECK_COLUMNS", "FINE_PERIOD", "FINE_DECAY", "FINE_FORCES",
    "FINE_ORBITS_BETWEEN", "FINE_EXTRAPOLATIONS", "FINE_COLUMNS", "STROBES_KEPT", "NEVER",
    "_REFINEMENT", "_TOLERANCE", "_DIFFERENCE", "_ONE_SIDED_DIFFERENCE", "_RENEWAL_PART",
    "_CHAOS_SUSPECTED_ABOVE", "_RESIDUAL_PER_ACCURACY", "_REFINED_COST_RATIO"}


def number(value: float) -> str:
    """A power of ten as the pages print it, 5e-4."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


@pytest.mark.parametrize(("printed", "name", "file"), ROWS)
def test_a_threshold_of_the_page_is_that_of_the_code(printed: str, name: str, file: str) -> None:
    module = importlib.import_module("granchain_core." + file.replace("/", "."))
    assert float(printed) == getattr(module, name)


def test_every_row_of_thresholds_is_read_and_the_files_are_all_there() -> None:
    assert len(ROWS) == REGIMES.count(".py` |")
    assert {file for _, _, file in ROWS} == {
        "kernels/strobes/periodicity", "kernels/batch/checks", "steady/regime_criteria", "steady/lyapunov",
        "steady/exponent_measurements", "steady/settling/regime_decisions", "steady/settling/advance", "steady/settling/finite_difference_map",
        "steady/steady_state", "regime", "steady/settling/nearby_orbit", "steady/batch/engine", "integrate/batch", "run/to_accuracy"}


def test_every_number_with_a_name_in_these_files_is_on_the_page() -> None:
    """A new threshold is one that the page does not have yet."""
    for file in {file for _, _, file in ROWS}:
        module = importlib.import_module("granchain_core." + file.replace("/", "."))
        named = constants(Path(str(module.__file__)))
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
    assert "changes at most this large count as none | 1e-12 | 1e-12 | 10 · `accuracy`, at most 1e-6 |" in REGIMES


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


def constants(file: Path) -> set[str]:
    """Names in capitals that a file gives a value at its top level."""
    return {name.id for statement in ast.parse(file.read_text(encoding="utf-8")).body
            if isinstance(statement, ast.Assign | ast.AnnAssign) for name in ast.walk(statement)
            if isinstance(name, ast.Name) and isinstance(name.ctx, ast.Store) and name.id.isupper()}


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


def test_the_caps_of_the_contraction_are_the_pages() -> None:
    def contraction(decay: float | None, multiplier: float | None) -> float:
        return Regime("periodic", 1, decay, None, 1, multiplier=multiplier).contraction

    assert contraction(None, 1.0) == 1.0 - 1e-6 and "at most 1 − 1e-6;" in REGIMES
    assert contraction(1.0, None) == 0.999 and "at most 0.999," in REGIMES
    assert contraction(None, None) == 0.5 and "0.5 where no decay was seen" in REGIMES


def test_two_measurements_agree_as_the_page_says() -> None:
    def measured(mean: float, error: float) -> Regime:
        return Regime("chaotic", None, None, None, 1, (mean, error))

    assert "three combined standard errors or 1e-3, whichever is larger" in REGIMES
    assert regime_criteria.agree(measured(0.1, 0.0), measured(0.1009, 0.0))
    assert not regime_criteria.agree(measured(0.1, 0.0), measured(0.1011, 0.0))
    assert regime_criteria.agree(measured(0.1, 0.03), measured(0.1 + 2.9 * 0.05, 0.04))
    assert not regime_criteria.agree(measured(0.1, 0.03), measured(0.1 + 3.1 * 0.05, 0.04))


def test_the_limit_of_the_return_distance_is_the_pages() -> None:
    """20π/P for P states: five times 2π over half of them."""
    limit = 20 * math.pi / regime_decisions.REMEMBERED
    assert f"below 20π/P ({limit:.2f} for {regime_decisions.REMEMBERED})" in REGIMES
    assert regime_criteria.return_limit(np.zeros((420, 2, 1))) == pytest.approx(20 * math.pi / 420)


def test_the_decisions_the_design_page_names_are_the_codes() -> None:
    assert f"Above {regime_criteria.CLEAR_GROWTH:g} per period one measurement is enough" in DESIGN and f"the last {regime_decisions.REMEMBERED} strobes" in DESIGN
    assert f"give |μ| to about {number(nearby_orbit.UNSURE)}" in DESIGN


def test_the_setting_of_a_refined_orbit_is_the_design_pages() -> None:
    part, most = refine_orbit.INTEGRATION_PART, refine_orbit.LEAST_ACCURATE
    assert (f"{part:g} · accuracy · (1 − r), with the accuracy at most {number(most)} and the contraction factor r, "
            f"is below {number(methods.FIXED_STEP_IS_CHEAPER)}") in DESIGN


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


@pytest.mark.parametrize("page", [OBSERVERS, GLOSSARY], ids=["observers", "glossary"])
def test_the_share_of_a_drift_is_the_pages_and_every_verdict_is_named(page: str) -> None:
    assert f"a share of at least {TRANSLATION:g}" in page
    assert all(f"`{verdict}`" in page for verdict in ("synchronises", "drifts", "breaks down", "neither yet"))
