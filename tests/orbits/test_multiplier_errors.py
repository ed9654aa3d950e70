"""The stated errors of multipliers are checked with coarser maps against the finest one, and with an exactly known
derivative.
"""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from app.cli import main
from granchain_core import Orbit, Scene, orbit, scene
from granchain_core.attractor_search.sameness import Candidate
from granchain_core.orbits.branch.point import BranchPoint
from granchain_core.orbits.multiplier_errors import derivative_change, errors_of
from granchain_core.orbits.orbit import sorted_multipliers
from granchain_core.orbits.stroboscopic_map import StroboscopicMap

CHAINS = {"sec2": scene("sec2"), "1:2": scene("sec2").evolve(f=615.0), "fig12-90": scene("fig12-90"),
          "fig12-60": scene("fig12-60"), "one bead": scene("sec2").evolve(N=1, f=900.0)}


@pytest.fixture(scope="module", params=CHAINS)
def known_orbit(request: pytest.FixtureRequest) -> Orbit:
    return orbit(CHAINS[request.param])


def of_a_coarser_map(chain: Scene, exact: Orbit, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return multipliers and stated errors of the same orbit, from a map with this tolerance."""
    coarse = StroboscopicMap(chain, exact.period, tolerance=tolerance)
    x = coarse.inner(coarse.engine.scaled.from_si(exact.state))
    for _ in range(3):
        flow = coarse(x)
        x = x + np.linalg.solve(np.eye(len(x)) - flow.derivative, flow.end - x)
    derivative, state = coarse(x).derivative, coarse.engine.scaled.to_si(coarse.engine.scaled.embed(x))
    change = derivative_change(chain, exact.period, state, derivative, tolerance=tolerance)
    multipliers = sorted_multipliers(derivative)
    return multipliers, errors_of(multipliers, derivative, change)


@pytest.mark.parametrize("tolerance", [1e-10, 1e-11, 1e-12])
def test_multipliers_of_coarser_maps_are_within_their_stated_errors(known_orbit: Orbit, tolerance: float) -> None:
    """Multipliers at 1e-13 serve as exact ones. The bound is also narrow enough to be useful."""
    coarser, errors = of_a_coarser_map(known_orbit.scene, known_orbit, tolerance)
    distances = np.abs(coarser[:, None] - known_orbit.multipliers[None, :])
    by_coarser_map, by_flow = linear_sum_assignment(distances)
    assert np.all(distances[by_coarser_map, by_flow] <= errors[by_coarser_map])
    assert known_orbit.multiplier_errors is not None
    assert known_orbit.multiplier_errors[0] < errors[0] < 1e-3
    assert known_orbit.multiplier_errors.max() < 1e-5


def test_the_error_follows_a_known_change_of_the_derivative() -> None:
    """For a symmetric matrix, whose eigenvectors are orthogonal, it is twice the first-order change."""
    matrix, change = np.diag([0.5, -0.3, 0.1]), 1e-6 * np.diag([1.0, 2.0, 0.0])
    np.testing.assert_allclose(errors_of(np.array([-0.3, 0.5, 0.1]), matrix, change), [4e-6, 2e-6, 0.0], atol=1e-15)


def test_the_error_is_useless_where_two_multipliers_meet() -> None:
    """In a Jordan block, a change ε of the matrix moves the multipliers by √ε, so first order is not valid."""
    errors = errors_of(np.array([0.5, 0.5]), np.array([[0.5, 1.0], [0.0, 0.5]]), np.full((2, 2), 1e-12))
    assert np.all(errors > 1.0)


def test_stability_is_undecided_within_the_error_of_the_leading_multiplier(known_orbit: Orbit) -> None:
    assert known_orbit.stability_certain
    leading = np.append(1.0 + 1e-9, known_orbit.multipliers[1:])
    undecided = replace(known_orbit, multipliers=leading)
    undecided.__dict__["multiplier_errors"] = np.full(len(leading), 1e-8)
    assert not undecided.stability_certain
    assert undecided.stability_words() == "stability not decided (|μ| 1.000000 ± 1e-08)"
    assert undecided.summary()[0] == f"period {known_orbit.period}, {undecided.stability_words()}"
    assert known_orbit.stability_words() in known_orbit.summary()[0] and known_orbit.stability_words() in ("stable", "unstable")
    second = replace(known_orbit, multipliers=np.array([0.99, 0.98, 0.1, 0.1]))
    second.__dict__["multiplier_errors"] = np.array([1e-9, 0.05, 1e-9, 1e-9])
    assert not second.stability_certain  # it is not the largest one, but may be outside
    second.__dict__["multiplier_errors"] = np.array([1e-9, 0.01, 1e-9, 1e-9])
    assert second.stability_certain
    outside = replace(known_orbit, multipliers=np.array([1.2, 1.0, 0.1, 0.1]))
    outside.__dict__["multiplier_errors"] = np.full(4, 0.05)
    assert outside.stability_certain and outside.stability_words() == "unstable"  # one outside is enough
    assert not replace(known_orbit, monodromy=None).stability_certain


def undamped(known_orbit: Orbit, size: float) -> Orbit:
    """Return the orbit without damping, with the leading pair `size` and 1/`size` and all others on the circle."""
    on_circle = np.full(len(known_orbit.multipliers) - 2, 1.0j)
    return replace(known_orbit, scene=known_orbit.scene.evolve(D=0.0), multipliers=np.array([size, *on_circle, 1.0 / size]))


@pytest.mark.parametrize("size", [1.0 - 1e-9, 1.0 + 1e-9])
def test_without_damping_an_orbit_of_a_branch_and_of_newtons_method_are_stable_by_one_rule(known_orbit: Orbit, size: float) -> None:
    """A pair 1 ± 1e-9 counts as on the circle; with damping, 1 + 1e-9 is outside."""
    free = replace(undamped(known_orbit, size), monodromy=None)
    point = BranchPoint(0.0, np.zeros(0), np.zeros(1), 0.0, free.multipliers, 0.0, 0.0, 0.0, np.zeros(0), np.zeros(0), (0.0,), 0.0,
                        np.zeros((0, 4)), damped=False)
    candidate = Candidate(None, np.zeros((1, 2, free.scene.N)), free)  # type: ignore[arg-type]
    assert free.stable and point.stable and not candidate.unstable
    assert free.stability_words() == "stable"  # its errors are not known
    free.__dict__["multiplier_errors"] = np.full(len(free.multipliers), 1e-8)
    assert free.stability_certain and free.stability_words() == "stable"
    free.__dict__["multiplier_errors"] = np.full(len(free.multipliers), 1e-5)
    assert not free.stability_certain
    damped = replace(known_orbit, multipliers=free.multipliers)
    assert not damped.stable and not replace(point, damped=True).stable
    assert not replace(free, multipliers=np.array([1.001, 0.999])).stable


def test_the_command_line_prints_and_saves_the_errors(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["orbit", "sec2", "--set", "N=2", "--observer"]) == 0
    assert capsys.readouterr().out.count("; each to ± ") == 2
    assert main(["orbit", "sec2", "--set", "N=2", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert len(said["multiplier_errors"]) == len(said["multipliers"]) == 4 and said["stability_certain"] is True
