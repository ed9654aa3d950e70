"""The criteria of the regimes, number by number: distance, period, exponents, and evidence for a closed curve."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.results.regime import Regime
from granchain_core.steady import regime_criteria

pytestmark = pytest.mark.quick


def turning(rate: float, count: int = 420) -> np.ndarray:
    """Return states (count + 1, 2, 2) of a rotation by the golden angle that shrinks by `rate` per period."""
    turn = (rate * np.exp(2j * np.pi * 0.6180339887498949)) ** np.arange(count + 1)
    return np.stack([np.stack([turn.real, turn.imag], 1), np.stack([turn.imag, -turn.real], 1)], 1)


def test_changes_lost_in_rounding_leave_a_distance() -> None:
    """When a decay by 0.97 falls below a rounding of 1e-7, the stated distance is still 1e-7·0.97/0.03 or more."""
    states = 1.0 + 0.97 ** np.arange(600)[:, None, None] * np.ones((1, 2, 3))
    regime = regime_criteria.find_period(states, rounding=1e-7)
    assert regime.name == "periodic" and regime.observed_contraction == pytest.approx(0.97, abs=0.01)
    assert regime.distance is not None and regime.distance >= 1e-7 * 0.96 / 0.04


def test_a_long_locked_orbit_is_periodic() -> None:
    """States that turn by 5/18 of a circle per period and approach their orbit have period 18, and no closed curve."""
    turns = np.exp(2j * np.pi * 5.0 / 18.0 * np.arange(421)) * (1.0 + 0.1 * 0.9 ** np.arange(421))
    states = np.stack([np.stack([turns.real, turns.imag], 1), np.stack([turns.imag, -turns.real], 1)], 1)
    regime = regime_criteria.find_period(states)
    assert (regime.name, regime.period) == ("periodic", 18)
    assert regime.observed_contraction == pytest.approx(0.9**18, rel=0.1)


def test_growth_within_its_error_is_no_chaos() -> None:
    """A mean exponent of 0.002 ± 0.0045 on a closed curve is no evidence of chaos, but 3σ > 0.01 does not exclude it.
    """
    exponents = np.array([0.015, -0.01, 0.005, -0.005, 0.01, -0.003])
    assert regime_criteria.regime_from_exponents(exponents, 120, turning(1.0), 420).name == "unsettled"
    assert regime_criteria.regime_from_exponents(exponents / 2.0, 120, turning(1.0), 420).name == "quasi-periodic"


@pytest.mark.parametrize(("mean", "error", "periods", "neutral"), [
    (0.0, 0.003, 200, True), (-0.008, 0.003, 600, True), (4e-4, 1e-6, 200, True),  # as on closed curves of section 2
    (0.005, 1e-5, 1200, True), (0.005, 1e-5, 1201, False),                         # a growth by e⁶ may occur once
    (0.0, 0.004, 200, False), (0.005, 0.5, 200, False),                            # too uncertain to exclude chaos
    (0.02, 0.001, 200, False), (-0.02, 0.001, 200, False),                         # clearly something else
])
def test_a_large_standard_error_is_not_neutral(mean: float, error: float, periods: int, neutral: bool) -> None:
    """An exponent is neutral within three standard errors or e⁶ over the record, and below 0.01 per period."""
    assert regime_criteria.is_neutral(mean, error, periods) is neutral


def test_a_growth_that_a_closed_curve_may_show_once_is_no_chaos() -> None:
    """0.01 ± 0.001 per period is a factor e² over 200 periods, and e¹⁰ over 1000."""
    assert not regime_criteria.grows(0.01, 0.001, 200) and regime_criteria.grows(0.01, 0.001, 1000)
    assert not regime_criteria.grows(0.01, 0.004, 1000), "within its error"


def test_an_uncertain_exponent_is_measured_further() -> None:
    """0.02 ± 0.012 on a perfect closed curve is unsettled, and needs more periods; 0.02 ± 0.001 is chaos."""
    swing = np.tile([1.0, -1.0], 5)
    uncertain, sure = 0.02 + 0.03 * swing, 0.02 + 0.003 * swing
    assert regime_criteria.needs_more_periods(uncertain, 400)
    assert not regime_criteria.needs_more_periods(sure, 400) and not regime_criteria.needs_more_periods(-sure, 400)
    regime = regime_criteria.regime_from_exponents(uncertain, 400, turning(1.0), 420)
    error = 0.01 * np.sqrt(regime_criteria.OVERLAP_FACTOR)
    assert regime.name == "unsettled" and regime.lyapunov == (pytest.approx(0.02), pytest.approx(error, rel=1e-12))
    assert regime_criteria.regime_from_exponents(sure, 400, turning(1.0), 420).name == "chaotic"


@pytest.mark.parametrize(("exponents", "name"), [
    (0.3 + 0.01 * np.tile([1.0, -1.0], 5), "chaotic"), (1e-4 * np.tile([1.0, -1.0], 5), "quasi-periodic"),
    (0.004 + 1e-4 * np.tile([1.0, -1.0], 5), "quasi-periodic")])
def test_the_decision_can_be_repeated_from_the_kept_evidence(exponents: np.ndarray, name: str) -> None:
    """The regime contains mean, error and periods of the measurement; 0.004 over 400 periods is below 6/400."""
    regime = regime_criteria.regime_from_exponents(exponents, 400, turning(1.0), 420)
    assert regime.name == name and regime.lyapunov is not None and regime.lyapunov_periods == 400
    assert regime_criteria.grows(*regime.lyapunov, regime.lyapunov_periods) is (name == "chaotic")
    assert regime_criteria.is_neutral(*regime.lyapunov, regime.lyapunov_periods) is (name == "quasi-periodic")


def test_the_evidence_for_a_closed_curve_is_kept() -> None:
    """For the golden rotation, 420 states return to within 2π/210 of their circle, and all windows are alike."""
    regime = regime_criteria.regime_from_exponents(np.array([1e-4, -1e-4, 2e-4, -2e-4]), 400, turning(1.0), 420)
    assert regime.return_limit == pytest.approx(10.0 * np.pi / 210.0)
    assert regime.return_distance is not None and 0.0 < regime.return_distance < 2.0 * np.pi / 210.0
    assert regime.window_ratios is not None and regime.window_ratios == pytest.approx((1.0, 1.0), abs=2e-3)
    creeping = regime_criteria.regime_from_exponents(np.array([-2e-4, -4e-4, -3e-4, -3e-4]), 400, turning(0.9997), 420)
    # the largest change of a window may occur up to about ten periods earlier or later in it: 0.9997^10
    assert creeping.name == "unsettled" and creeping.window_ratios == pytest.approx((0.9997**100,) * 2, abs=5e-3)
    short = regime_criteria.regime_from_exponents(np.array([1e-4, -1e-4]), 400, turning(1.0, 40), 40)
    assert short.name == "unsettled" and short.window_ratios is None


def test_a_spiral_that_creeps_inwards_is_no_closed_curve() -> None:
    """It shrinks by 0.03 % per period: neighbours hardly approach each other, and yet the motion is not settled."""
    exponents = np.array([-2e-4, -4e-4, -3e-4, -3e-4])
    assert regime_criteria.regime_from_exponents(exponents, 400, turning(0.9997), 420).name == "unsettled"
    assert regime_criteria.regime_from_exponents(exponents, 400, turning(1.0), 420).name == "quasi-periodic"


def test_a_drift_is_no_closed_curve() -> None:
    """A section that keeps drifting never returns near itself, whatever its exponent."""
    drifting = turning(1.0) + 0.05 * np.arange(421)[:, None, None]
    assert regime_criteria.regime_from_exponents(np.array([1e-4, -1e-4, 2e-4, -2e-4]), 400, drifting, 420).name == "unsettled"


def test_two_mean_exponents_agree_within_three_combined_standard_errors_or_a_thousandth() -> None:
    def measured(mean: float, error: float) -> Regime:
        return Regime("chaotic", None, None, None, 1, (mean, error))

    assert regime_criteria.agree(measured(0.1, 0.0), measured(0.1009, 0.0))
    assert not regime_criteria.agree(measured(0.1, 0.0), measured(0.1011, 0.0))
    assert regime_criteria.agree(measured(0.1, 0.03), measured(0.1 + 2.9 * 0.05, 0.04))
    assert not regime_criteria.agree(measured(0.1, 0.03), measured(0.1 + 3.1 * 0.05, 0.04))
