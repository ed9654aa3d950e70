"""The starts of a fit's search, and the curvature of χ² at its end."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import qmc

from granchain_core import Stop, scene
from granchain_core.fitting import Free, search
from granchain_core.fitting.evaluation import Evaluation
from granchain_core.fitting.intervals import profile

#: Slopes of three residuals in two parameters, over the range of each; at ROOT in the unit square, all residuals are 0.
SLOPES, ROOT = np.array([[30.0, 10.0], [0.0, 20.0], [5.0, -8.0]]), np.array([0.4, 0.6])
FREE = (Free("D", 50.0, 150.0), Free("k", 1e3, 1e5))


def enlarged(least: float) -> Any:
    """Return a problem with linear residuals. The logarithm of its variances is `least` at the root and grows from
    there.
    """
    def evaluate(chain: Any, amplitude: Any, stop: Any) -> Evaluation:
        x = np.array([np.log(chain.D / 50.0) / np.log(3.0), np.log(chain.k / 1e3) / np.log(100.0)])
        return Evaluation(SLOPES @ (x - ROOT), least + float(np.abs(x - ROOT) @ [2.0, 0.5]), ("periodic",), x)

    target: Any = SimpleNamespace(evaluate=evaluate, smooth=True)
    return search.Problem(scene("sec2"), target, FREE, Stop(), lambda count: None)


@pytest.mark.parametrize("least", [0.0, 1e-12, 1e-3])
def test_logarithms_of_enlarged_variances_are_left_out_of_the_curvature(least: float) -> None:
    """The slope of their root, L'/(2√L), would be unbounded where no variance is enlarged."""
    covariance = np.linalg.inv(SLOPES.T @ SLOPES)
    expected = covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    np.testing.assert_allclose(enlarged(least).correlation(ROOT), expected, atol=1e-9)


@pytest.mark.parametrize("least", [0.0, 1e-12, 1e-3])
def test_a_profile_first_goes_as_far_as_the_parabola_of_chi_squared_says(least: float) -> None:
    problem = enlarged(least)
    deviation = float(np.sqrt(np.linalg.inv(SLOPES.T @ SLOPES)[0, 0]))
    found = profile(problem, ROOT, 0, 1.0, None, last=True)
    low, high = (np.log(end / 50.0) / np.log(3.0) - ROOT[0] for end in (found.low, found.high))
    # 3 %: the search for an end stops there; the logarithms change it by 2 %
    assert high == pytest.approx(1.96 * deviation, rel=0.05) and low == pytest.approx(-1.96 * deviation, rel=0.05)
    assert len(found.values) == 3  # the first point on either side is the end


def test_later_rounds_of_starts_are_spread_as_the_first() -> None:
    """With twice as many points, there is one in each half of the first intervals, in every coordinate."""
    sequence = qmc.Sobol(2, scramble=False)
    first, second = sequence.random_base2(4), sequence.random(16)
    points = np.concatenate([search._inner_points(part, 2.0**-4) for part in (first, second)])
    for coordinate in (points.T - 0.02) / 0.96:
        np.testing.assert_array_equal(np.sort(np.floor(32.0 * coordinate + 1e-9)), np.arange(32))
