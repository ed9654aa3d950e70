"""Bifurcation diagrams have as many strobes as the period and the regimes of the resonance curve, and report failures.
"""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import BadInput, Scene, bifurcation_diagram, iter_curve, scene


def test_there_are_as_many_strobes_as_periods() -> None:
    """Section 2's chain from rest has periods 1, 2, 3 and 4 near its first peaks."""
    found = bifurcation_diagram(scene("sec2"), "f", [1130.0, 340.0, 1576.0, 615.0], start="rest", keep=24)
    assert [point.value for point in found.points] == [340.0, 615.0, 1130.0, 1576.0]
    assert [point.regime.period for point in found.points] == [1, 2, 3, 4]
    assert [point.distinct(bead) for point in found.points for bead in (1, 11)] == [1, 1, 2, 2, 3, 3, 4, 4]


@pytest.mark.parametrize("start", ["up", "down"])
def test_a_sweep_finds_the_regimes_of_the_curve(start: str) -> None:
    frequencies = np.linspace(1560.0, 1600.0, 5)
    found = bifurcation_diagram(scene("sec2"), "f", frequencies, start=start, keep=8)
    curve = sorted(iter_curve(scene("sec2"), frequencies, start=start), key=lambda point: point.frequency)
    assert [point.regime.period for point in found.points] == [point.regime.period for point in curve]


def test_the_cloud_has_every_strobe_in_si() -> None:
    found = bifurcation_diagram(scene("sec2").evolve(N=2), "A0", [4e-7, 5e-7], keep=6)
    values, states = found.cloud(2, velocity=True)
    assert values.tolist() == [4e-7] * 6 + [5e-7] * 6
    np.testing.assert_array_equal(states, np.concatenate([point.strobes[:, 1, 1] for point in found.points]))
    assert 0.0 < np.abs(states).max() < 1.0  # [m/s]; the drive moves at some millimetres per second


def test_invalid_diagrams_are_refused() -> None:
    chain = scene("sec2").evolve(N=2)
    for words, message in ((("N", [1.0]), "knob of a bifurcation diagram 'N'"), (("f", []), "1 to 20000 values"),
                           (("f", [-1.0]), "outside"), (("f", [340.0], "sideways"), "start 'sideways'"),
                           (("f", [340.0], "up", 0), "outside 1 to")):
        with pytest.raises(BadInput, match=message):
            bifurcation_diagram(chain, *words)  # type: ignore[arg-type]


CUT = scene("sec2").evolve(N=3, tension="cut", k=2e5)


def test_strobes_of_a_cut_chain_show_no_structure_that_is_not_there() -> None:
    """Both have period 1. Fixed steps, of order 1 with the cut, used to give 58 distinct strobes at 1500 Hz."""
    for point in bifurcation_diagram(CUT, "f", [1250.0, 1500.0], start="rest").points:
        assert point.regime.period == 1 and [point.distinct(bead) for bead in (1, 2, 3)] == [1, 1, 1]


def apart(strobes: np.ndarray, exact: np.ndarray, period: int) -> float:
    """Return the largest relative difference of two orbits' strobes in displacements and velocities, at the best shift.
    """
    one, other = strobes[:period], exact[:period]
    scale = np.abs(other).max(axis=(0, 2), keepdims=True)
    return min(float((np.abs(np.roll(one, k, axis=0) - other) / scale).max()) for k in range(period))


@pytest.mark.parametrize("chain", [scene("sec2").evolve(N=3), CUT], ids=["tension allowed", "tension cut"])
def test_strobes_of_an_orbit_are_known_to_the_error_stated_which_follows_the_accuracy(chain: Scene) -> None:
    frequencies = np.linspace(800.0, 1900.0, 6)
    exact, rough, fine = (bifurcation_diagram(chain.evolve(accuracy=one), "f", frequencies, "rest", 30).points
                          for one in (1e-11, 1e-4, 1e-7))
    compared = 0
    for true, *others in zip(exact, rough, fine, strict=True):
        period = true.regime.period
        if period is not None:
            errors = [one.strobe_error for one in others]
            assert errors[0] is not None and errors[1] is not None
            assert errors[1] < 0.1 * errors[0] and errors[1] < 1e-5
            assert all(apart(one.strobes, true.strobes, period) <= one.strobe_error + true.strobe_error for one in others)
            np.testing.assert_array_equal(true.strobes[period:], true.strobes[:-period])
            compared += 1
    assert compared >= 4


def test_no_error_is_stated_for_a_motion_that_does_not_repeat() -> None:
    found = bifurcation_diagram(scene("sec2"), "f", [1130.0, 1760.0], start="rest", keep=40)
    orbit, other = found.points
    assert other.regime.period is None and other.strobe_error is None and other.distinct(1) > 20
    assert found.attributes()["accuracy_reached"] == orbit.strobe_error
    assert np.isnan(found.tables()[1].columns["strobe_error"].values[1])


def test_an_orbit_that_is_not_known_to_a_thousandth_is_not_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("granchain_core.analysis.bifurcation_diagram.refined_orbit", lambda settling, accuracy: (settling.engine, np.inf))
    point, = bifurcation_diagram(scene("sec2").evolve(N=2), "f", [2000.0], start="rest", keep=5).points
    assert point.regime.period == 1 and point.strobe_error is None and point.strobes.shape == (5, 2, 2)
