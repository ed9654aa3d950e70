"""Results are one attractor if their states agree after a shift by periods; uncertain forces do not make them one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import granchain_core
from granchain_core import Scene, scene
from granchain_core.attractor_search.sameness import Candidate, merged, with_section
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, dop853_setting
from granchain_core.results.regime import Regime
from granchain_core.scene.state import rest
from granchain_core.steady.settling.single_chain import settle_to_forces
from granchain_core.steady.steady_state import SteadyState

#: Newton's method cannot compute its orbits, so results are compared as they are.
CUT = scene("sec2").evolve(tension="cut")
SECTION = np.random.default_rng(1).uniform(-1.0, 1.0, (2, 2, CUT.N))


def result(section: np.ndarray, error: float) -> Candidate:
    """Return a motion of period 2 with these strobes and this relative error of its forces."""
    regime = Regime("periodic", 2, 0.5, 1e-7, 100)
    return Candidate(SteadyState(CUT, np.ones(3), regime, np.full(3, error), rest(CUT)), section)


def test_the_two_copies_of_a_period_two_orbit_are_one() -> None:
    assert [len(group) for group in merged([result(SECTION, 1e-9), result(SECTION[::-1], 1e-9)])] == [2]


@pytest.mark.parametrize("error", [1e-9, 1e-2, np.inf])
def test_orbits_a_hundredth_apart_are_two_however_large_the_error_of_their_forces(error: float) -> None:
    """An output force of zero has an infinite relative error, which says nothing about the states."""
    assert len(merged([result(SECTION, error), result(SECTION * 1.01, error)])) == 2


def test_states_within_their_stated_errors_are_one() -> None:
    assert len(merged([result(SECTION, 1e-5), result(SECTION * (1.0 + 1e-5), 1e-5)])) == 1


@pytest.mark.parametrize("place", range(3))
def test_the_largest_error_of_the_three_forces_is_that_of_the_states(place: int) -> None:
    """The output force may be more accurate than the states of the other beads."""
    errors = np.full(3, 1e-9)
    errors[place] = 1e-5
    pair = [result(SECTION, 0.0), result(SECTION * (1.0 + 1e-5), 0.0)]
    for one in pair:
        one.result = replace(one.result, errors=errors)
    assert len(merged(pair)) == 1


def closed_curve(states: int, turns: float, first: float, radius: float = 1.0) -> np.ndarray:
    """Return strobes (states, 2, N) of a rotation by `turns` per period on a circle, from the angle `first`."""
    angle = first + 2.0 * np.pi * turns * np.arange(states)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)[:, :, None] * np.ones(CUT.N)


def quasi_periodic(turns: float, first: float, radius: float = 1.0) -> Candidate:
    """Return a motion on that circle, with its longer sections."""
    regime = Regime("quasi-periodic", None, None, None, 400, (1e-4, 1e-4))
    shortest, *longer = (closed_curve(states, turns, first, radius) for states in (400, 1600, 6400))
    return Candidate(SteadyState(CUT, np.ones(3), regime, None, rest(CUT)), shortest,
                 longer={len(section): section for section in longer})


def test_arcs_of_one_closed_curve_are_one_once_they_are_long_enough() -> None:
    """With a rotation by 1/5 + 2e-5, 400 states lie on five arcs of 2.9 degrees each, and 6400 states on arcs of 46
    degrees. Arcs that begin 6 degrees further overlap the long ones, but not the short ones. A circle 5 % larger is a
    different motion.
    """
    one, further = quasi_periodic(0.2 + 2e-5, 0.0), quasi_periodic(0.2 + 2e-5, np.radians(6.0))
    assert len(merged([one, further])) == 1
    assert len(merged([one, quasi_periodic(0.2 + 2e-5, 0.0, 1.05)])) == 2


def test_an_orbit_is_found_from_states_that_are_known_less_well_than_their_forces() -> None:
    """Both are 2e-4 from one stable orbit, on different sides, with forces known to 1e-9: Newton's method joins them.
    """
    chain = scene("sec2").evolve(N=2, f=2000.0)
    orbit = granchain_core.orbit(chain)
    regime = Regime("periodic", 1, 0.5, 1e-7, 100)
    results = [SteadyState(chain, np.ones(3), regime, np.full(3, 1e-9), orbit.state, number=number) for number in (0, 1)]
    near = [replace(with_section(one), section=with_section(one).section * factor) for one, factor in zip(
        results, (1.0 + 2e-4, 1.0 - 2e-4), strict=True)]
    assert len(merged(near)) == 1


@pytest.mark.parametrize(("chain", "period"), [
    (scene("sec2").evolve(N=3, tension="cut", f=2300.0), 2),
    (scene("sec2").evolve(N=2, tension="cut", dissipation="tsuji", f=1241.221241217652, A0=1.533564291882614e-06,
                          D=30.039042891685526, k=81388.67421059022, F0=0.028166385379778485), 4)], ids=["2", "4"])
def test_copies_of_one_cut_orbit_that_begin_in_other_periods_are_one(chain: Scene, period: int) -> None:
    """Newton's method cannot join them, so their sections must be as accurate as their forces. With the cut, fixed
    steps have errors of 1e-3 to 1e-1.
    """
    first = settle_to_forces(chain, None, Stop())
    engine = Engine(chain, dop853_setting(1e-11), 1)
    engine.start(first.state)
    engine.periods(1)
    later = settle_to_forces(chain, engine.state, Stop())
    assert first.regime.period == later.regime.period == period
    assert [len(group) for group in merged([with_section(first), with_section(later)])] == [2]
