"""Known regimes: periods 1, 2, 3 and 4 of section 2, and a rig that is irregular where it should be."""

from __future__ import annotations

import numpy as np
import pytest
from tangent_exponents import by_tangents

from granchain_core import State, resonance_curve, run, scene, settle
from granchain_core.integrate import following_setting
from granchain_core.integrate.start import at_phase_0
from granchain_core.steady import regime_criteria
from granchain_core.steady.poincare import iter_section


@pytest.mark.parametrize(("f", "period"), [(340.0, 1), (615.0, 2), (1130.0, 3), (1576.0, 4)])
def test_section_2_from_rest_has_its_periods(f: float, period: int) -> None:
    """On the peaks, there is one push in 1, 2, 3 or 4 periods (docs/lecture.md). The recorded orbit closes on itself,
    within its stated error.
    """
    settled = settle(scene("sec2").evolve(f=f))
    assert (settled.regime.name, settled.regime.period) == ("periodic", period)
    kept = settled.run
    assert len(kept.time) == period * kept.samples + 1
    largest = np.abs(kept.displacement).max()
    # the orbit has the stated error, so its two ends differ by at most twice that
    assert np.abs(kept.displacement[-1] - kept.displacement[0]).max() < 2 * kept.displacement_error * largest
    assert kept.displacement_error < 1e-5


@pytest.mark.parametrize("f", [340.0, 1130.0])
def test_settled_orbit_is_where_a_long_plain_run_ends(f: float) -> None:
    """Extrapolation and relaxation lead to the attractor that the chain reaches by itself."""
    chain = scene("sec2").evolve(f=f, accuracy=1e-7)
    settled = settle(chain)
    n = settled.regime.period
    plain = run(chain, periods=600 * n, record=n, samples=96)
    largest = np.abs(plain.displacement).max()
    # an n-periodic orbit may be shifted by 0 to n − 1 periods
    distance = min(np.abs(np.roll(settled.run.displacement[:-1], 96 * q, axis=0) - plain.displacement[:-1]).max()
                   for q in range(n))
    assert distance < 1e-5 * largest  # a hundred times the accuracy: both have that error, amplified by 1/(1 − |μ|)


def test_the_founded_rig_at_140_hz_is_chaotic() -> None:
    """With κ = 0.001 and f = 140 Hz, the exponent is positive, and the regime contains the evidence."""
    settled = settle(scene("rig").evolve(f=140.0))
    assert settled.regime.name == "chaotic"
    exponent, error = settled.regime.lyapunov
    by_flow, flow_error = by_tangents(settled.run.scene, settled.state, blocks=10, block=12, count=1)
    assert by_flow[0] > 3.0 * flow_error[0]
    # 4, not 3: means over 200 periods of this motion vary by more than their standard errors
    assert abs(exponent - by_flow[0]) < 4.0 * np.hypot(error, flow_error[0])
    assert settled.run.displacement_error is None, "no error may be stated for a chaotic motion"


@pytest.mark.parametrize("f", [45.0, 80.0, 120.0])
def test_the_rig_without_its_foundation_is_not_periodic(f: float) -> None:
    """With κ = 0, it is irregular everywhere from 20 to 160 Hz."""
    assert settle(scene("rig").evolve(f=f, k=0.0)).regime.name != "periodic"


def test_windows_hold_the_largest_changes_oldest_first() -> None:
    """One pass over the record finds the same changes as separate passes for each period; a short record has no
    windows.

    The compiler may divide by the scale in one kernel and multiply by its reciprocal in the other: two roundings.
    """
    strobes = np.random.default_rng(3).standard_normal((regime_criteria.SLOW_RECORD, 2, 3))
    windows = regime_criteria._windows(strobes)
    for n, largest_changes in enumerate(windows, 1):
        each = regime_criteria.changes(strobes, n, 3 * regime_criteria._SLOW_WINDOW)
        np.testing.assert_allclose(largest_changes, each.reshape(3, -1).max(axis=1), rtol=2 * np.finfo(float).eps)
    assert len(windows) == regime_criteria.LONGEST_PERIOD and len(regime_criteria._windows(strobes[1:])) == 0


def test_a_cut_chain_from_rest_comes_to_the_attractor_that_rest_leads_to() -> None:
    """An orbit of period 3 coexists here, and fixed steps, of order 1 with the cut, would lead to it. Period 1 and
    8.1983 N are the results of an independent RK4 with bisected events, at 1500, 6000 and 18,000 steps per period.
    """
    chain = scene("sec2").evolve(N=2, A0=1.533564291882614e-06, D=30.039042891685526, tension="cut",
                                 dissipation="tsuji", k=81388.67421059022, F0=0.028166385379778485)
    point, = resonance_curve(chain, [742.0479417595108]).points
    assert point.regime.period == 1
    assert point.max_output_force == pytest.approx(8.19827, rel=1e-5)
    assert settle(chain.evolve(f=742.0479417595108)).regime.period == 1


def test_a_cut_chain_is_where_a_finer_computation_is_at_its_next_phase_0_and_in_its_section() -> None:
    """Both are computed without a requested accuracy; with fixed steps, they used to be wrong by up to a hundredth."""
    chain = scene("sec2").evolve(N=3, tension="cut", k=2e5, f=1500.0, accuracy=1e-10)
    fine = run(chain, periods=20, record=1, samples=4)
    largest = np.abs(fine.displacement).max()
    carried = at_phase_0(chain, State(fine.displacement[1], fine.velocity[1], 0.25))
    assert np.abs(carried.displacement - fine.displacement[4]).max() < 1e-8 * largest
    section = list(iter_section(chain, None, periods=20, samples=4))[-1]
    assert np.abs(section.displacement[19] - run(chain, periods=19, record=1, samples=4).displacement[:4]).max() < (
        1e-6 * largest)  # a section is kept in single precision


def test_a_cut_chain_that_goes_on_from_its_orbit_stays_there() -> None:
    """The fixed-step method's own orbit has period 6."""
    chain = scene("sec2").evolve(tension="cut", f=550.0)
    again = settle(chain, start=settle(chain).state)
    assert (again.regime.name, again.regime.period) == ("periodic", 2)


def test_changes_within_the_tolerance_of_a_step_are_no_motion() -> None:
    """With error control, an orbit repeats only to the tolerance, with changes that seem to grow."""
    strobes = np.tile([[[1.0], [1.0]], [[-1.0], [-1.0]]], (50, 1, 1))
    strobes[:, 0, 0] += 4e-12 * np.arange(100) / 100 * np.cos(np.arange(100) ** 2)
    regime = regime_criteria.find_period(strobes, rounding=regime_criteria.rounding_of(following_setting(True)))
    assert (regime.name, regime.period, regime.observed_contraction) == ("periodic", 2, None)
    assert regime_criteria.rounding_of(following_setting(False)) == regime_criteria.ROUNDING


def test_the_motion_of_a_cut_chain_without_a_drive_is_known_to_the_accuracy_asked_for() -> None:
    chain = scene("impact").evolve(N=5, tension="cut", dissipation="tsuji", D=30.0, f=2000.0, accuracy=1e-8)
    settled_run, fine = settle(chain).run, run(chain.evolve(accuracy=1e-11), periods=0, record=1, samples=96)
    assert settled_run.displacement_error < 1e-8
    assert np.abs(settled_run.displacement - fine.displacement).max() < 1e-8 * np.abs(fine.displacement).max()


def test_the_example_of_the_documentation_goes_through_its_stages() -> None:
    """docs/regimes.md, "One motion through all stages": it settles so slowly that Newton's method finds its orbit."""
    chain = scene("sec2").evolve(f=615.0)
    settled = settle(chain)
    assert settled.regime.orbit_found_by == "Newton" and settled.regime.observed_contraction is None
    assert settled.regime.sentence == "period 2, orbit found after 400 periods of approach (|μ| 0.9939 per 2 periods)"
    assert settled.run.max_output_force == pytest.approx(1.211561, abs=1e-6)
    point = resonance_curve(scene("sec2"), [615.0]).points[0]
    assert point.regime.orbit_found_by == "extrapolation" and point.regime.period == 2
    assert point.regime.observed_contraction == pytest.approx(0.93, abs=0.02) and point.regime.multiplier is None
