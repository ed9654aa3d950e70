"""Periodic orbits are found by Newton's method, with exact tangents and the multipliers of closed forms and symmetries.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from chains import LAWS
from linear_chain import linear_multipliers

import granchain_core
from app.cli import main
from granchain_core import BadInput, ComputationError, scene
from granchain_core.execution.stop import Stop
from granchain_core.orbits import check_branch
from granchain_core.orbits.stroboscopic_map import StroboscopicMap
from granchain_core.steady.settling.nearby_orbit import orbit_of

pytestmark = pytest.mark.quick

#: Variations of sec2: every damping law, and other terms of the equations.
CHAINS: dict[str, dict[str, object]] = {
    **{law: {"dissipation": law} for law in LAWS}, "founded": {"kappa": 0.001}, "pressed": {"F0": 0.5},
}

#: A chain whose beads are at their rest positions at phase 0, to 3e-8 of their amplitude.
VANISHING = scene("sec2").evolve(N=3, A0=9.787e-8, D=2.0578, kappa=1.835e-3, F0=0.79338, f=84.05)


@pytest.mark.parametrize(("frequency", "period"), [(340.0, 1), (615.0, 2), (1130.0, 3), (1576.0, 4)])
def test_newton_ends_at_the_maps_own_rounding_in_a_few_iterations(frequency: float, period: int) -> None:
    orbit = granchain_core.orbit(scene("sec2").evolve(f=frequency))
    assert orbit.period == period  # docs/lecture.md: the motion that sec2 reaches from rest
    assert orbit.residual <= 1e-11  # the map is computed to about 1e-12
    assert len(orbit.newton_residuals) - 1 <= 4  # quadratic convergence from a settled start
    assert orbit.stable


@pytest.mark.parametrize("name", [*CHAINS, "rigid"])
def test_the_determinant_of_the_derivative_is_liouvilles(name: str) -> None:
    chain = scene("sec2").evolve(**(CHAINS | {"rigid": {"wall": "rigid", "N": 3}})[name])
    stroboscopic_map = StroboscopicMap(chain, 1)
    flow = stroboscopic_map(0.1 * np.random.default_rng(1).standard_normal(2 * chain.N))
    sign, logarithm = np.linalg.slogdet(flow.derivative)
    assert sign > 0
    # ∫ trace is a quadrature of order 8 of a function with kinks at the events, where steps begin and end
    assert logarithm == pytest.approx(flow.log_determinant, rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("name", CHAINS)
def test_every_column_of_the_derivative_is_a_finite_difference_of_the_map(name: str) -> None:
    # Contacts open and close; a missing saltation would show here, but not in the determinant.
    chain = scene("sec2").evolve(f=615.0, N=4, **CHAINS[name])
    stroboscopic_map = StroboscopicMap(chain, 1)
    x = 0.3 * np.random.default_rng(2).standard_normal(2 * chain.N)
    exact = stroboscopic_map(x).derivative
    step = 1e-6  # the central difference errs by step² and by the map's 1e-12/step
    for column in range(len(x)):
        e = np.zeros(len(x))
        e[column] = step
        difference = (stroboscopic_map(x + e).end - stroboscopic_map(x - e).end) / (2 * step)
        assert np.abs(difference - exact[:, column]).max() < 3e-5 * np.abs(exact).max()


def test_a_preloaded_chain_has_the_multipliers_of_its_linear_modes() -> None:
    # With a small drive and a strong preload, every contact is a spring 1.5 K √δ0 and a dashpot D, and the monodromy
    # matrix is the matrix exponential of the linear equations; the drive amplitude changes it by about A0/δ0.
    chain = scene("sec2").evolve(F0=50.0, A0=1e-10, N=5, D=20.0, f=2000.0)
    orbit = granchain_core.orbit(chain, period=1)
    assert np.abs(orbit.multipliers) == pytest.approx(np.abs(linear_multipliers(chain)), rel=1e-4)


def test_an_orbit_is_found_again_with_twice_its_period_and_squared_multipliers() -> None:
    once = granchain_core.orbit(scene("sec2"))
    twice = granchain_core.orbit(scene("sec2"), period=2, start=once.state)
    assert twice.state.displacement == pytest.approx(once.state.displacement, rel=1e-9)
    # steps with which the motion is accurate to 1e-13 give tangents accurate to about 1e-9
    assert np.abs(twice.multipliers) == pytest.approx(np.abs(once.multipliers) ** 2, abs=1e-8)


def test_scaled_chains_have_the_same_multipliers() -> None:
    a, b = granchain_core.orbit(scene("sec2")), granchain_core.orbit(scene("sec2").scaled(7.0))
    assert np.abs(b.multipliers) == pytest.approx(np.abs(a.multipliers), abs=1e-8)


@pytest.mark.parametrize("frequency", [100.0, 200.0])
def test_figure_11_the_observer_needs_the_foundation(frequency: float) -> None:
    free = granchain_core.orbit(scene("fig11-free").evolve(f=frequency), observer=True)
    founded = granchain_core.orbit(scene("fig11-founded").evolve(f=frequency), observer=True)
    assert free.stable and founded.stable
    assert free.observer_multipliers is not None and founded.observer_multipliers is not None
    outside = free.observer_multipliers[np.abs(free.observer_multipliers) > 1.0]
    assert len(outside) == 1 and outside[0].imag == 0.0
    assert np.abs(founded.observer_multipliers).max() < 1.0


def test_a_start_that_leads_to_no_orbit_is_a_failure_with_its_residuals() -> None:
    with pytest.raises(ComputationError, match="residuals were"):
        granchain_core.orbit(scene("rig").evolve(f=140.0, k=0.0), period=1)


def test_a_period_out_of_range_is_refused() -> None:
    with pytest.raises(BadInput, match="nearest valid value is 60"):
        granchain_core.orbit(scene("sec2"), period=99)


def test_the_state_of_an_orbit_returns_after_its_period() -> None:
    orbit = granchain_core.orbit(scene("sec2").evolve(f=1130.0))
    stroboscopic_map = StroboscopicMap(orbit.scene, 3)
    x = stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(orbit.state))
    assert np.abs(stroboscopic_map(x).end - x).max() < 1e-10 * np.abs(x).max()  # the residual, after conversion to SI and back


def test_an_orbit_whose_displacements_vanish_at_phase_0_is_found() -> None:
    """The beads follow a slow drive and pass their rest positions at phase 0, to 3e-8 of their amplitude.

    Relative to the displacements there, rounding kept the residual at 1e-7, and Newton's method was reported to fail.
    """
    orbit = granchain_core.orbit(VANISHING)
    assert orbit.period == 1 and orbit.stable and orbit.residual < 1e-9
    assert orbit.liouville_error is not None and abs(orbit.liouville_error) < 1e-8


def test_the_branch_of_vanishing_displacements_is_found() -> None:
    """Relative to displacements at phase 0, the residual of the seed used to stay at 1e-7, and there was no branch."""
    branch = granchain_core.branch(VANISHING, "f", VANISHING.f, VANISHING.f + 0.5, 1)
    assert branch.half_branches[0].ended == "reached" and check_branch(branch) == []


def test_the_multiplier_of_vanishing_displacements_is_right() -> None:
    """A difference relative to these displacements was below the map's noise, and |μ| was wrong in its third digit."""
    exact = abs(granchain_core.orbit(VANISHING).multipliers[0])
    stroboscopic_map = StroboscopicMap(VANISHING, 1)
    x = stroboscopic_map.inner(stroboscopic_map.engine.scaled.from_si(granchain_core.orbit(VANISHING).state))
    for period in (1, 2):
        settled_orbit = orbit_of(VANISHING, period, x, Stop())
        assert settled_orbit is not None and settled_orbit.period == 1 and settled_orbit.point.residual < 1e-9
        assert settled_orbit.modulus == pytest.approx(exact, abs=1e-4) and settled_orbit.distance_of_motion < 1e-6


def test_period_1_of_a_motion_without_a_period_is_taken_with_a_reason(capsys: pytest.CaptureFixture[str]) -> None:
    """sec2 is quasi-periodic at 1700 Hz; the unstable orbit of period 1 is not the motion from rest."""
    chain = scene("sec2").evolve(f=1700.0)
    orbit = granchain_core.orbit(chain)
    reason = "period 1 was assumed, because the motion from rest is quasi-periodic"
    assert orbit.period == 1 and orbit.period_note == reason and reason in orbit.summary()
    started = granchain_core.orbit(chain, start=orbit.state)
    assert started.period_note == "period 1 was assumed, because a start was given without a period"
    assert granchain_core.orbit(chain, 1, orbit.state).period_note == ""
    assert main(["orbit", "sec2", "--set", "f=1700", "--json"]) == 0
    written, said = capsys.readouterr()
    assert json.loads(written)["period_note"] == reason and reason in said
    assert main(["branch", "sec2", "--knob", "f", "--from", "1700", "--to", "1710", "--points", "2"]) == 0
    assert reason in capsys.readouterr().err


def test_the_period_of_a_settled_motion_needs_no_reason() -> None:
    orbit = granchain_core.orbit(scene("sec2").evolve(N=2, f=2000.0))
    assert orbit.period == 1 and orbit.period_note == ""
