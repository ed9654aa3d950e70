"""The criticality of a branch's special points agrees with the doubled orbits and closed curves that begin there."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

import granchain_core
from app.cli.branch import branch_json, normal_form_words
from app.plots.branches import criticality_words
from granchain_core import BadInput, scene, settle
from granchain_core.hdf5 import seal
from granchain_core.orbits import Branch, Continuation, SpecialPoint, switch_to_doubled
from granchain_core.orbits.branch.between import Between
from granchain_core.orbits.branch.criticality import same_sequence, with_normal_forms
from granchain_core.orbits.branch.equations import BranchEquations
from granchain_core.orbits.branch.newton import Near
from granchain_core.orbits.branch.normal_forms import (
    AMPLITUDES,
    EARLIER_REASONS,
    REASONS,
    SEQUENCE_IN_INTERVAL,
    SEQUENCE_NEAR,
    NormalForm,
)
from granchain_core.orbits.branch.orbit_checkpoints import special_as_json, special_from_json
from granchain_core.orbits.branch.switch import doubling_direction
from granchain_core.orbits.orbit import sorted_multipliers
from granchain_core.store import load_branch, save_branch


@pytest.fixture(scope="module")
def doubling() -> Branch:
    """sec2 across two period doublings at 255.8 and 233.5 Hz."""
    return granchain_core.branch(scene("sec2"), "f", 262.0, 225.0, 1)


@pytest.fixture(scope="module")
def torus() -> Branch:
    """sec2 across a Neimark–Sacker point at 1973.2 Hz."""
    return granchain_core.branch(scene("sec2"), "f", 1990.0, 1945.0, 1)


def special_point(branch: Branch, kind: str, number: int = 0) -> SpecialPoint:
    """Return one special point of a kind."""
    return [s for s in branch.special if s.kind == kind][number]


@pytest.mark.parametrize(("number", "criticality"), [(0, "subcritical"), (1, "supercritical")])
def test_the_doubled_orbit_is_on_the_side_that_the_criticality_says(doubling: Branch, number: int, criticality: str) -> None:
    """The orbit is found at amplitude γ along η by Newton's method on the doubled map, without normal forms."""
    special = special_point(doubling, "period_doubling", number)
    form = special.normal_form
    assert form is not None and form.criticality == criticality
    once, twice = BranchEquations(doubling.axis, 1), BranchEquations(doubling.axis, 2)
    foot, amplitude = special.before, 2e-4
    away = np.append(doubling_direction(once, foot.x, foot.knob), 0.0)
    solved = twice.solve(once.point(foot.x, foot.knob) + amplitude * away, away)
    unstable = special.before if special.before.unstable_multipliers > special.after.unstable_multipliers else special.after
    beyond = (twice.value(solved.z) - special.knob) * (unstable.knob - special.knob) > 0.0
    assert abs(twice.value(solved.z) - special.knob) > 0.5 * (special.interval[1] - special.interval[0])
    assert beyond == (criticality == "supercritical")
    # (−1 − β + 3cγ²)² with β = cγ²; at 255.8 Hz, the next order in γ is a sixth of it
    leading = sorted_multipliers(solved.flow.derivative)[0].real
    assert (leading < 1.0) == beyond
    assert (1.0 - leading) / (4.0 * amplitude**2) == pytest.approx(form.coefficient, rel=0.25)


def test_a_subcritical_doubling_has_hysteresis(doubling: Branch) -> None:
    """The doubled branch, followed from its supercritical end, folds back above the subcritical one."""
    subcritical, supercritical = (special_point(doubling, "period_doubling", number) for number in (0, 1))
    doubled = Continuation(switch_to_doubled(doubling, supercritical)).run()
    fold, end = special_point(doubled, "fold"), doubled.special[-1]
    # μ − 1 = 2aγ along the branch, so two orbits and their multipliers give the coefficient
    before, after = (min(point.multipliers, key=lambda z: abs(z - 1.0)).real for point in (fold.before, fold.after))
    apart = np.sqrt(np.mean((fold.after.x - fold.before.x) ** 2))
    assert fold.normal_form is not None
    assert fold.normal_form.coefficient == pytest.approx(abs(after - before) / (2.0 * apart), rel=0.05)
    assert fold.criticality == "generic" and fold.knob > subcritical.interval[1] + 0.5
    assert end.kind == "period_doubling" and end.normal_form is None
    assert end.knob == pytest.approx(subcritical.knob, abs=sum(s.interval[1] - s.interval[0] for s in (end, subcritical)))
    # between the doubling and the fold, the chain stays on the orbit that it is near: both attract
    between = next(p for p in doubled.points if p.stable and p.knob > subcritical.interval[1])
    chain = doubled.axis.scene_at(between.knob)
    once = granchain_core.branch(scene("sec2"), "f", between.knob, 262.0, 1).points[0]
    assert once.stable
    assert settle(chain, doubled.state(between)).regime.period == 2 and settle(chain, doubling.state(once)).regime.period == 1


def test_a_coefficient_agrees_with_that_of_smaller_amplitudes_within_its_error(doubling: Branch) -> None:
    for special in (special_point(doubling, "period_doubling", number) for number in (0, 1)):
        fine = again(doubling, special, {"period_doubling": (2e-5,)}, tolerance=1e-13).normal_form
        assert fine is not None and special.normal_form is not None
        assert abs(fine.coefficient - special.normal_form.coefficient) < special.normal_form.error + fine.error


def test_the_closed_curve_grows_as_the_root_of_the_distance(torus: Branch) -> None:
    """On the curve, |γ|² = −β/Re d with β = |μ| − 1. A chain that starts near it moves to the curve and stays there."""
    form = special_point(torus, "neimark_sacker").normal_form
    assert form is not None and form.criticality == "supercritical"
    equations = BranchEquations(torus.axis, 1)
    radii, expected = [], []
    for frequency in (1965.0, 1948.0):
        point = granchain_core.branch(scene("sec2"), "f", frequency, frequency - 0.1, 1).points[0]
        values, vectors = np.linalg.eig(equations.stroboscopic_map(frequency)(point.x).derivative)
        leading = int(np.argmax(np.where(values.imag > 0.0, np.abs(values), 0.0)))
        right = vectors[:, leading] * np.sqrt(len(values)) / np.linalg.norm(vectors[:, leading])
        left = np.linalg.inv(vectors)[leading] / (np.linalg.inv(vectors)[leading] @ right)
        expected.append(np.sqrt((1.0 - abs(values[leading])) / form.coefficient))
        x, steps = point.x + 2.0 * 0.8 * expected[-1] * right.real, equations.quick_steps(equations.point(point.x, frequency))
        squares = []
        for _ in range(int(3.0 / (abs(values[leading]) - 1.0))):
            x = equations.quick_end(x, frequency, steps)
            squares.append(abs(left @ (x - point.x)) ** 2)
        radii.append(np.sqrt(np.mean(squares[-300:])))
    assert radii == pytest.approx(expected, rel=0.05)


def again(branch: Branch, special: SpecialPoint, amplitudes: dict[str, tuple[float, ...]] = AMPLITUDES,
          tolerance: float = 1e-12) -> SpecialPoint:
    """Return the special point with its normal form computed again."""
    return with_normal_forms([special], between(branch, special), amplitudes, tolerance)[0]


def between(branch: Branch, special: SpecialPoint) -> Between:
    """Return the orbits between those on both sides of a special point."""
    equations = BranchEquations(branch.axis, branch.period)
    near = [Near(equations.stroboscopic_map(p.knob)(p.x).derivative, p.slope) for p in (special.before, special.after)]
    return Between(equations, special.before, special.after, (near[0], near[1]))


def test_the_criticality_is_the_same_when_it_is_computed_again(doubling: Branch) -> None:
    special = special_point(doubling, "period_doubling")
    assert again(doubling, special).normal_form == special.normal_form


def test_nothing_is_decided_where_a_contact_grazes_in_the_same_interval(doubling: Branch) -> None:
    special = special_point(doubling, "period_doubling")
    closings = special.after.closings.copy()
    closings[3] += 1
    form = again(doubling, replace(special, after=replace(special.after, closings=closings))).normal_form
    assert form is not None and (form.criticality, form.reason) == ("not decided", SEQUENCE_IN_INTERVAL)


@pytest.mark.parametrize("frequency", [228.0, 252.0])
def test_the_order_of_contact_events_counts_where_none_grazes(doubling: Branch, frequency: float) -> None:
    """At about 228 Hz, a closing passes phase 0; at about 252 Hz, events of distant contacts exchange their order."""
    points = doubling.points
    after = next(i for i, point in enumerate(points) if point.knob < frequency)
    special = replace(special_point(doubling, "period_doubling"), before=points[after - 1], after=points[after])
    assert np.array_equal(special.before.closings, special.after.closings)
    events = [between(doubling, special).contacts(point) for point in (special.before, special.after)]
    if frequency == 228.0:
        assert np.array_equal(np.roll(events[0], -1), events[1])
    else:
        place = int(np.flatnonzero(events[0] != events[1])[0])
        assert np.array_equal(events[0][[*range(place), place + 1, place, *range(place + 2, len(events[0]))]], events[1])
    form = again(doubling, special).normal_form
    assert form is not None and (form.reason == SEQUENCE_IN_INTERVAL) == (frequency == 228.0)


@pytest.mark.parametrize(("other", "fold", "doubling"), [
    ([1, -1, 4, -4, 2, -2], True, True),  # as before
    ([1, 4, -1, -4, 2, -2], True, True),  # contacts 1 and 4 have no common bead
    ([1, -1, 4, 2, -4, -2], True, True),
    ([1, 2, -1, 4, -4, -2], True, False),  # contacts 1 and 2 have a common bead
    ([-1, 4, -4, 2, -2, 1], False, False),  # a closing passes phase 0
    ([-1, 4, -4, 2, -2], False, False),  # at only one end of the period
    ([1, -1, 4, -4, 2, -2, 2, -2], False, False),  # contact 2 grazes
    ([1, -1, 4, -4, 2, -2, 6, -6], False, False),
])
def test_a_normal_form_needs_the_sequence_as_far_as_its_derivatives_do(other: list[int], fold: bool, doubling: bool) -> None:
    sequences = np.array([1, -1, 4, -4, 2, -2]), np.array(other)
    for one, another in (sequences, sequences[::-1]):
        assert same_sequence("fold", one, another) == fold
        assert all(same_sequence(kind, one, another) == doubling for kind in ("period_doubling", "neimark_sacker"))
    nothing = np.zeros(0)
    assert same_sequence("fold", nothing, nothing) and not same_sequence("fold", nothing, sequences[1])


def test_no_state_is_used_along_which_contacts_close_in_another_order(doubling: Branch) -> None:
    """At 255.8 Hz, a contact grazes between the amplitudes 3e-4 and 1e-3."""
    form = again(doubling, special_point(doubling, "period_doubling"), {"period_doubling": (1e-3,)}).normal_form
    assert form is not None and (form.criticality, form.reason) == ("not decided", SEQUENCE_NEAR)


def test_a_grazing_has_no_criticality(doubling: Branch) -> None:
    grazing = special_point(doubling, "grazing")
    assert grazing.normal_form is None and grazing.criticality is None and grazing.criticality_words() == ""


# --- results ----------------------------------------------------------------------------------------------


def test_files_and_checkpoints_keep_the_criticality(doubling: Branch, tmp_path: Path) -> None:
    undecided = replace(special_point(doubling, "period_doubling"), normal_form=NormalForm("not decided", reason=REASONS[0]))
    doubling = replace(doubling, half_branches=(replace(doubling.half_branches[0], special=[*doubling.special, undecided]),))
    loaded = load_branch(save_branch(doubling, tmp_path / "b.h5"))
    kept = [special_from_json(json.loads(json.dumps(special_as_json(one)))) for one in doubling.special]
    for special, *others in zip(doubling.special, loaded.special, kept, strict=True):
        for other in others:
            assert str(other.normal_form) == str(special.normal_form)  # NaN is not equal to itself


def test_a_file_without_criticality_opens(doubling: Branch, tmp_path: Path) -> None:
    path = save_branch(doubling, tmp_path / "old.h5")
    with h5py.File(path, "r+") as file:
        for name in ("criticality", "coefficient", "coefficient_error", "undecided"):
            del file["special"][name]
    seal(path)
    loaded = load_branch(path)
    assert [s.kind for s in loaded.special] == [s.kind for s in doubling.special]
    assert all(s.normal_form is None and s.criticality is None for s in loaded.special)
    assert branch_json(loaded)["normal_form"] == [None] * len(loaded.special)


@pytest.mark.parametrize(("earlier", "now"), EARLIER_REASONS.items())
def test_a_reason_as_earlier_versions_spelled_it_is_read(doubling: Branch, tmp_path: Path, earlier: str, now: str) -> None:
    special = replace(special_point(doubling, "period_doubling"), normal_form=NormalForm("not decided", reason=earlier))
    assert special_from_json(json.loads(json.dumps(special_as_json(special)))).criticality_words() == f"criticality not decided: {now}"
    old = replace(doubling, half_branches=(replace(doubling.half_branches[0], special=[special]),))
    assert load_branch(save_branch(old, tmp_path / "old.h5")).special[0].criticality_words() == f"criticality not decided: {now}"


def test_a_reason_that_does_not_fit_is_refused(doubling: Branch, tmp_path: Path) -> None:
    path = save_branch(doubling, tmp_path / "b.h5")
    with h5py.File(path, "r+") as file:
        file["special/undecided"][:] = REASONS[0]
    seal(path)
    with pytest.raises(BadInput, match="undecided does not fit"):
        load_branch(path)


def test_the_criticality_is_given_in_words_and_numbers(doubling: Branch, torus: Branch) -> None:
    subcritical, supercritical = (special_point(doubling, "period_doubling", number) for number in (0, 1))
    assert criticality_words(subcritical) == "subcritical: near it, on the stable side, an orbit of twice the period repels"
    assert criticality_words(supercritical) == (
        "supercritical: near it, on the unstable side, an orbit of twice the period attracts")
    assert criticality_words(special_point(torus, "neimark_sacker")).endswith("a closed curve of the map attracts")
    assert criticality_words(special_point(doubling, "grazing")) == ""
    assert supercritical.normal_form is not None
    assert supercritical.normal_form.coefficient == pytest.approx(699.0, rel=2e-3)  # it depends on the tolerance by 3e-4
    said = branch_json(torus)["normal_form"][torus.special.index(special_point(torus, "neimark_sacker"))]
    assert said["criticality"] == "supercritical" and said["coefficient"] < 0.0 < said["error"] and said["reason"] == ""
    assert said["angle"] == pytest.approx(1.1995, abs=1e-4)
    rounded = NormalForm("supercritical", coefficient=698.98765, error=0.123)
    assert normal_form_words(replace(supercritical, normal_form=rounded)) == ", supercritical, coefficient 698.99 ± 0.12"
    turned = replace(special_point(torus, "neimark_sacker"), normal_form=rounded, multiplier=np.exp(1.2j))
    assert normal_form_words(turned) == ", supercritical, coefficient 698.99 ± 0.12, angle 68.75°"
    assert any("subcritical" in line for line in doubling.summary())
    unknown = replace(subcritical, normal_form=NormalForm("not decided", reason=REASONS[0]))
    assert criticality_words(unknown) == f"criticality not decided: {REASONS[0]}"
