"""The fast search for special points finds the same points as the careful search, to which it falls back."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core import ComputationError, branch, scene
from granchain_core.orbits import Branch, BranchPoint, SpecialPoint, check_branch
from granchain_core.orbits.branch import special_search
from granchain_core.orbits.branch.between import Between
from granchain_core.orbits.branch.equations import BranchEquations


def followed() -> Branch:
    """Follow a short branch with grazings: sec2 upwards to its first fold."""
    return branch(scene("sec2"), "f", 340.0, 358.55, 1)


def fingerprint(special_points: list[SpecialPoint]) -> list[tuple[object, ...]]:
    """Return kind, contact and gained interval of special points, without their places."""
    return [(one.kind, one.contact, one.gained) for one in special_points]


@pytest.fixture(scope="module")
def fast() -> Branch:
    """The branch as it is normally found."""
    return followed()


@pytest.mark.parametrize("broken", ["solution", "side"])
def test_the_careful_search_finds_the_special_points_of_the_fast_one(fast: Branch, broken: str,
                                                          monkeypatch: pytest.MonkeyPatch) -> None:
    """This happens if a confirmation fails, or is not on the same side as its rough orbit."""
    careful = Between.careful
    used = []

    def no_solution(self: Between, point: object) -> object:
        raise ComputationError("Newton's residuals were 1e-3, 2e-3.", "no-convergence")

    def other_side(self: Between, point: object) -> object:
        return self.b if point is self.a else self.a

    def counted(self: Between, a: BranchPoint, b: BranchPoint, fraction: float) -> BranchPoint:
        used.append(fraction)
        return careful(self, a, b, fraction)

    monkeypatch.setattr(Between, "made_exact", no_solution if broken == "solution" else other_side)
    monkeypatch.setattr(Between, "careful", counted)
    slow = followed()
    assert used and check_branch(slow) == []
    assert fingerprint(slow.special) == fingerprint(fast.special) != []
    for one, other in zip(fast.special, slow.special, strict=True):
        # both intervals contain the point
        assert one.interval[0] <= other.interval[1] and other.interval[0] <= one.interval[1]


def test_the_walks_orbits_do_not_depend_on_the_search(fast: Branch, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("granchain_core.orbits.branch.half_branch.special_between", lambda between: [])
    bare = followed()
    for one, other in zip(fast.points, bare.points, strict=True):
        np.testing.assert_array_equal(one.x, other.x)


def test_the_ends_of_every_interval_are_exact(fast: Branch) -> None:
    """By its residual, each is a fixed point of the exact map, with forces and multipliers of its own."""
    equations = BranchEquations(fast.axis, 1)
    assert fast.special
    for one in fast.special:
        for point in (one.before, one.after):
            flow = equations.stroboscopic_map(point.knob)(point.x)
            assert point.residual <= 1e-10 and np.isfinite(point.max_output_force) and np.isfinite(point.liouville_error)
            mu = np.linalg.eigvals(flow.derivative)
            assert np.abs(mu).max() == pytest.approx(abs(point.multipliers[0]), rel=1e-12)  # the same map: rounding


@pytest.mark.parametrize("knob", ["f", "D", "F0", "k"])
def test_a_map_that_is_used_again_is_a_new_one_to_the_last_bit(knob: str) -> None:
    chain = scene("sec2").evolve(N=3, f=700.0, F0=1.0 if knob == "F0" else 0.0)
    start = {"f": 700.0, "D": 100.0, "F0": 1.0, "k": 0.0}[knob]
    axis = special_search.KnobAxis.of(chain, knob, start, 1.1 * start if start else 1e4)
    equations = BranchEquations(axis, 1)
    x = np.linspace(0.9, -0.4, 6)
    equations.reused_map(axis.end, 1e-9)(x)
    for tolerance in (1e-13, 1e-7):
        new = equations.stroboscopic_map(axis.start, tolerance=tolerance)(x)
        again = equations.reused_map(axis.start, tolerance)(x)
        np.testing.assert_array_equal(again.end, new.end)
        np.testing.assert_array_equal(again.derivative, new.derivative)
        np.testing.assert_array_equal(again.contact_events, new.contact_events)
        assert again.log_determinant == new.log_determinant


def test_nothing_is_searched_between_orbits_that_are_alike(fast: Branch) -> None:
    same = fast.points[0]
    assert special_search._brackets(fast.axis, same, same, None) == []  # type: ignore[arg-type]  # the equations are not used
