"""Floquet modes agree with the matrix exponential and close on themselves, sections agree with runs, and searches find
orbits.
"""

from __future__ import annotations

import itertools
from functools import cache

import numpy as np
import pytest

import granchain_core
from granchain_core import BadInput, Cancelled, ComputationError, LiveChain, Scene, State, scene, settle
from granchain_core.execution.stop import Stop
from granchain_core.orbits import Orbit
from granchain_core.orbits.modes import mode, orbit_section
from granchain_core.orbits.search import least_period_of, search_orbit
from granchain_core.steady.poincare import Section, iter_section, most_periods


@cache
def orbit_of(name: str, **knobs: float) -> Orbit:
    """Return the settled orbit of a scene."""
    return granchain_core.orbit(scene(name).evolve(**knobs))


def section(name: str, periods: int, **knobs: float) -> Section:
    """Return the whole section from rest."""
    *_, last = iter_section(scene(name).evolve(**knobs), None, periods)
    return last


@pytest.mark.parametrize(("name", "knobs"), [
    ("sec2", {}), ("sec2", {"f": 1130.0}), ("rig", {}), ("fig11-free", {}), ("sec2", {"dissipation": "tsuji"}),
])
@pytest.mark.parametrize("rank", [0, 3])
def test_a_mode_is_multiplied_by_its_multiplier_over_a_period(name: str, knobs: dict[str, float], rank: int) -> None:
    orbit = orbit_of(name, **knobs)
    floquet_mode = mode(orbit, rank)
    assert abs(floquet_mode.multiplier) == pytest.approx(abs(orbit.multipliers[rank]), rel=1e-6)
    assert floquet_mode.closure < 1e-6  # measured 2e-9 to 2e-7, for ε = 1e-5 and noise of 1e-13/ε
    first, last = floquet_mode.displacement[0], floquet_mode.displacement[-1]
    assert np.abs(last - floquet_mode.multiplier * first).max() < 1e-5 * np.abs(floquet_mode.displacement).max()
    assert np.abs(floquet_mode.displacement).max() == pytest.approx(1.0)
    assert floquet_mode.displacement.shape == (orbit.period * floquet_mode.samples + 1, orbit.scene.N)


def linear_matrix(chain: Scene) -> np.ndarray:
    """Return A of ẋ = A x for a chain whose contacts are springs 1.5 K √δ0 and dashpots D, with x = (u, v) in SI units.
    """
    n, mass = chain.N, chain.masses()
    joins = np.eye(n + 1, n, -1) - np.eye(n + 1, n)  # overlap of contact c = u_{c-1} − u_c
    spring = 1.5 * chain.contact_stiffness() * np.sqrt(chain.static_overlap())
    stiffness, damping = joins.T @ np.diag(spring) @ joins, chain.D * joins.T @ joins
    return np.block([[np.zeros((n, n)), np.eye(n)], [-stiffness / mass[:, None], -damping / mass[:, None]]])


def test_the_mode_of_a_preloaded_chain_is_that_of_its_linear_equations() -> None:
    # with a strong preload and a tiny drive, the chain is linear up to A0/δ0, and δ(t) = exp(A t) v
    chain = scene("sec2").evolve(F0=50.0, A0=1e-10, N=5, D=20.0, f=2000.0)
    floquet_mode = mode(granchain_core.orbit(chain, period=1), samples=8)
    matrix = linear_matrix(chain)
    values, vectors = np.linalg.eig(matrix)
    # its eigenvalue is the one whose exponential over a period is the multiplier
    place = np.argmin(np.abs(np.exp(values * chain.period) - floquet_mode.multiplier))
    eigenvalue, shape = values[place], vectors[: chain.N, place]
    times = np.arange(9) / 8 * chain.period
    expected = np.exp(eigenvalue * times)[:, None] * shape
    factor = np.vdot(expected, floquet_mode.displacement) / np.vdot(expected, expected)
    assert np.abs(floquet_mode.displacement - factor * expected).max() < 1e-3


def test_a_mode_that_is_not_there_is_refused() -> None:
    with pytest.raises(BadInput, match="nearest valid value is 21"):
        mode(orbit_of("sec2"), 22)


def test_an_orbits_section_is_its_own_points_at_every_phase() -> None:
    orbit = orbit_of("sec2", f=1130.0)
    points = orbit_section(orbit)
    assert (points.periods, points.samples) == (3, 48)
    assert points.points(4, 0)[0] == pytest.approx([orbit.state.displacement[3], orbit.state.velocity[3]], rel=1e-9)
    long = section("sec2", 120, f=1130.0)
    for phase in (0, 12, 37):
        late, own = long.points(7, phase)[-3:], points.points(7, phase)
        size = np.abs(own).max(axis=0)
        # every late point of the fixed-step method is one of the orbit's three, to the fixed-step method's error
        assert max(np.abs((own - one) / size).max(axis=1).min() for one in late) < 1e-3


def test_a_section_is_the_run_sampled_once_a_period() -> None:
    chain = scene("rig").evolve(f=90.0)
    *_, whole_section = iter_section(chain, None, 6)
    record = LiveChain(chain, samples=48).advance(6 * 48)
    for phase in (0, 13):
        expected = np.stack([record.displacement[phase:-1:48, 4], record.velocity[phase:-1:48, 4]], axis=1)
        # two runs of the fixed-step method, the second with half the step
        assert (np.abs(whole_section.points(5, phase) - expected).max(axis=0) < 1e-3 * np.abs(expected).max(axis=0)).all()


def test_a_section_grows_and_earlier_points_stay() -> None:
    pieces = list(iter_section(scene("rig").evolve(f=140.0), None, 300, seconds=0.005))
    assert len(pieces) > 1 and pieces[-1].periods == 300
    for before, after in itertools.pairwise(pieces):
        assert np.array_equal(before.displacement, after.displacement[: before.periods])


def test_a_section_starts_at_the_given_state() -> None:
    state = settle(scene("sec2")).state
    *_, whole_section = iter_section(scene("sec2"), state, 5)
    points = whole_section.points(3, 0)
    assert (np.ptp(points, axis=0) < 1e-3 * np.abs(points).max(axis=0)).all()  # already on the orbit


def test_long_chains_keep_fewer_periods() -> None:
    assert most_periods(scene("sec2"), 48, 1000) == 1000
    assert most_periods(scene("sec2").evolve(N=1000), 48, 1000) == 31


def test_a_search_finds_the_unstable_orbit_that_chaos_passes_by() -> None:
    chain = scene("rig").evolve(f=140.0)
    state = settle(chain).state
    unstable_orbit = search_orbit(chain, 1, state, section("rig", 900, f=140.0).strobes()[400:])
    assert not unstable_orbit.stable and unstable_orbit.residual < 1e-9
    assert orbit_section(unstable_orbit).points(3, 0)[0] == pytest.approx([unstable_orbit.state.displacement[2], unstable_orbit.state.velocity[2]], rel=1e-6)


def test_the_orbit_a_doubling_left_unstable_is_found_from_the_middle() -> None:
    chain = scene("sec2").evolve(f=1576.0)
    followed = orbit_of("sec2", f=1576.0)
    unstable_orbit = search_orbit(chain, 2, followed.state, section("sec2", 200, f=1576.0).strobes()[100:])
    assert followed.period == 4 and followed.stable
    assert unstable_orbit.period < 4 and not unstable_orbit.stable


def test_an_orbit_has_its_least_period() -> None:
    once = orbit_of("sec2")
    assert least_period_of(granchain_core.orbit(once.scene, period=4, start=once.state)) == 1
    assert least_period_of(orbit_of("sec2", f=1130.0)) == 3
    assert search_orbit(once.scene, 2, once.state, np.zeros((0, 2, 11))).period == 1


def test_a_search_without_success_says_where_it_looked() -> None:
    chain = scene("rig").evolve(f=140.0, kappa=0.0)
    state = State(np.full(11, 1e-6), np.zeros(11))
    with pytest.raises(ComputationError, match="no orbit of 1 drive periods from the present state or from 0 places"):
        search_orbit(chain, 1, state, np.zeros((0, 2, 11)))


def test_the_stop_flag_ends_sections_modes_and_searches() -> None:
    stop = Stop()
    stop.set()
    with pytest.raises(Cancelled):
        mode(orbit_of("sec2"), stop=stop)
    with pytest.raises(Cancelled):
        list(iter_section(scene("sec2"), None, 5, stop=stop))
    with pytest.raises(Cancelled):
        search_orbit(scene("sec2"), 1, orbit_of("sec2").state, np.zeros((0, 2, 11)), stop)
