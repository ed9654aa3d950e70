"""Branches satisfy their invariants, and agree with settled motions, symmetries and direct solutions."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

import granchain_core
from granchain_core import BadInput, ComputationError, Scene, State, branch, orbit, run, scene, settle
from granchain_core.orbits import (
    Branch,
    BranchPoint,
    Continuation,
    SpecialPoint,
    begin_branch,
    check_branch,
    switch_to_doubled,
)
from granchain_core.orbits.branch.half_branch import HalfBranch, HalfContinuation

#: Accuracy requested of the settled picture; its orbit then agrees with that of a branch to a few times this.
_ASKED = 1e-8


@pytest.fixture(scope="module")
def folded() -> Branch:
    """sec2 upwards from 340 Hz, through two folds, back and forth, to the first period doubling after them."""
    begun = begin_branch(scene("sec2"), "f", 340.0, 400.0, 1)
    for _ in Continuation(begun):
        if any(s.kind == "period_doubling" for s in begun.special) and not begun.points[-1].stable:
            return begun
    return begun


@pytest.fixture(scope="module")
def doubling() -> Branch:
    """sec2 downwards across two period doublings: between them, at 255.8 and 233.5 Hz, the chain alternates."""
    return granchain_core.branch(scene("sec2"), "f", 262.0, 225.0, 1)


def special_point(branch: Branch, kind: str, number: int = 0) -> SpecialPoint:
    """Return one special point of a kind."""
    return [s for s in branch.special if s.kind == kind][number]


def departure_after_disturbance(branch: Branch, point: BranchPoint, disturbed: float = 1e-4) -> float:
    """Return the relative difference in output force between the orbit and the motion of the slightly disturbed chain.
    """
    state, chain = branch.state(point), branch.axis.scene_at(point.knob).evolve(accuracy=_ASKED)
    start = State(state.displacement * (1.0 + disturbed), state.velocity)
    settled_force = settle(chain, start).run.max_output_force_elastic
    return abs(settled_force / point.max_output_force_elastic - 1.0)


def test_a_branch_goes_through_folds_and_is_right_everywhere(folded: Branch) -> None:
    assert check_branch(folded) == []
    kinds = [s.kind for s in folded.special if s.kind != "grazing"]
    assert kinds == ["fold", "fold", "period_doubling"]
    assert {p.stable for p in folded.points} == {True, False}
    assert len([s for s in folded.special if s.kind == "grazing"]) >= 6


def test_special_points_are_enclosed_narrowly_and_their_multipliers_are_critical(folded: Branch) -> None:
    for s in folded.special:
        assert s.interval[0] <= s.knob <= s.interval[1]
        assert s.interval[1] - s.interval[0] <= 1e-5 * s.knob
        if s.kind != "grazing":
            assert s.multiplier is not None
            assert abs(s.multiplier) == pytest.approx(1.0, abs=2e-2)  # at a fold, |μ| − 1 varies as the root of the width
            assert (s.multiplier.real > 0) == (s.kind == "fold")


def test_a_perturbed_chain_behaves_as_its_stability_says(folded: Branch) -> None:
    """On both sides of each change of stability, it returns to the orbit if this is stable, and leaves it if not."""
    chosen = {}
    for place, s in enumerate(t for t in folded.special if t.kind != "grazing"):
        before = [p for p in folded.points if p.arclength <= s.before.arclength and abs(abs(p.multipliers[0]) - 1) > 0.01]
        after = [p for p in folded.points if p.arclength >= s.after.arclength and abs(abs(p.multipliers[0]) - 1) > 0.01]
        chosen[place] = (before[-1], *after[:1])
    points = [point for pair in chosen.values() for point in pair]
    assert {point.stable for point in points} == {True, False}
    for point in points:  # it returns to the error of a picture's largest force, with 96 samples per period
        departure = departure_after_disturbance(folded, point)
        assert departure < 1e-5 if point.stable else departure > 1e-4


def test_the_folds_are_where_up_and_down_sweeps_jump(folded: Branch) -> None:
    """A motion from the last stable orbit stays near it 0.2 Hz before the fold, and leaves it 0.2 Hz beyond."""
    upper = special_point(folded, "fold")
    sweep = granchain_core.branch(scene("sec2"), "f", 340.0, upper.interval[0] - 0.2, 1)
    edge, state = sweep.points[-1], sweep.state(sweep.points[-1])
    inside = settle(sweep.axis.scene_at(edge.knob), state).run.max_output_force_elastic
    beyond = settle(sweep.axis.scene_at(upper.interval[1] + 0.2), state).run.max_output_force_elastic
    assert inside == pytest.approx(edge.max_output_force_elastic, rel=1e-5)
    assert beyond != pytest.approx(inside, rel=5e-3)
    # the other stable part, after the second fold, exists at the same frequency: hysteresis
    lower = special_point(folded, "fold", 1)
    other = next(p for p in folded.points if p.arclength > lower.after.arclength and p.knob > lower.knob)
    assert other.stable and lower.knob < other.knob < upper.knob


def test_forces_along_an_orbit_are_those_of_a_run(doubling: Branch) -> None:
    for point in (doubling.points[0], doubling.points[-1]):
        chain = doubling.axis.scene_at(point.knob).evolve(accuracy=1e-10)
        recorded = run(chain, periods=0, record=1, samples=8, start=doubling.state(point))
        for name in ("max_input_force", "max_output_force", "max_output_force_elastic"):
            assert getattr(point, name) == pytest.approx(getattr(recorded, name), rel=2e-6)  # the run's own peaks: 1e-6


def test_a_doubling_has_a_doubled_branch_that_leads_to_the_next_one(doubling: Branch) -> None:
    parting, meeting = special_point(doubling, "period_doubling"), special_point(doubling, "period_doubling", 1)
    begun = switch_to_doubled(doubling, parting)
    seed = begun.points[0]
    once = begin_branch(begun.axis.scene, "f", seed.knob, 225.0, 1, begun.state(seed)).points[0]
    # two orbits at one frequency: an unstable one of period 1, and one that alternates about it
    assert begun.period == 2 and seed.stable and not once.stable
    assert np.abs(once.x - seed.x).max() > 1e-3 * np.abs(seed.x).max()
    doubled = Continuation(begun).run()
    assert doubled.half_branches[0].ended == "merged" and "half a period later" in doubled.half_branches[0].reason
    assert check_branch(doubled) == [] and all(p.stable for p in doubled.points)
    last = doubled.special[-1]
    widths = [s.interval[1] - s.interval[0] for s in (last, meeting)]
    assert last.kind == "period_doubling" and last.knob == pytest.approx(meeting.knob, abs=sum(widths))
    assert last.normal_form is None and parting.criticality == "subcritical" and meeting.criticality == "supercritical"
    with pytest.raises(BadInput, match="merges with that of half its period"):
        switch_to_doubled(doubled, last)
    middle = min(doubled.points, key=lambda p: abs(p.knob - 247.0))
    settled_there = settle(doubled.axis.scene_at(middle.knob).evolve(accuracy=_ASKED))
    assert settled_there.regime.period == 2
    assert settled_there.run.max_output_force_elastic == pytest.approx(middle.max_output_force_elastic, rel=1e-5)


def test_doublings_beside_grazings_bound_one_doubled_branch() -> None:
    """The coefficients of the normal forms are in the thousands, so only orbits very near the doubling are found from
    it.
    """
    valley = branch(scene("sec2"), "f", 390.0, 402.0, 1)
    lower, upper = (s for s in valley.special if s.kind == "period_doubling")
    doubled = Continuation(switch_to_doubled(valley, upper)).run()
    assert lower.knob == pytest.approx(396.11, abs=0.01) and upper.knob == pytest.approx(400.917, abs=0.01)
    assert doubled.half_branches[0].ended == "merged" and all(p.stable for p in doubled.points)
    assert doubled.special[-1].knob == pytest.approx(lower.knob, abs=0.01)
    switch_to_doubled(valley, lower)


def test_between_doublings_the_disturbed_chain_leaves_its_orbit(doubling: Branch) -> None:
    for point in doubling.points:
        departure = departure_after_disturbance(doubling, point)
        assert departure < 1e-5 if point.stable else departure > 1e-4


def test_special_points_scale_with_the_chain(doubling: Branch) -> None:
    s, first = 7.0, doubling.points[0]
    state = doubling.state(first)
    start = State(s * state.displacement, s**1.25 * state.velocity)
    other = granchain_core.branch(scene("sec2").scaled(s), "f", s**0.25 * first.knob, s**0.25 * 250.0, 1, start)
    unscaled, scaled = special_point(doubling, "period_doubling"), special_point(other, "period_doubling")
    assert scaled.knob / s**0.25 == pytest.approx(unscaled.knob, rel=1.1e-5)  # the half widths of both intervals


@pytest.mark.parametrize(("knob", "start", "end", "changes"), [
    ("A0", 5e-7, 6e-7, {"f": 2000.0}), ("D", 100.0, 90.0, {"f": 2000.0}), ("k", 0.0, 2e4, {"f": 2000.0}),
    ("kappa", 0.001, 0.003, {"f": 2000.0}), ("F0", 1.0, 2.0, {"f": 2000.0}),
])
def test_every_continuous_knob_can_be_followed(knob: str, start: float, end: float, changes: dict[str, float]) -> None:
    chain = scene("sec2").evolve(N=3, **changes)
    branch = granchain_core.branch(chain, knob, start, end, 1)
    assert branch.half_branches[0].ended == "reached" and check_branch(branch) == []
    last = branch.points[-1]
    direct = orbit(chain.evolve(**{knob: end}), 1, branch.state(last))
    # both are fixed points of the same map to 1e-11; near a grazing, Newton's basins are small, so it starts there
    np.testing.assert_allclose(direct.state.displacement, branch.state(last).displacement, rtol=1e-8)
    assert last.knob == end and branch.points[0].knob == start


def test_a_preloaded_chain_has_no_special_points_at_small_drive() -> None:
    """All contacts stay closed and the chain is nearly linear, so resonances cause no special points."""
    chain = scene("sec2").evolve(F0=50.0, A0=1e-7, N=4)
    branch = granchain_core.branch(chain, "f", 800.0, 1500.0, 1)
    assert branch.special == [] and check_branch(branch) == []
    assert all((p.closings == -1).all() and p.stable for p in branch.points)


def test_beyond_a_torus_point_the_chain_leaves_its_orbit() -> None:
    branch = granchain_core.branch(scene("sec2"), "f", 2010.0, 1940.0, 1)
    assert check_branch(branch) == []
    torus = special_point(branch, "neimark_sacker")
    assert torus.multiplier is not None and torus.multiplier.imag > 0.1
    stable = [p for p in branch.points if p.knob > torus.knob and p.stable][-1]
    unstable = branch.points[-1]
    assert unstable.unstable_multipliers == 2
    assert departure_after_disturbance(branch, stable) < 1e-4 and departure_after_disturbance(branch, unstable) > 1e-3


def closed_loop() -> tuple[Scene, float, int]:
    """Return a chain with an isola, and frequency and period of an orbit on it."""
    return scene("sec2").evolve(N=3, D=40.0), 720.0, 3


def test_an_isola_closes_on_itself() -> None:
    chain, frequency, period = closed_loop()
    branch = granchain_core.branch(chain.evolve(f=frequency), "f", 100.0, 3000.0, period, both=True)
    assert [half.ended for half in branch.half_branches] == ["closed"] and check_branch(branch) == []
    assert "the orbit there is the starting one" in branch.half_branches[0].reason
    assert sum(s.kind == "fold" for s in branch.special) % 2 == 0


def again(begun: Branch) -> Branch:
    """Return a separate branch with the beginning of another one."""
    return replace(begun, half_branches=tuple(HalfBranch(half.direction, list(half.points)) for half in begun.half_branches))


@pytest.fixture(scope="module")
def isola() -> tuple[Branch, HalfBranch]:
    """A branch begun on the isola, and the half-branch that is kept if both are continued alternately."""
    chain, frequency, period = closed_loop()
    begun = begin_branch(chain.evolve(f=frequency), "f", 100.0, 3000.0, period, both=True)
    alternately = Continuation(again(begun))
    for _ in alternately:
        pass
    return begun, alternately.branch.half_branches[0]


@pytest.mark.parametrize("slow", [1, -1])
def test_the_threads_do_not_decide_which_arm_of_an_isola_is_kept(slow: int, isola: tuple[Branch, HalfBranch],
                                                                 monkeypatch: pytest.MonkeyPatch) -> None:
    """The half-branch with fewer orbits is kept, even if it takes longer, as when both are continued alternately."""
    begun, expected = isola
    step = HalfContinuation.__next__

    def slowed(one: HalfContinuation) -> BranchPoint:
        if one.half.direction == slow:
            time.sleep(0.05)
        return step(one)

    monkeypatch.setattr(HalfContinuation, "__next__", slowed)
    kept, = Continuation(again(begun)).run().half_branches
    assert kept.direction == expected.direction
    assert [p.knob for p in kept.points] == [p.knob for p in expected.points]


def test_the_error_for_a_seed_that_is_no_orbit_has_its_residuals() -> None:
    with pytest.raises(ComputationError, match="residuals were"):
        granchain_core.branch(scene("rig"), "f", 140.0, 150.0, 1)
