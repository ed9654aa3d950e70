"""Bifurcation curves in the plane of two knobs agree with multipliers and with the scaling law."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import granchain_core
from granchain_core import BadInput, ComputationError, Scene, State, scene, settle
from granchain_core.bifurcation_continuation import bifurcation_curves
from granchain_core.bifurcation_continuation.continuation import points_of_curve
from granchain_core.bifurcation_continuation.point import BifurcationPoint, bifurcation_point
from granchain_core.parameter_maps import parameter_map

pytestmark = pytest.mark.quick

#: Near a period doubling and a Neimark–Sacker point of sec2's period-1 orbit, and the fold of its 1:5 resonance.
NEAR = {"period_doubling": (508.0, 1), "neimark_sacker": (1226.0, 1), "fold": (1951.0, 5)}


def near(kind: str) -> tuple[Scene, State, int]:
    """Return a scene near such a point, and the state and period of its orbit."""
    frequency, period = NEAR[kind]
    shown = scene("sec2").evolve(f=frequency)
    return shown, granchain_core.orbit(shown, period).state, period


@pytest.fixture(scope="module")
def points() -> dict[str, BifurcationPoint]:
    starts = {kind: near(kind) for kind in NEAR}
    return {kind: bifurcation_point(shown, kind, state, period) for kind, (shown, state, period) in starts.items()}


@pytest.mark.parametrize(("kind", "condition"), [
    ("period_doubling", lambda mu: mu + 1.0), ("fold", lambda mu: mu - 1.0), ("neimark_sacker", lambda mu: abs(mu) - 1.0)])
def test_the_orbit_on_a_bifurcation_curve_has_the_critical_multiplier(points: dict[str, BifurcationPoint], kind: str,
                                                     condition: Callable[[complex], complex]) -> None:
    found = points[kind]
    assert abs(condition(found.multiplier)) <= 1e-6
    shown, start, period = near(kind)
    if kind != "fold":  # at a fold, Newton's method at fixed f has a singular matrix; elsewhere it is an independent check
        orbit = granchain_core.orbit(shown.evolve(f=found.x), period, start)
        assert np.abs(condition(orbit.multipliers)).min() <= 1e-5


def test_beyond_a_period_doubling_the_period_is_two(points: dict[str, BifurcationPoint]) -> None:
    at = points["period_doubling"].x
    assert settle(scene("sec2").evolve(f=at - 3.0)).regime.period == 1
    assert settle(scene("sec2").evolve(f=at + 3.0)).regime.period == 2


@pytest.mark.parametrize(("away", "name"), [(-8.0, "quasi-periodic"), (15.0, "periodic")])
def test_on_one_side_of_a_neimark_sacker_point_the_motion_is_quasi_periodic(
        points: dict[str, BifurcationPoint], away: float, name: str) -> None:
    shown = scene("sec2").evolve(f=points["neimark_sacker"].x + away)
    orbit = granchain_core.orbit(shown, 1)
    assert orbit.stable == (name == "periodic")
    beside = State(1.02 * orbit.state.displacement, orbit.state.velocity)
    assert settle(shown, beside).regime.name == name


def test_beyond_a_fold_the_orbit_does_not_exist(points: dict[str, BifurcationPoint]) -> None:
    at, (shown, start, period) = points["fold"].x, near("fold")
    assert granchain_core.orbit(shown.evolve(f=at - 0.5), period, start).stable
    with pytest.raises(ComputationError, match="found no orbit of 5 drive periods"):
        granchain_core.orbit(shown.evolve(f=at + 5.0), period, start)


def test_a_curve_goes_through_its_rows_and_scales(points: dict[str, BifurcationPoint]) -> None:
    shown, start, period = near("neimark_sacker")
    rows = [3.5e-7, 5e-7, 8e-7]
    curve = points_of_curve(shown, "neimark_sacker", start, rows, period)
    assert [point.y for point in curve] == rows
    assert all(abs(abs(point.multiplier) - 1.0) <= 1e-6 for point in curve)
    assert curve[1].x == pytest.approx(points["neimark_sacker"].x, rel=1e-9)
    # the curve of the scaled chain (A0, f and D differ), point by point
    s = 2.0
    other = shown.scaled(s)
    again = points_of_curve(other, "neimark_sacker", granchain_core.orbit(other, 1).state, [s * row for row in rows], period)
    for a, b in zip(curve, again, strict=True):
        assert b.x == pytest.approx(s**0.25 * a.x, rel=1e-6)  # |μ| is met to 1e-6
        assert abs(b.multiplier.real) == pytest.approx(abs(a.multiplier.real), abs=1e-5)


def test_a_fold_is_followed(points: dict[str, BifurcationPoint]) -> None:
    shown, start, period = near("fold")
    curve = points_of_curve(shown, "fold", start, [4.5e-7, 5e-7], period)
    assert [point.y for point in curve] == [4.5e-7, 5e-7]
    assert abs(curve[0].multiplier - 1.0) <= 1e-6 and curve[0].x < curve[1].x


@pytest.mark.parametrize(("kind", "start", "end", "period"), [
    ("neimark_sacker", 1245.0, 1226.0, 1), ("period_doubling", 508.0, 515.0, 1), ("fold", 1951.0, 1956.0, 5)])
def test_the_point_is_where_the_branch_encloses_one(kind: str, start: float, end: float, period: int) -> None:
    """A branch encloses the change of stability between two orbits; a bifurcation curve finds it by separate secants.
    """
    branch = granchain_core.branch(scene("sec2"), "f", start, end, period)
    [special] = [one for one in branch.special if one.kind == kind]
    begun = branch.points[0]  # 1.4 to 9 Hz from the special point
    found = bifurcation_point(branch.axis.scene_at(begun.knob), kind, branch.state(begun), period)
    low, high = special.interval
    assert high - low < 2e-5 * special.knob
    before, after = (np.abs(one.multipliers[max(special.before.unstable_multipliers, special.after.unstable_multipliers) - 1])
                     for one in (special.before, special.after))
    # the curve's |μ| is 1 to within 1e-6; at a fold, the knob turns, and such an error of μ moves it by its square
    unsure = 0.0 if kind == "fold" else 1e-6 * (high - low) / abs(after - before)
    assert unsure < high - low
    assert low - unsure <= found.x <= high + unsure


def test_wrong_requests_are_one_sentence() -> None:
    shown, start, _ = near("period_doubling")
    with pytest.raises(BadInput, match="Unknown kind of bifurcation curve 'hopf'"):
        bifurcation_point(shown, "hopf", start)
    with pytest.raises(BadInput, match="two different"):
        bifurcation_point(shown, "fold", start, x="f", y="f")
    with pytest.raises(BadInput, match="must begin at a value above 0"):
        bifurcation_point(shown, "fold", start, x="f", y="k")
    with pytest.raises(ComputationError, match=r"lost the branch|No fold was found"):
        bifurcation_point(scene("sec2"), "fold", granchain_core.orbit(scene("sec2")).state)


def test_a_parameter_map_shows_where_its_bifurcation_curves_are() -> None:
    found = parameter_map(scene("sec2"), ("f", np.linspace(480.0, 640.0, 9)), ("A0", [4.5e-7, 5e-7]))
    curves = bifurcation_curves(found, rows=[1])
    told = {(curve.kind, curve.period): curve for curve in curves}
    # period 1 doubles at 512 Hz, and the orbit of period 2 near 572 Hz, into one of period 4 or more
    first = told["period_doubling", 1]
    assert [point.y for point in first.points] == [4.5e-7, 5e-7]
    shown, start, _ = near("period_doubling")
    assert first.points[1].x == pytest.approx(bifurcation_point(shown, "period_doubling", start).x, rel=1e-6)
    assert 0.0 < first.points[1].x - first.points[0].x < 20.0  # f ∝ A0^{1/4} nearly: 13 Hz
    with pytest.raises(BadInput, match="rows are numbers from 0 to 1"):
        bifurcation_curves(found, rows=[2])


def test_a_bifurcation_curve_is_followed_to_where_its_second_knob_is_zero() -> None:
    """Three beads at 1300 Hz are followed from k = 2e4 N/m to a chain without a foundation, whose period doubling a
    branch over D finds as well.
    """
    chain = scene("sec2").evolve(N=3, f=1300.0)
    found = bifurcation_curves(parameter_map(chain, ("D", np.linspace(70.0, 76.0, 5)), ("k", [0.0, 2e4])), rows=[1])
    (curve,) = [one for one in found if one.kind == "period_doubling" and one.period == 1]
    (at_zero,) = [point.x for point in curve.points if point.y == 0.0]
    doublings = [one for one in granchain_core.branch(chain, "D", 76.0, 70.0).special if one.kind == "period_doubling"]
    assert any(min(one.interval) - 1e-5 <= at_zero <= max(one.interval) + 1e-5 for one in doublings)
