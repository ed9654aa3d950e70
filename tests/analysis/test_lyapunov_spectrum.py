"""The Lyapunov spectrum agrees with multipliers, Liouville's formula, the pairs of a Hamiltonian system, and Benettin's
method.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from granchain_core import BadInput, Cancelled, LyapunovSpectrum, lyapunov_spectrum, orbit, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, fixed_step_setting
from granchain_core.steady.lyapunov import growth_along
from granchain_core.steady.settling.advance import run_until_settled

PERIODS = 200
UNDAMPED = scene("sec2").evolve(N=3, f=1000.0, dissipation="none")


@pytest.fixture(scope="module")
def undamped() -> LyapunovSpectrum:
    return lyapunov_spectrum(UNDAMPED, PERIODS)


def test_on_an_orbit_the_exponents_are_those_of_its_multipliers() -> None:
    """Pairs of complex multipliers rotate, so single exponents oscillate about their mean, within about 1 / PERIODS."""
    chain = scene("sec2").evolve(N=3, f=1200.0)
    found, there = lyapunov_spectrum(chain, PERIODS), orbit(chain)
    assert there.stable
    expected = np.log(np.abs(there.multipliers)) / there.period
    known = min(found.resolved, int((np.abs(there.multipliers) > 1e-10).sum()))
    assert known >= 2
    np.testing.assert_allclose(found.exponents[:known], expected[:known], atol=5.0 / PERIODS * np.ptp(expected[:known]) + 1e-3)
    assert found.dimension == 0.0


@pytest.mark.parametrize("knobs", [
    {"N": 3, "F0": 10.0, "dissipation": "tsuji"}, {"N": 5, "F0": 10.0, "k": 1e5},
    {"N": 3, "F0": 10.0, "k": 1e5, "dissipation": "kuwabara-kono"},
])
@pytest.mark.parametrize("f", [340.0, 1000.0])
def test_stated_errors_hold_on_orbits_with_complex_multipliers(knobs: dict[str, Any], f: float) -> None:
    """If blocks contain whole half turns, their scatter used to be as little as a 150th of the error."""
    chain = scene("sec2").evolve(f=f, **knobs)
    found, of_orbit = lyapunov_spectrum(chain, 200), orbit(chain)
    exact = np.sort(np.log(np.abs(of_orbit.multipliers)) / of_orbit.period)[::-1]
    wrong = np.abs(found.exponents - exact)[: found.resolved]
    assert (wrong <= 3.0 * found.errors[: found.resolved] + 1e-9).all()


def test_the_sum_of_exponents_is_the_mean_trace(undamped: LyapunovSpectrum) -> None:
    """Without damping, volumes are conserved: the trace is 0, and so is the sum, up to rounding and the tolerance of
    1e-13.
    """
    assert undamped.resolved == 6 and undamped.mean_trace == 0.0
    assert undamped.liouville_error is not None and undamped.liouville_error < 1e-9


def test_with_damping_their_sum_is_the_mean_trace_too() -> None:
    found = lyapunov_spectrum(scene("sec2").evolve(N=2, f=1000.0, D=20.0), 60)
    assert found.mean_trace < -0.1 and found.resolved == 4
    assert found.liouville_error is not None and found.liouville_error < 1e-7


def test_exponents_are_in_descending_order(undamped: LyapunovSpectrum) -> None:
    """The table numbers them as ranks, and the dimension adds them up from the largest."""
    for found in (undamped, lyapunov_spectrum(scene("sec2").evolve(N=3, f=1000.0, A0=2e-6), 60)):
        assert np.all(np.diff(found.exponents[:found.resolved]) <= 0.0)


def test_a_hamiltonian_system_has_pairs(undamped: LyapunovSpectrum) -> None:
    apart = undamped.exponents + undamped.exponents[::-1]
    assert np.abs(apart).max() < 3.0 * undamped.errors.max() + 10.0 / PERIODS
    assert undamped.exponents[0] > 3.0 * undamped.errors[0]  # it is chaotic with this drive


def test_the_largest_is_that_of_two_trajectories(undamped: LyapunovSpectrum) -> None:
    """Both computations use the same start, since without damping, the energy grows, and the exponent with it."""
    engine = Engine(UNDAMPED, fixed_step_setting(), 1)
    engine.start(run_until_settled(UNDAMPED, None, None).engine.state)
    engine.periods(50)
    blocks = growth_along(engine, 210)[0][10:].reshape(20, 10).mean(axis=1)
    error = np.hypot(undamped.errors[0], blocks.std(ddof=1) / np.sqrt(len(blocks)))
    assert abs(undamped.exponents[0] - blocks.mean()) < 4.0 * error


def test_without_damping_the_dimension_is_that_of_the_whole_space(undamped: LyapunovSpectrum) -> None:
    assert undamped.dimension is not None and undamped.dimension > 5.9  # 6 if rounding leaves the sum above 0


@pytest.mark.parametrize(("exponents", "resolved", "dimension"), [
    ([0.5, -0.2, -1.0], 3, 2.3), ([0.1, -0.4], 2, 1.25), ([-0.1, -0.2], 2, 0.0), ([0.0, -0.5], 2, 1.0),
    ([0.5, -0.2, -1.0], 2, None), ([0.5, 0.0, -0.5], 3, 3.0), ([-0.2, 0.5, -1.0], 3, 2.3),
])
def test_the_dimension_is_kaplan_and_yorkes(undamped: LyapunovSpectrum, exponents: list[float], resolved: int,
                                            dimension: float | None) -> None:
    found = replace(undamped, exponents=np.array(exponents), resolved=resolved).dimension
    assert found == dimension if dimension is None else found == pytest.approx(dimension, abs=1e-12)


def test_the_dimension_of_a_closed_curve_is_one() -> None:
    """Its largest exponent is 0, so the sign of the measured value is irrelevant."""
    found = lyapunov_spectrum(scene("sec2").evolve(f=1700.0), 400)
    assert found.regime == "quasi-periodic" and abs(found.exponents[0]) < 3.0 * found.errors[0]
    assert found.dimension == 1.0 and found.dimension_range == (1.0, 1.0) and found.dimension_resolved
    assert found.dimension_words() == "1 (closed curve)"


def test_a_torus_that_is_no_closed_curve_has_no_such_dimension(undamped: LyapunovSpectrum) -> None:
    """Two exponents near 0 mean a torus in the section, or a weakly attracting curve."""
    found = replace(undamped, exponents=np.array([0.001, -0.001, -0.5]), errors=np.full(3, 0.002), resolved=3,
                    regime="quasi-periodic")
    assert not found.on_closed_curve and not found.dimension_resolved
    assert found.dimension_words().endswith("more periods show whether it is 1 (closed curve)")
    assert replace(found, errors=np.full(3, 0.0005)).on_closed_curve
    assert not replace(found, errors=np.full(3, 0.0005), regime="chaotic").on_closed_curve


def test_chains_without_a_spectrum_are_refused() -> None:
    for chain, periods, words in ((UNDAMPED, 3, "outside 20 to"), (UNDAMPED.evolve(N=200), 40, "outside 1 to 100"),
                                  (scene("sec2").evolve(tension="cut"), 40, "tension = cut")):
        with pytest.raises(BadInput, match=words):
            lyapunov_spectrum(chain, periods)


def test_the_spectrum_is_cancelled_by_its_stop() -> None:
    stop = Stop()
    stop.set()
    with pytest.raises(Cancelled):
        lyapunov_spectrum(scene("sec2").evolve(N=2), PERIODS, stop=stop)


@pytest.mark.parametrize(("exponents", "errors", "low", "high", "words"), [
    ([-0.1, -0.2], [0.01, 0.01], 0.0, 0.0, "0.000"),              # an orbit is a point, whatever the errors
    ([0.001, -0.2], [0.01, 0.01], 0.0, 1.0 + 0.011 / 0.19, "not resolved, 0.000 to 1.058"),  # zero within its error: a point or a curve
    ([0.1, -0.2], [0.01, 0.01], 1.0 + 0.09 / 0.21, 1.0 + 0.11 / 0.19, "1.500 (1.429 to 1.579)"),
])
def test_the_dimension_has_a_range(undamped: LyapunovSpectrum, exponents: list[float], errors: list[float], low: float,
                                   high: float, words: str) -> None:
    """The range is one standard error down and up; if it depends on the sign of the largest exponent, the dimension is
    not resolved.
    """
    found = replace(undamped, exponents=np.array(exponents), errors=np.array(errors), resolved=2)
    assert found.dimension_range == pytest.approx((low, high))
    assert found.dimension_resolved is not words.startswith("not resolved")
    assert found.dimension_words().partition(":")[0] == words


def test_a_range_that_needs_unknown_exponents_is_not_given(undamped: LyapunovSpectrum) -> None:
    found = replace(undamped, exponents=np.array([0.1, -0.2]), errors=np.zeros(2), resolved=1)
    assert found.dimension_range is None and not found.dimension_resolved
    assert "not known" in found.dimension_words()
