"""The fixed-step map that Newton's method uses for branches, and the steps along a branch."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest

from granchain_core import ComputationError, branch, scene
from granchain_core.integrate.scaling import scale_chain
from granchain_core.orbits import Branch, KnobAxis
from granchain_core.orbits.branch import point as points
from granchain_core.orbits.branch import quick
from granchain_core.orbits.branch.equations import BranchEquations
from granchain_core.orbits.branch.steps import LONGEST_STEP, next_step, predicted
from granchain_core.orbits.stroboscopic_map import TOLERANCE, Flow, StroboscopicMap
from granchain_core.steady.returns import relative_change


def followed() -> Branch:
    """Follow a short branch with grazings: sec2 upwards to its first fold."""
    return branch(scene("sec2"), "f", 340.0, 358.55, 1)


@pytest.fixture(scope="module")
def whole() -> Branch:
    """The branch as it is normally found."""
    return followed()


@pytest.mark.parametrize("knob", ["f", "D", "F0", "k", "A0"])
def test_the_quick_map_and_its_slope_are_those_of_the_exact_one(knob: str) -> None:
    start = {"f": 700.0, "D": 100.0, "F0": 1.0, "k": 1e4, "A0": 5e-7}[knob]
    chain = scene("sec2").evolve(N=3, f=700.0, F0=1.0 if knob == "F0" else 0.0, k=1e4)
    equations = BranchEquations(KnobAxis.of(chain, knob, start, 1.2 * start), 1)
    x = np.linspace(0.9, -0.4, 6)
    z = equations.point(x, 1.1 * start)
    steps = equations.quick_steps(z)
    exact = equations.stroboscopic_map(1.1 * start).end(x)
    assert steps > 0
    assert 0.0 < relative_change(equations.quick_end(x, 1.1 * start, steps) - exact, exact) < 1e-6
    slope, checked = equations.quick_slope(z, steps), equations.knob_slope(z, exact, 1e-13)
    np.testing.assert_allclose(slope, checked, atol=5e-5 * np.abs(checked).max())


def test_equal_calls_of_the_quick_map_give_equal_bits() -> None:
    equations = BranchEquations(KnobAxis.of(scene("sec2").evolve(N=3), "f", 340.0, 700.0), 1)
    x = np.linspace(0.9, -0.4, 6)
    first = equations.quick_end(x, 500.0, 800)
    for other, value, steps in ((2.0 * x, 600.0, 1024), (-x, 510.0, 800), (np.nan * x, 505.0, 800)):
        with contextlib.suppress(ComputationError):
            equations.quick_end(other, value, steps)
        np.testing.assert_array_equal(equations.quick_end(x, 500.0, 800), first)


def test_where_fixed_steps_would_be_slow_the_flow_takes_their_place(whole: Branch,
                                                                  monkeypatch: pytest.MonkeyPatch) -> None:
    assert quick.quick_steps(scale_chain(scene("sec2").evolve(f=0.1))) == 0 < quick.quick_steps(scale_chain(scene("sec2")))
    monkeypatch.setattr(quick, "_MOST_QUICK_STEPS", 0)
    monkeypatch.setattr(quick.QuickMap, "end", None)
    slow = followed()
    assert [one.kind for one in slow.special] == [one.kind for one in whole.special] != []
    for one, other in zip(slow.special, whole.special, strict=True):
        assert one.interval[0] <= other.interval[1] and other.interval[0] <= one.interval[1]


@pytest.mark.parametrize("wrong", [1e-6, 1e-4])
def test_orbits_are_right_although_the_quick_map_is_wrong(whole: Branch, wrong: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its defect is measured with the exact map, and only the exact residual decides whether an orbit is accepted."""
    end = BranchEquations.quick_end
    monkeypatch.setattr(BranchEquations, "quick_end",
                        lambda self, x, value, steps: end(self, x, value, steps) + wrong * np.cos(np.arange(len(x))))
    computed = branch(scene("sec2"), "f", 340.0, 341.0, 1)
    equations = BranchEquations(computed.axis, 1)
    assert len(computed.points) > 1
    for one in computed.points:
        assert relative_change(equations.stroboscopic_map(one.knob).end(one.x) - one.x, one.x) <= 1e-10


def test_extrema_of_overlaps_count_the_closings_that_the_flow_counts(whole: Branch) -> None:
    """Rough orbits therefore have the same counts."""
    for one in [*whole.points, *(p for s in whole.special for p in (s.before, s.after))]:
        np.testing.assert_array_equal(points._counted_extrema(len(one.closings), one.overlap_extrema), one.closings)


def test_contacts_that_never_open_or_never_close_have_their_own_counts() -> None:
    extrema = np.array([[0, 1, 0.1, 0.5], [0, -1, 0.2, 0.3], [1, 1, 0.1, -0.5], [1, -1, 0.2, -0.7],
                        [2, 1, 0.1, 0.2], [2, -1, 0.2, -0.2], [2, 1, 0.3, 0.1], [2, -1, 0.4, -0.3]])
    assert points._counted_extrema(3, extrema).tolist() == [-1, 0, 2]


def test_a_branch_that_comes_back_to_the_least_value_of_its_knob_ends_there() -> None:
    """At that value, the knob cannot decrease further, although its coordinate can."""
    computed = branch(scene("sec2"), "k", 0.0, 1e5, 1, most_points=100)
    assert computed.half_branches[0].ended == "returned" and computed.points[-1].knob == 0.0
    assert (computed.column("knob")[1:-1] > 0.0).all()


def test_the_prediction_is_exact_on_a_parabola() -> None:
    def at(s: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([s, 0.1 * s * s]), np.array([1.0, 0.2 * s])

    (z, tangent), before = at(0.0), at(-0.01)
    np.testing.assert_allclose(predicted(0.02, z, tangent, before), at(0.02)[0], atol=1e-6)
    np.testing.assert_allclose(predicted(0.02, z, tangent, None), [0.02, 0.0])


def test_steps_follow_the_turn_and_the_distance_from_the_prediction() -> None:
    straight, turned = 1.0, float(np.cos(np.radians(16.0)))
    assert next_step(0.01, 0.0, straight, failed=False) == pytest.approx(0.02)
    assert next_step(0.01, 0.0, straight, failed=True) == pytest.approx(0.01)
    assert next_step(0.01, 0.0, turned, failed=False) == pytest.approx(0.005)
    assert next_step(0.01, 0.01 * 0.04, straight, failed=False) == pytest.approx(0.01 / np.sqrt(2.0))
    assert next_step(0.01, 0.003, turned, failed=True) == pytest.approx(0.005)
    assert next_step(LONGEST_STEP, 0.0, straight, failed=False) == LONGEST_STEP


def test_an_orbit_needs_one_exact_derivative(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the defect, the last steps would need more derivatives to reach the same orbits."""
    exact, call = [], StroboscopicMap.__call__

    def counted(self: StroboscopicMap, x: np.ndarray) -> Flow:
        exact.append(self.tolerance == TOLERANCE)
        return call(self, x)

    monkeypatch.setattr(StroboscopicMap, "__call__", counted)
    computed = followed()
    orbits = len(computed.points) + len({id(p) for s in computed.special for p in (s.before, s.after)} - {
        id(p) for p in computed.points})
    assert orbits > 10 and sum(exact) < 1.8 * orbits  # including the seed and the settled start
