"""Branches to F0 = 0, where contacts just touch, and to D = 0, where nothing is damped."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from granchain_core import Scene, branch, orbit, scene
from granchain_core.orbits import (
    Branch,
    Continuation,
    KnobAxis,
    begin_branch,
    check_branch,
)
from granchain_core.store import load_branch, save_branch


def stands(chain: Scene, computed: Branch) -> None:
    """Assert that the branch is right everywhere and has reached its end, and that a direct search finds its last
    orbit.
    """
    last = computed.points[-1]
    assert computed.half_branches[0].ended == "reached" and last.knob == computed.axis.end and check_branch(computed) == []
    assert computed.summary()[1] == computed.half_branches[0].reason  # which says "reached" itself
    direct = orbit(chain.evolve(**{computed.axis.knob: last.knob}), 1, computed.state(last))
    np.testing.assert_allclose(direct.state.displacement, computed.state(last).displacement, rtol=1e-8, atol=1e-18)


@pytest.mark.parametrize(("preload", "changes"), [
    (3.0, {"N": 3, "f": 3000.0}),
    (1.0, {"N": 2, "f": 2000.0, "dissipation": "tsuji"}),
])
def test_a_branch_over_the_preload_reaches_zero_and_begins_there(preload: float, changes: dict[str, object]) -> None:
    """The static overlap varies as F0^{2/3}, and so do the orbits near F0 = 0."""
    chain = scene("sec2").evolve(**changes)
    down, up = (branch(chain.evolve(F0=ends[0]), "F0", *ends, 1) for ends in ((preload, 0.0), (0.0, preload)))
    stands(chain, down)
    stands(chain, up)
    # one branch: the same force at both ends, from both sides
    for one, other in ((down.points[-1], up.points[0]), (down.points[0], up.points[-1])):
        assert one.max_output_force == pytest.approx(other.max_output_force, rel=1e-6)


def test_the_coordinate_of_the_preload_and_its_inverse() -> None:
    axis = KnobAxis.of(scene("sec2"), "F0", 3.0, 0.5)
    values = np.array([0.5, 0.7, 1.9, 3.0])
    p = np.array([axis.coordinate(value) for value in values])
    assert p[0] == 0.0 and p[-1] == pytest.approx(20.0)
    np.testing.assert_allclose(np.diff(p) / np.diff(p)[0], np.diff(values ** (2 / 3)) / np.diff(values ** (2 / 3))[0])
    np.testing.assert_allclose([axis.value(one) for one in p], values)
    slopes = [(axis.value(one + 1e-5) - axis.value(one - 1e-5)) / 2e-5 for one in p]
    np.testing.assert_allclose([axis.slope(value) for value in values], slopes, rtol=1e-8)
    assert axis.value(-1e3) == 0.0


def test_a_file_of_an_earlier_version_continues_in_its_own_coordinate(tmp_path: Path) -> None:
    """In a file without the attribute, tangents and P_p are for a coordinate that is linear in F0."""
    chain = scene("sec2").evolve(N=2, f=2000.0, F0=1.0)
    begun = begin_branch(chain, "F0", 1.0, 0.5, 1)
    assert load_branch(save_branch(begun, tmp_path / "new.h5")).axis == begun.axis
    # as in the earlier version: the same seed with its tangent in the linear coordinate
    seed, axis = begun.points[0], replace(begun.axis, by_overlap=False)
    ratio = axis.slope(1.0) / begun.axis.slope(1.0)
    tangent = np.append(seed.tangent[:-1], seed.tangent[-1] / ratio)
    begun.half_branches[0].points[0] = replace(seed, tangent=tangent / np.linalg.norm(tangent), slope=seed.slope * ratio)
    old = Branch(axis, 1, begun.half_branches)
    Continuation(old).run(4)
    file = save_branch(old, tmp_path / "old.h5")
    with h5py.File(file) as written:
        assert "coordinate" not in written.attrs
    resumed = load_branch(file)
    assert resumed.axis == axis
    for one, other in zip(Continuation(resumed).run().points, Continuation(old).run().points, strict=True):
        np.testing.assert_array_equal(one.tangent, other.tangent)
        assert one.knob == other.knob
    assert resumed.half_branches[0].ended == "reached"


@pytest.mark.parametrize("changes", [{"N": 3, "f": 1500.0}, {"N": 2, "f": 2000.0}])
def test_the_end_without_damping_is_no_special_point(changes: dict[str, object], tmp_path: Path) -> None:
    """At D = 0, the map is conservative; rounding used to decide whether |μ| of a stable pair is above 1."""
    chain = scene("sec2").evolve(**changes)
    to_zero = branch(chain, "D", 50.0, 0.0, 1)
    stands(chain, to_zero)
    last = to_zero.points[-1]
    on_circle = np.abs(np.abs(last.multipliers) - 1.0) < 1e-9
    assert on_circle.any() and not last.damped and to_zero.points[-2].damped
    assert last.unstable_multipliers == (np.abs(last.multipliers[~on_circle]) > 1.0).sum()
    assert all(one.knob > 1.0 for one in to_zero.special)
    assert "counts as on it" in to_zero.summary()[-1]
    again = load_branch(save_branch(to_zero, tmp_path / "b.h5"))
    assert [point.signature for point in again.points] == [point.signature for point in to_zero.points]


def test_without_damping_stability_changes_only_where_multipliers_leave_the_circle() -> None:
    chain = scene("sec2").evolve(N=2, f=3000.0, F0=5.0)
    damped = branch(chain, "D", 100.0, 0.0, 1)
    undamped = branch(chain.evolve(D=0.0), "f", 3000.0, 2930.0, 1, damped.state(damped.points[-1]))
    assert check_branch(undamped) == []
    kinds = [one.kind for one in undamped.special if one.kind != "grazing"]
    assert kinds == ["period_doubling"]
    for point in undamped.points:
        assert point.unstable_multipliers == (np.abs(point.multipliers) > 1.001).sum()


@pytest.mark.parametrize(("name", "frequency", "amplitude"), [("rig", 100.0, 1e-9), ("sec2", 84.0, 1e-8)])
def test_a_branch_of_a_small_drive_under_preload_is_found(name: str, frequency: float, amplitude: float) -> None:
    """Beads that follow a slow drive are at rest at phase 0; relative to such displacements, rounding was a residual.
    """
    chain = scene(name).evolve(N=3, F0=1.0, f=frequency, A0=amplitude)
    small = branch(chain, "f", frequency, 1.003 * frequency, 1)
    assert small.half_branches[0].ended == "reached" and check_branch(small) == []
