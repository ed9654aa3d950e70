"""Verdict and intervals for a straight line, whose distributions are known exactly; no chain is computed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import numpy as np
import pytest
from scipy.stats import f

from granchain_core import Amplitude, Fit, Scene, Stop, fit, scene
from granchain_core.fitting import Free
from granchain_core.fitting.evaluation import Evaluation
from granchain_core.fitting.intervals import limit
from granchain_core.fitting.search import Target

CHAIN = scene("sec2")
AT = np.linspace(-1.0, 1.0, 6)
FREE = [Free("D", 50.0, 150.0)]


@dataclass(frozen=True, eq=False)
class Line:
    """Data on a line with slope D / 100, with errors of 0.1 that are `sigma_known` or not."""

    data: np.ndarray
    sigma_known: bool
    log_variance: float = 0.0
    smooth: bool = True
    error_freedom: int | None = None

    @property
    def frequencies(self) -> np.ndarray:
        return AT

    def where(self, datum: int) -> str:
        return f"at {AT[datum]:g}"

    def evaluate(self, chain: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        model = AT * chain.knobs["D"] / 100.0
        assumed = 0.1 if self.sigma_known else 0.5
        return Evaluation((model - self.data) / assumed, self.log_variance, ("periodic",) * len(AT), model)


def fitted(line: Line) -> Fit:
    return fit(CHAIN, cast(Target, line), FREE, initial_points=8)


def test_the_logarithm_of_a_variance_is_no_evidence_against_the_model() -> None:
    """It only ranks sets of parameters; a sum of squares of 0 is possible with any variance."""
    found = fitted(Line(AT.copy(), True, log_variance=60.0))
    assert found.verdict == "can" and found.probability == pytest.approx(1.0)
    assert found.chi_squared == pytest.approx(0.0, abs=1e-6) and found.misfit == pytest.approx(60.0, abs=1e-6)


@pytest.mark.parametrize("known", [True, False])
def test_intervals_hold_the_truth_in_95_of_100(known: bool) -> None:
    """Of 300 draws, 95 % ± 1.26 % (one standard deviation) do. With χ² instead of F, unknown errors would give 89 %."""
    rng = np.random.default_rng(11)
    held = 0
    for _ in range(300):
        found = fitted(Line(AT + 0.1 * rng.standard_normal(len(AT)), known))
        held += found.profiles[0].low <= 100.0 <= found.profiles[0].high
    assert abs(held / 300 - 0.95) < 3 * 0.0126


def test_the_limit_is_that_of_f_where_the_variance_is_estimated() -> None:
    assert limit(2.0, 5) == pytest.approx(2.0 * f.ppf(0.95, 1, 5)) == pytest.approx(2.0 * 6.608, rel=1e-3)
    assert limit(1.0) == pytest.approx(3.841, rel=1e-3) and limit(1.0, 10**7) == pytest.approx(limit(), rel=1e-5)


def test_errors_estimated_from_repeats_are_uncertain_themselves() -> None:
    """With a standard deviation from repeats (r = 3 degrees of freedom), 1 of 100 true models gets the verdict
    “cannot”.

    More than 5 of 100 have a probability of 5e-4 (binomial). If the errors were treated as exact, there would be about
    20.
    """
    rng, wrong = np.random.default_rng(2), 0
    for _ in range(100):
        told = np.sqrt(rng.chisquare(3) / 3)  # relative to the true one, by which the data scatter
        line = Line(AT + 0.1 / told * rng.standard_normal(len(AT)), True, error_freedom=3)
        wrong += fit(CHAIN, cast(Target, line), FREE, initial_points=2, intervals=False).verdict == "cannot"
    assert wrong <= 5


def test_repeats_widen_the_interval() -> None:
    line = Line(AT.copy(), True, error_freedom=3)
    wide, narrow = fitted(line).profiles[0], fitted(replace(line, error_freedom=None)).profiles[0]
    assert (wide.high - wide.low) / (narrow.high - narrow.low) == pytest.approx(np.sqrt(limit(1.0, 3) / limit()), rel=0.05)
