"""Regime labels agree with the further course of the motion (a sample of regime_labels.py), and the orbit near a motion
is found.
"""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import orbit, resonance_curve, run, scene, settle
from granchain_core.execution.stop import Stop
from granchain_core.integrate.scaling import scale_chain
from granchain_core.steady.returns import sizes
from granchain_core.steady.settling.advance import run_until_settled
from granchain_core.steady.settling.finite_difference_map import FiniteDifferenceMap, fixed_point
from granchain_core.steady.settling.nearby_orbit import NearbyOrbit, orbit_of
from tests.numerics.regime_labels import judged


@pytest.mark.parametrize(("place", "width"), [(256.0, 0.75), (832.5, 0.25)])
def test_labels_beside_a_period_doubling_are_those_of_the_final_motion(place: float, width: float) -> None:
    """Swept down in steps of 0.25 Hz, the chain lingers on the unstable orbit for hundreds of periods, which is not
    chaos.
    """
    found = list(judged(place, width, 0.25, "down"))
    assert len(found) >= 3
    assert [(one.point.frequency, one.called) for one in found if one.false or one.missing] == []
    assert {one.called for one in found} == {"period 1", "period 2"}


def beside(f: float, period: int, offset: float, **knobs: float) -> NearbyOrbit:
    """Return the orbit found from a state at this relative offset from the exact one."""
    chain = scene("sec2").evolve(f=f, **knobs)
    exact = orbit(chain, period)
    x = FiniteDifferenceMap(chain, period).inner(scale_chain(chain).from_si(exact.state))
    shape = np.random.default_rng(1).standard_normal(len(x))
    found = orbit_of(chain, period, x + offset * sizes(x) * shape, Stop())
    assert found is not None
    return found


@pytest.mark.parametrize(("f", "period"), [(340.0, 1), (1130.0, 3), (1980.0, 1), (1330.0, 1)])
def test_differences_give_the_multipliers_of_the_tangent_flow(f: float, period: int) -> None:
    """Both give the same |μ|, to about what docs/orbits.md ("Error of the map with fixed steps") states."""
    exact = float(np.abs(orbit(scene("sec2").evolve(f=f), period).multipliers[0]))
    assert beside(f, period, 1e-4).modulus == pytest.approx(exact, abs=2e-5)


def test_newtons_method_ends_where_the_tangent_flows_does() -> None:
    """The fixed point of the map with quarter steps agrees with the orbit to the map's error over 1 − |μ|."""
    chain = scene("sec2").evolve(f=340.0)
    stroboscopic_map = FiniteDifferenceMap(chain, 1)
    exact = stroboscopic_map.inner(scale_chain(chain).from_si(orbit(chain, 1).state))
    found = fixed_point(stroboscopic_map, exact + 1e-3 * sizes(exact))
    assert found is not None and found.residual <= 1e-9
    assert np.abs((found.x - exact) / sizes(exact)).max() < 1e-6  # 7e-6 at the default step, /4⁴, over 1 − 0.36: 4e-8


def test_an_orbit_has_its_least_period() -> None:
    """For four periods of a period-1 motion, Newton's method finds that orbit, with the multipliers of one period."""
    chain = scene("sec2").evolve(f=340.0)
    x = FiniteDifferenceMap(chain, 4).inner(scale_chain(chain).from_si(settle(chain).state))
    found = orbit_of(chain, 4, x, Stop())
    assert found is not None and found.period == 1 and found.modulus == pytest.approx(0.361, abs=1e-3)


def test_a_slow_orbit_is_approached_and_an_unstable_one_is_not() -> None:
    """At 1980 Hz, |μ| = 0.99946. At 1330 Hz, |μ| = 1.026, and a departure is amplified only in the growing direction.
    """
    slow, left = beside(1980.0, 1, 1e-4), beside(1330.0, 1, 1e-6)
    assert slow.stable and not slow.unstable and slow.approached()
    assert left.unstable and not left.stable and not left.approached()
    further = left.amplified_departure()
    assert further is not None
    assert np.abs((further - left.point.x) / sizes(left.point.x)).max() == pytest.approx(3e-3, rel=1e-9)
    now, later = (np.linalg.norm((s - left.point.x) / sizes(left.point.x), axis=1).max()
                  for s in left.stroboscopic_map.passed(further, 16, 16))
    assert later / now == pytest.approx(left.modulus**32, rel=0.1)  # over twice 16 orbits, and still nearly linear
    beyond = left.point.x + 1.5 * (further - left.point.x)
    assert NearbyOrbit(left.stroboscopic_map, left.point, beyond, left.modulus).amplified_departure() is None


@pytest.mark.long
def test_a_closed_curve_beside_a_stable_orbit_is_not_that_orbit() -> None:
    """Swept up to 146.42 Hz, the chain stays on a closed curve 0.008 away for 16,000 periods, although |μ| = 0.9993."""
    swept = resonance_curve(scene("sec2"), np.arange(145.92, 146.5, 0.25), "up")
    assert swept.points[-1].regime.name == "quasi-periodic"


@pytest.mark.parametrize("f", [1980.0, 1990.0])
def test_one_motion_has_one_name_from_curve_and_page(f: float) -> None:
    """With |μ| = 0.9995 and 0.9987, both report the orbit, with its multiplier and the same force."""
    chain = scene("sec2").evolve(f=f)
    pictured, drawn = settle(chain), resonance_curve(chain, [f]).points[0]
    assert (pictured.regime.name, pictured.regime.period) == (drawn.regime.name, drawn.regime.period) == ("periodic", 1)
    assert pictured.regime.multiplier == pytest.approx(
        float(np.abs(orbit(chain, 1, pictured.state).multipliers[0])), abs=2e-5)
    assert drawn.force_errors.output is not None and pictured.run.displacement_error is not None
    bound = drawn.force_errors.output + 1.5 * pictured.run.displacement_error  # F ∝ δ^{3/2}
    assert drawn.max_output_force == pytest.approx(pictured.run.max_output_force, rel=bound + 1e-6)


def test_a_slow_approach_is_not_quasi_periodic() -> None:
    """With A0 = 0.3 µm at 1500 Hz, |μ| = 0.9995.

    After 300 periods, the motion looks like a closed curve; `run` labels it unsettled.
    """
    chain = scene("sec2").evolve(A0=3e-7, f=1500.0)
    assert run(chain, periods=300).regime.name == "unsettled"
    settling = run_until_settled(chain, None, None)
    assert (settling.regime.name, settling.regime.period, settling.regime.is_approach) == ("periodic", 1, True)
    assert settling.regime.orbit_found_by == "Newton"
    assert settling.regime.multiplier is not None and 0.999 < settling.regime.multiplier < 1.0
    assert settling.regime.sentence.endswith("(|μ| 0.9995)")
