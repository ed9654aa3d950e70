"""Which results are one attractor: states that agree after a shift by periods, and nothing that only forces hide."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.diagram.sameness import Found, merged
from granchain_core.regime import Regime
from granchain_core.state import rest
from granchain_core.steady.steady_state import SteadyState

#: Newton's method knows no orbits of it, so that results are compared as they are.
CUT = scene("sec2").evolve(tension="cut")
SECTION = np.random.default_rng(1).uniform(-1.0, 1.0, (2, 2, CUT.N))


def result(section: np.ndarray, error: float) -> Found:
    """A motion of period 2 with these strobes, and this relative error of its forces."""
    regime = Regime("periodic", 2, 0.5, 1e-7, 100)
    return Found(SteadyState(CUT, np.ones(3), regime, np.full(3, error), rest(CUT)), section)


def test_the_two_copies_of_a_period_two_orbit_are_one() -> None:
    assert [len(group) for group in merged([result(SECTION, 1e-9), result(SECTION[::-1], 1e-9)])] == [2]


@pytest.mark.parametrize("error", [1e-9, 1e-2, np.inf])
def test_orbits_a_hundredth_apart_are_two_however_large_the_error_of_their_forces(error: float) -> None:
    """An output force of zero has an infinite relative error, which says nothing of the states."""
    assert len(merged([result(SECTION, error), result(SECTION * 1.01, error)])) == 2


def test_states_within_their_stated_errors_are_one() -> None:
    assert len(merged([result(SECTION, 1e-5), result(SECTION * (1.0 + 1e-5), 1e-5)])) == 1
