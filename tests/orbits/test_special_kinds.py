"""Kinds of special points on branches with given multipliers, including those that a count misses or that are not
folds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from granchain_core import scene
from granchain_core.orbits import BranchPoint, KnobAxis
from granchain_core.orbits.branch.special import SpecialPoint
from granchain_core.orbits.branch.special_search import special_between

pytestmark = pytest.mark.quick

Multipliers = Callable[[float], list[complex]]
AXIS = KnobAxis.of(scene("sec2").evolve(N=2), "f", 1000.0, 2000.0)


class GivenOrbits:
    """Orbits from 1000 to 1001 Hz, at arclength s from 0 to 1, with given multipliers and a given turning point."""

    def __init__(self, multipliers: Multipliers, turn: float | None = None) -> None:
        self.axis, self.equations, self.multipliers, self.turn = AXIS, self, multipliers, turn
        self.a, self.b = self.at(0.0), self.at(1.0)

    def at(self, s: float) -> BranchPoint:
        knob = 1000.0 + s if self.turn is None else 1000.0 - (s - self.turn) ** 2
        direction = 1.0 if self.turn is None else self.turn - s
        tangent = np.array([0.0, 0.0, 0.0, 0.0, direction])
        values = np.array(sorted(self.multipliers(s), key=abs, reverse=True), dtype=complex)
        return BranchPoint(knob=knob, x=np.zeros(4), tangent=tangent, arclength=s, multipliers=values,
                           max_input_force=1.0, max_output_force=1.0, max_output_force_elastic=1.0,
                           closings=np.zeros(3, dtype=int), slope=np.zeros(4), residuals=(0.0,), liouville_error=0.0,
                           overlap_extrema=np.zeros((0, 4)))

    def careful(self, a: BranchPoint, b: BranchPoint, fraction: float) -> BranchPoint:
        return self.at(a.arclength + fraction * (b.arclength - a.arclength))

    exact = rough = careful

    def made_exact(self, point: BranchPoint) -> BranchPoint:
        return point


def points_between(multipliers: Multipliers, turn: float | None = None) -> list[SpecialPoint]:
    """Return the special points between both ends."""
    return special_between(GivenOrbits(multipliers, turn))  # type: ignore[arg-type]


def test_a_multiplier_that_passes_one_without_a_turn_is_not_called_a_fold() -> None:
    special, = points_between(lambda s: [0.9 + 0.2 * s, 0.5, 0.1, 0.1])
    assert special.kind == "multiplier_one" and special.kind_words == "multiplier +1 without a fold"
    assert special.knob == pytest.approx(1000.5, abs=0.01) and special.multiplier == pytest.approx(1.0, abs=0.01)
    assert special.normal_form is None


def test_a_multiplier_that_passes_one_at_a_turn_is_a_fold() -> None:
    special, = points_between(lambda s: [0.92 + 0.2 * s, 0.5, 0.1, 0.1], turn=0.4)
    assert special.kind == "fold" and special.multiplier == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("doubling", [0.3, 0.62])
def test_a_period_doubling_is_found_though_another_multiplier_comes_back_in_the_same_step(doubling: float) -> None:
    """The number of multipliers outside the unit circle is 1 at both ends."""
    special = points_between(lambda s: [1.05 - 0.1 * s, -1.0 - 0.2 * (s - doubling), 0.1, 0.1])
    kinds = {one.kind: one.knob for one in special}
    assert len(special) == 2 and set(kinds) == {"period_doubling", "multiplier_one"}
    assert kinds["period_doubling"] == pytest.approx(1000.0 + doubling, abs=0.01)
    assert kinds["multiplier_one"] == pytest.approx(1000.5, abs=0.01)


@pytest.mark.parametrize(("more", "fewer", "side"), [(1000.0, 1001.0, "below"), (1001.0, 1000.0, "above")])
@pytest.mark.parametrize("first", ["more", "fewer"])
def test_a_grazing_says_on_which_side_of_the_knob_a_contact_closes_more_often(
        more: float, fewer: float, side: str, first: str) -> None:
    one = replace(GivenOrbits(lambda s: [0.5] * 4).at(0.0), knob=fewer, closings=np.array([1, 1, 0]))
    other = replace(one, knob=more, closings=np.array([1, 2, 0]))
    before, after = (other, one) if first == "more" else (one, other)
    special = SpecialPoint("grazing", 1000.5, (1000.0, 1001.0), before, after, contact=1, gained="open interval")
    assert special.gained_side == side
    turned = replace(special, after=replace(after, tangent=-after.tangent))
    assert turned.gained_side is None  # the branch turns back between the two orbits


def test_two_multipliers_that_pass_within_one_interval_are_two_points() -> None:
    special = points_between(lambda s: [1.05 - 0.1 * s, -1.0 - 0.2 * (s - 0.5), 0.1, 0.1])
    assert sorted(one.kind for one in special) == ["multiplier_one", "period_doubling"]


def test_a_pair_that_becomes_real_outside_is_no_period_doubling() -> None:
    assert points_between(lambda s: [-1.2 + np.emath.sqrt(0.01 * (s - 0.4)), -1.2 - np.emath.sqrt(0.01 * (s - 0.4)), 0.1, 0.1]) == []
