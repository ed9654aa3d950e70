"""What the regime rests on, number by number: rates, distances, the shortest period, and what is none of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any
from unittest.mock import create_autospec

import numpy as np
import pytest

from granchain_core import resonance_curve, scene, settle
from granchain_core.integrate import Engine, Setting, dop853_setting
from granchain_core.kernels.strobes import periodicity
from granchain_core.results.regime import Regime
from granchain_core.steady import regime_criteria
from granchain_core.steady.batch import jobs_in_batch
from granchain_core.steady.orbit_errors import errors_of_map, errors_of_two_orbits
from granchain_core.steady.regime_criteria import changes
from granchain_core.steady.settling import recording, refine_orbit, single_chain
from granchain_core.steady.settling.advance import run_until_settled
from granchain_core.steady.settling.nearby_orbit import is_almost_periodic
from granchain_core.steady.settling.regime_decisions import Decisions, regime_without_continuing

pytestmark = pytest.mark.quick


def turning(rate: float, count: int = 420) -> np.ndarray:
    """States (count + 1, 2, 2) of a rotation by the golden angle that shrinks by `rate` a period."""
    turn = (rate * np.exp(2j * np.pi * 0.6180339887498949)) ** np.arange(count + 1)
    return np.stack([np.stack([turn.real, turn.imag], 1), np.stack([turn.imag, -turn.real], 1)], 1)


def test_of_two_halves_the_slower_one_tells_the_rate() -> None:
    """Nine changes that fall by 0.8 and then by 0.95 fall by 0.95: what is slow stays."""
    changes = np.cumprod([1.0, *[0.8] * 4, *[0.95] * 4])
    assert periodicity.decay_in(changes, 9, 1) == (pytest.approx(0.95, rel=1e-12), True)


def test_the_shortest_period_is_told() -> None:
    """States that alternate repeat after four periods too; their period is two."""
    states = np.zeros((9, 2, 1))
    states[1::2] = 1.0
    assert periodicity.shortest(states, np.ones(2), 4, 1e-10, 1e-10) == 2


def test_changes_lost_in_rounding_leave_a_distance() -> None:
    """A decay by 0.97 that went below a rounding of 1e-7: the distance left may be 1e-7·0.97/0.03, and is stated."""
    states = 1.0 + 0.97 ** np.arange(600)[:, None, None] * np.ones((1, 2, 3))
    found = regime_criteria.find_period(states, rounding=1e-7)
    assert found.name == "periodic" and found.decay == pytest.approx(0.97, abs=0.01)
    assert found.distance is not None and found.distance >= 1e-7 * 0.96 / 0.04


def test_growth_within_its_error_is_no_chaos() -> None:
    """A mean exponent of 0.002 ± 0.0045 on a closed curve is no evidence of chaos, and 3σ > 0.01 excludes none."""
    exponents = np.array([0.015, -0.01, 0.005, -0.005, 0.01, -0.003])
    assert regime_criteria.regime_from_exponents(exponents, 120, turning(1.0), 420).name == "unsettled"
    assert regime_criteria.regime_from_exponents(exponents / 2.0, 120, turning(1.0), 420).name == "quasi-periodic"


@pytest.mark.parametrize(("mean", "error", "periods", "neutral"), [
    (0.0, 0.003, 200, True), (-0.008, 0.003, 600, True), (4e-4, 1e-6, 200, True),  # as on closed curves of section 2
    (0.005, 1e-5, 1200, True), (0.005, 1e-5, 1201, False),                         # a growth by e⁶ is seen once
    (0.0, 0.004, 200, False), (0.005, 0.5, 200, False),                            # too uncertain to exclude chaos
    (0.02, 0.001, 200, False), (-0.02, 0.001, 200, False),                         # clearly something else
])
def test_a_large_standard_error_is_not_neutral(mean: float, error: float, periods: int, neutral: bool) -> None:
    """Neutral: within three standard errors or e⁶ over the record, and below 0.01 a period."""
    assert regime_criteria.is_neutral(mean, error, periods) is neutral


def test_a_growth_that_a_closed_curve_may_show_once_is_no_chaos() -> None:
    """0.01 ± 0.001 per period is a factor e² over 200 periods, and e¹⁰ over 1000."""
    assert not regime_criteria.grows(0.01, 0.001, 200) and regime_criteria.grows(0.01, 0.001, 1000)
    assert not regime_criteria.grows(0.01, 0.004, 1000), "within its error"


def test_a_long_locked_orbit_is_periodic() -> None:
    """States that turn by 5/18 of a circle a period, and approach their orbit: period 18, not a closed curve."""
    turns = np.exp(2j * np.pi * 5.0 / 18.0 * np.arange(421)) * (1.0 + 0.1 * 0.9 ** np.arange(421))
    states = np.stack([np.stack([turns.real, turns.imag], 1), np.stack([turns.imag, -turns.real], 1)], 1)
    found = regime_criteria.find_period(states)
    assert (found.name, found.period) == ("periodic", 18)
    assert found.decay == pytest.approx(0.9**18, rel=0.1)


def test_a_batch_leaves_long_orbits_to_a_chain_alone() -> None:
    """1087 Hz has an orbit of 18 periods with |μ| 0.3: both ways find it, though a batch looks for 16 at most."""
    chain = scene("sec2").evolve(f=1087.0)
    alone_, (together,) = settle(chain).regime, resonance_curve(chain, [1087.0]).points
    assert (alone_.name, alone_.period) == (together.regime.name, together.regime.period) == ("periodic", 18)


def test_an_approach_slower_than_the_bias_of_a_torus_is_measured_until_it_shows() -> None:
    """Its mean exponent is −0.008 over 220 to 420 periods, which a torus may have; |μ| is 0.8 to 0.9."""
    chain = scene("sec2").evolve(A0=8e-7)
    found = [settle(chain.evolve(f=1226.208)).regime, resonance_curve(chain, [1226.208]).points[0].regime]
    assert [(one.name, one.period) for one in found] == [("periodic", 18)] * 2


def nearly_repeating(change: float) -> np.ndarray:
    """A rotation that repeats after 3 periods up to this relative change."""
    turns = np.exp(1j * (2.0 * np.pi / 3.0 + change / 3.0) * np.arange(421))
    return np.stack([np.stack([turns.real, turns.imag], 1), np.stack([turns.imag, -turns.real], 1)], 1)


@pytest.mark.parametrize(("change", "almost"), [(0.0, True), (5e-4, True), (9e-4, True), (1.2e-3, False), (0.1, False)])
def test_almost_periodic_is_what_changes_by_less_than_a_thousandth(change: float, almost: bool) -> None:
    assert is_almost_periodic(nearly_repeating(change)) is almost


def test_a_slow_passage_on_a_closed_curve_is_not_almost_periodic() -> None:
    """780 Hz of section 2: for some twenty periods the motion hardly moves, and then goes on around the curve."""
    steps = np.where(np.arange(421) < 400, 0.05, 1e-5)
    angle = np.cumsum(steps)
    slow = np.stack([np.stack([np.cos(angle), np.sin(angle)], 1), np.stack([np.sin(angle), -np.cos(angle)], 1)], 1)
    assert changes(slow, 1, 16).max() < 1e-3 and not is_almost_periodic(slow)


def test_a_rotation_or_a_short_record_is_not_almost_periodic() -> None:
    """The golden angle comes back within 2π/(√5·13) after 13 periods; 32 changes over 16 periods need 48 states."""
    assert not is_almost_periodic(turning(1.0)) and not is_almost_periodic(nearly_repeating(0.0)[:47])
    assert is_almost_periodic(nearly_repeating(0.0)[:48])


def test_a_slow_approach_with_a_zero_exponent_is_left_to_a_chain_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 1206.2 to 1206.3 Hz the motion approaches an orbit of 6 periods so slowly that its exponent is
    neutral: without the rule a batch calls it quasi-periodic."""
    frequencies = [1206.2, 1206.22, 1206.28, 1206.3]
    found = [point.regime for point in resonance_curve(scene("sec2"), frequencies).points]
    assert [(one.name, one.period) for one in found] == [("periodic", 6)] * 4
    monkeypatch.setattr(jobs_in_batch, "is_almost_periodic", lambda strobes: False)
    without = [point.regime.name for point in resonance_curve(scene("sec2"), frequencies).points]
    assert "quasi-periodic" in without


def test_an_uncertain_exponent_is_measured_further() -> None:
    """0.02 ± 0.012 on a perfect closed curve is unsettled, and asks for more periods; 0.02 ± 0.001 is chaos."""
    swing = np.tile([1.0, -1.0], 5)
    uncertain, sure = 0.02 + 0.03 * swing, 0.02 + 0.003 * swing
    assert regime_criteria.needs_more_periods(uncertain, 400)
    assert not regime_criteria.needs_more_periods(sure, 400) and not regime_criteria.needs_more_periods(-sure, 400)
    found = regime_criteria.regime_from_exponents(uncertain, 400, turning(1.0), 420)
    assert found.name == "unsettled" and found.lyapunov == (pytest.approx(0.02), pytest.approx(0.01 * np.sqrt(regime_criteria.OVERLAP_FACTOR), rel=1e-12))
    assert regime_criteria.regime_from_exponents(sure, 400, turning(1.0), 420).name == "chaotic"


@pytest.mark.parametrize(("exponents", "name"), [
    (0.3 + 0.01 * np.tile([1.0, -1.0], 5), "chaotic"), (1e-4 * np.tile([1.0, -1.0], 5), "quasi-periodic"),
    (0.004 + 1e-4 * np.tile([1.0, -1.0], 5), "quasi-periodic")])
def test_the_decision_can_be_repeated_from_what_is_kept(exponents: np.ndarray, name: str) -> None:
    """Mean, error and periods of the measurement are in the regime; 0.004 over 400 periods is below 6/400."""
    found = regime_criteria.regime_from_exponents(exponents, 400, turning(1.0), 420)
    assert found.name == name and found.lyapunov is not None and found.lyapunov_periods == 400
    assert regime_criteria.grows(*found.lyapunov, found.lyapunov_periods) is (name == "chaotic")
    assert regime_criteria.is_neutral(*found.lyapunov, found.lyapunov_periods) is (name == "quasi-periodic")


def test_the_evidence_for_a_closed_curve_is_kept() -> None:
    """The golden rotation: 420 states come back within 2π/210 of their circle, and no window differs from the next."""
    found = regime_criteria.regime_from_exponents(np.array([1e-4, -1e-4, 2e-4, -2e-4]), 400, turning(1.0), 420)
    assert found.return_limit == pytest.approx(10.0 * np.pi / 210.0)
    assert found.return_distance is not None and 0.0 < found.return_distance < 2.0 * np.pi / 210.0
    assert found.window_ratios is not None and found.window_ratios == pytest.approx((1.0, 1.0), abs=2e-3)
    creeping = regime_criteria.regime_from_exponents(np.array([-2e-4, -4e-4, -3e-4, -3e-4]), 400, turning(0.9997), 420)
    # the largest change of a window may come some ten periods sooner or later in it: 0.9997^10
    assert creeping.name == "unsettled" and creeping.window_ratios == pytest.approx((0.9997**100,) * 2, abs=5e-3)
    short = regime_criteria.regime_from_exponents(np.array([1e-4, -1e-4]), 400, turning(1.0, 40), 40)
    assert short.name == "unsettled" and short.window_ratios is None


def test_one_chain_and_a_batch_have_the_same_evidence() -> None:
    """1700 Hz, quasi-periodic: the two ways judge records of the same length, up to the end of the exponent."""
    chain = scene("sec2").evolve(f=1700.0)
    alone_, (together,) = settle(chain).regime, resonance_curve(chain, [1700.0]).points
    assert alone_.name == together.regime.name == "quasi-periodic"
    assert alone_.return_limit == together.regime.return_limit == pytest.approx(10.0 * np.pi / 210.0)
    for one in (alone_, together.regime):
        assert one.return_distance is not None and one.return_distance < one.return_limit
        assert one.window_ratios is not None and one.window_ratios[0] <= 1.02 and one.window_ratios[1] >= 0.98


def test_a_spiral_that_creeps_inwards_is_no_closed_curve() -> None:
    """0.03 % a period: neighbours hardly approach, and yet it is on its way."""
    exponents = np.array([-2e-4, -4e-4, -3e-4, -3e-4])
    assert regime_criteria.regime_from_exponents(exponents, 400, turning(0.9997), 420).name == "unsettled"
    assert regime_criteria.regime_from_exponents(exponents, 400, turning(1.0), 420).name == "quasi-periodic"


def test_a_drift_is_no_closed_curve() -> None:
    """A section that goes on and on never comes back near itself, whatever its exponent."""
    drifting = turning(1.0) + 0.05 * np.arange(421)[:, None, None]
    assert regime_criteria.regime_from_exponents(np.array([1e-4, -1e-4, 2e-4, -2e-4]), 400, drifting, 420).name == "unsettled"


def called_as(function: Any, answer: object) -> Any:
    """What answers in place of a function, and can be called only as that can be."""
    return create_autospec(function, return_value=answer)


def test_an_error_of_the_map_moves_its_fixed_point_by_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a tenth of a distance is left after an orbit the settled error is e/(1 − 1/10), where nine tenths are, 10
    e.
    """
    settling = run_until_settled(scene("sec2"), None, None)
    engine = Engine(settling.scene, Setting("rk4-split"), 16)
    engine.start(settling.engine.state)
    monkeypatch.setattr(recording, "refined_orbit", called_as(recording.refined_orbit, (engine, 0.0)))
    stated = []
    for decay in (0.1, 0.9):
        settling.regime = replace(settling.regime, decay=decay, multiplier=None)
        stated.append(recording.recorded_orbit(settling, 16, 0.0, "rest").run.displacement_error)
    assert stated[1] == pytest.approx(9.0 * stated[0], rel=1e-12)


def test_the_forces_of_a_curve_move_as_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same factor 1/(1 − |μ|) for a point of a curve that was settled by itself."""
    settling = run_until_settled(scene("sec2"), None, None)
    monkeypatch.setattr(single_chain, "run_until_settled", called_as(single_chain.run_until_settled, settling))
    refined_orbit = single_chain.refined_orbit
    stated = []
    for modulus in (0.1, 0.9):
        engine = Engine(settling.scene, dop853_setting(1e-6), 1)
        engine.start(settling.engine.state)
        monkeypatch.setattr(single_chain, "refined_orbit", called_as(refined_orbit, (engine, 0.0)))
        settling.regime = replace(settling.regime, multiplier=modulus)
        stated.append(single_chain.settle_to_forces(settling.scene, None, settling.stop).errors)
    assert stated[1] == pytest.approx(9.0 * stated[0], rel=1e-12)


def test_a_chance_agreement_counts_as_the_typical_error_of_the_map() -> None:
    """From one state also the change moves the orbit further; two orbits differ by as much as they are apart."""
    change = np.array([0.0, 1e-6, 1e-3])
    assert errors_of_map(change, 1e-5, 0.9) == pytest.approx([1e-4, 1e-4, 2e-2], rel=1e-12)
    assert errors_of_two_orbits(change, 1e-5, 0.9) == pytest.approx([1e-4, 1e-4, 2e-3], rel=1e-12)


def test_relaxing_ends_where_the_distance_is_small_and_not_the_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """A change c at a decay of 0.99 leaves 99 c, and that is what is returned and held against the accuracy."""
    settling, seen = run_until_settled(scene("sec2"), None, None), []
    real = refine_orbit.changes
    settling.regime = replace(settling.regime, multiplier=0.99)
    monkeypatch.setattr(refine_orbit, "changes", lambda *words: seen.append(real(*words)) or seen[-1])
    _, bound = refine_orbit.refined_orbit(settling, 1e-6)
    assert bound <= 0.3e-6
    assert bound == pytest.approx(99.0 * float(seen[-1][0]), rel=1e-12)


def test_a_motion_that_settles_alternating_has_the_period_of_its_orbit() -> None:
    """The rig at 60 Hz and 11 µm comes to its orbit with μ = −0.92: after 125 periods the bound holds for two periods,
    not yet for one. A claim of two periods is traced back to the orbit, which has one."""
    shown = scene("fig12-60")
    engine = Engine(shown, Setting("rk4-split"), 1)
    engine.start_scaled(np.zeros(2 * shown.N))
    strobes = engine.periods(150)[0]
    claimed = replace(regime_criteria.find_period(strobes), name="periodic", period=2, decay=0.92**2)
    for decided in (Decisions(shown, False).next(engine, strobes, claimed).regime,
                    regime_without_continuing(engine, strobes, claimed)):
        assert decided is not None and (decided.name, decided.period) == ("periodic", 1)
        assert decided.multiplier == pytest.approx(0.92, abs=0.01)
        assert decided.decay is None, "0.92² is the decay over two periods"


def test_the_contraction_of_a_bound_is_capped() -> None:
    """The multiplier, at most 1 − 1e-6; without one the decay, at most 0.9999; 0.5 where none was seen."""
    def contraction(decay: float | None, multiplier: float | None) -> float:
        return Regime("periodic", 1, decay, None, 1, multiplier=multiplier).assumed_contraction

    assert contraction(0.2, 0.9) == 0.9 and contraction(None, 1.0) == 1.0 - 1e-6
    assert contraction(0.2, None) == 0.2 and contraction(1.0, None) == 0.9999
    assert contraction(None, None) == 0.5


def test_two_mean_exponents_agree_within_three_combined_standard_errors_or_a_thousandth() -> None:
    def measured(mean: float, error: float) -> Regime:
        return Regime("chaotic", None, None, None, 1, (mean, error))

    assert regime_criteria.agree(measured(0.1, 0.0), measured(0.1009, 0.0))
    assert not regime_criteria.agree(measured(0.1, 0.0), measured(0.1011, 0.0))
    assert regime_criteria.agree(measured(0.1, 0.03), measured(0.1 + 2.9 * 0.05, 0.04))
    assert not regime_criteria.agree(measured(0.1, 0.03), measured(0.1 + 3.1 * 0.05, 0.04))
