"""Regimes of known sequences of states: linear maps around a point, and the limit of a decaying sequence."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.integrate.batch import change_workspace
from granchain_core.kernels.strobes import periodicity
from granchain_core.kernels.strobes.extrapolation import ORBITS, reduced_rank
from granchain_core.kernels.strobes.periodicity import LONGEST_PERIOD, window_of
from granchain_core.steady import regime_criteria


def strobes(multipliers: list[complex], amplitudes: list[float], count: int, seed: int = 1) -> np.ndarray:
    """Return stroboscopic states (count + 1, 2, 3) of a linear map around a point."""
    rng = np.random.default_rng(seed)
    fixed, modes = rng.standard_normal((2, 3)), rng.standard_normal((len(multipliers), 2, 3))
    k = np.arange(count + 1)
    return fixed + sum(a * np.multiply.outer(np.real(np.asarray(mu, dtype=complex) ** k), m)
                       for mu, a, m in zip(multipliers, amplitudes, modes, strict=True))


@pytest.mark.parametrize("rate", [0.5, 0.9, 0.97])
def test_the_distance_bound_holds_for_a_linear_map(rate: float) -> None:
    """A motion counts as settled only if its true distance to the orbit is below the bound."""
    for count in range(20, 2000, 40):
        states = strobes([rate], [1.0], count)
        found = regime_criteria.find_period(states)
        if found.name == "periodic":
            scale = np.abs(states).max(axis=(0, 2))  # of displacement and of velocity
            true = (np.abs(states[-1] - strobes([rate], [0.0], 0)[0]).max(axis=1) / scale).max()
            assert found.distance is not None and found.period == 1
            assert true <= found.distance <= regime_criteria.SETTLED_DISTANCE
            return
    pytest.fail("never settled")


@pytest.mark.parametrize("longest", [1, 2, 3, LONGEST_PERIOD, regime_criteria.LONGEST_LOCKED_PERIOD])
def test_the_workspace_holds_the_changes_of_every_period(longest: int) -> None:
    assert change_workspace(longest).size == max(window_of(n) for n in range(1, longest + 1))
    assert regime_criteria.find_period(strobes([0.3], [1.0], 60), longest).period == 1


def test_a_slow_approach_is_not_called_settled_by_a_small_change() -> None:
    """With |μ| = 0.9999, a change of 1e-8 per period is a distance of 1e-4 (docs/model.md, Steady states)."""
    assert regime_criteria.find_period(strobes([0.9999], [1e-4], 400)).name == "unsettled"


@pytest.mark.parametrize("period", [2, 3, 4, 7])
def test_roots_of_one_give_their_period(period: int) -> None:
    """A multiplier e^{2πi/n}, whose motion does not decay, gives an orbit of period n."""
    found = regime_criteria.find_period(strobes([np.exp(2j * np.pi / period), 0.3], [1.0, 1.0], 200))
    assert (found.name, found.period) == ("periodic", period)


def test_changes_that_are_rounding_do_not_make_a_period_longer() -> None:
    """A fixed point whose states differ by 3e-12, alternating between three values, has period 1, not 3."""
    states = np.ones((200, 2, 3))
    states[:, 0, 0] += 3e-12 * (np.arange(200) % 3)
    found = regime_criteria.find_period(states)
    assert (found.name, found.period) == ("periodic", 1)


def test_a_closed_curve_is_not_periodic() -> None:
    """An irrational rotation has no period; it is labelled quasi-periodic with a Lyapunov exponent near zero."""
    states = strobes([np.exp(2j * np.pi * (np.sqrt(5) - 1) / 2)], [1.0], 420)
    assert regime_criteria.find_period(states).name == "unsettled"
    assert regime_criteria.regime_from_exponents(np.array([1e-4, -1e-4, 2e-4, -2e-4]), 400, states, 420).name == "quasi-periodic"
    assert regime_criteria.regime_from_exponents(np.array([0.1, 0.11, 0.09, 0.1]), 400, states, 420).name == "chaotic"


@pytest.mark.parametrize("modes", [1, 3, ORBITS - 2])
def test_the_limit_of_a_linear_map_with_few_modes_is_found_at_once(modes: int) -> None:
    """k differences remove k − 1 modes; only the states' rounding over the smallest 1 − μ is left, about 1e-14."""
    states = strobes([0.98 - 0.1 * i for i in range(modes)], [1.0] * modes, ORBITS)
    limit = np.zeros((2, 3))
    reduced_rank(states, np.zeros((ORBITS, 6)), np.zeros((ORBITS, ORBITS)), limit)
    np.testing.assert_allclose(limit, strobes([0.5] * modes, [0.0] * modes, 0)[0], atol=1e-9)


@pytest.mark.quick
def test_the_rate_of_two_halves_is_the_slower_one() -> None:
    """Changes that shrink by 0.8 and later by 0.95 have the rate 0.95, since the slow part remains."""
    changes = np.cumprod([1.0, *[0.8] * 4, *[0.95] * 4])
    assert periodicity.contraction_in(changes, 9, 1) == (pytest.approx(0.95, rel=1e-12), True)


@pytest.mark.quick
def test_the_shortest_period_is_returned() -> None:
    """Alternating states repeat after four periods as well, but their period is two."""
    states = np.zeros((9, 2, 1))
    states[1::2] = 1.0
    assert periodicity.shortest(states, np.ones(2), 4, 1e-10, 1e-10) == 2
