"""What docs/model.md says of regimes are the constants of the code; the multipliers of two pages are computed."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from documents import ROOT

from granchain_core import orbit, scene
from granchain_core.kernels.strobes import periodicity
from granchain_core.steady import regime
from granchain_core.steady.batch import settle as batch
from granchain_core.steady.settling import nearby_orbit, regime_decisions

MODEL, OBSERVERS, DESIGN = (" ".join((ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8").split())
                            for name in ("model", "observers", "design"))
SETTLED = MODEL.partition("what \"settled\" means here")[2].partition("## What the paper states")[0]


def number(value: float) -> str:
    """A power of ten as the pages print it, 5e-4."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"


@pytest.mark.parametrize("said", [
    f"n up to {periodicity.LONGEST_PERIOD} is tested",
    f"below {number(periodicity.SETTLED_DISTANCE)} of the largest displacement and velocity",
    f"up to {regime_decisions._ALWAYS} beads always, up to {nearby_orbit.MOST_BEADS} where",
    f"(above {regime_decisions.CLEAR_DECAY:g} a period)",
    f"gives more than {regime_decisions._CLEAR:g}",
    f"decay per orbit is above {batch._SLOW:g}",
    f"still on its way after {regime_decisions.EXAMINED_AFTER} periods",
    f"three standard errors and above {regime._CHAOTIC:g}",
    f"three standard errors or {number(regime._NEUTRAL)} per period",
    f"standard errors are below {regime.CLEAR_GROWTH:g} and the mean is not above {regime._CHAOTIC:g}",
    f"below 20π/P of the largest motion ({20 * math.pi / regime_decisions.REMEMBERED:.2f} for {regime_decisions.REMEMBERED})",
    f"over three windows of {regime._SLOW_WINDOW} periods",
    f"changes shrink by {100 * (1 - regime._SHRINKS):.0f} % from window to window", f"{regime._SMALL:g} of the motion, and",
    f"none of these within {regime_decisions.MOST_PERIODS} periods, "
    f"{regime_decisions.MOST_PERIODS * regime_decisions._PATIENCE} for a motion that leaves",
    f"enlarged to {100 * nearby_orbit._ENLARGED_TO:.1f} % of the motion",
])
def test_the_thresholds_of_the_model_page_are_the_codes(said: str) -> None:
    assert said in SETTLED


def test_the_limit_of_the_return_distance_is_the_pages() -> None:
    """20π/P for P states: five times 2π over half of them."""
    assert regime.return_limit(np.zeros((420, 2, 1))) == pytest.approx(20 * math.pi / 420)


def test_the_decisions_the_design_page_names_are_the_codes() -> None:
    assert f"a growth of {regime.CLEAR_GROWTH:g}," in DESIGN and f"the last {regime_decisions.REMEMBERED} strobes" in DESIGN
    assert f"give |μ| to about {number(nearby_orbit.UNSURE)}" in DESIGN


@pytest.mark.parametrize(("name", "f", "leading", "pages"), [
    ("fig11-free", 100.0, "4.418", (MODEL, OBSERVERS)), ("fig11-founded", 100.0, "0.760", (MODEL, OBSERVERS)),
    ("fig11-free", 200.0, "−2.212", (MODEL, OBSERVERS)), ("fig11-founded", 200.0, "0.996", (MODEL, OBSERVERS)),
])
def test_the_observers_multipliers_are_the_pages(name: str, f: float, leading: str, pages: tuple[str, ...]) -> None:
    """To the digits that are printed: a real one with its sign, of a pair the modulus."""
    found = orbit(scene(name).evolve(f=f), observer=True).observer_multipliers
    first = complex(found[0])
    value = first.real if first.imag == 0.0 else abs(first)
    assert value == pytest.approx(float(leading.replace("−", "-")), abs=0.6e-3)
    assert all(re.search(re.escape(leading), page) for page in pages)
