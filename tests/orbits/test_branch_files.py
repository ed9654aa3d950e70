"""Branches that are stopped, saved and continued stay the same, and refusals are one sentence."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray

import granchain_core
from app.cli import main
from granchain_core import BadInput, Cancelled, scene
from granchain_core.execution.stop import Stop
from granchain_core.orbits import Branch, Continuation, begin_branch, switch_to_doubled
from granchain_core.orbits.branch.orbit_checkpoints import special_as_json, special_from_json
from granchain_core.orbits.branch.steps import SHORTEST_STEP
from granchain_core.store import load_branch, save_branch


def begun() -> Branch:
    """Begin a branch in both directions, with few orbits and some special points."""
    return begin_branch(scene("sec2").evolve(f=1550.0), "f", 1400.0, 1650.0, 1, both=True)


@pytest.fixture(scope="module")
def whole() -> Branch:
    """That branch, followed without interruption."""
    return Continuation(begun()).run()


def assert_same(one: Branch, other: Branch) -> None:
    """Assert equality to the last bit, including special points and next steps."""
    assert [arm.step for arm in one.half_branches] == [arm.step for arm in other.half_branches]
    assert [arm.reason for arm in one.half_branches] == [arm.reason for arm in other.half_branches]
    for first_point, second_point in zip([*one.points, *(p for s in one.special for p in (s.before, s.after))],
                                         [*other.points, *(p for s in other.special for p in (s.before, s.after))], strict=True):
        for name in ("x", "tangent", "multipliers", "closings", "slope"):
            np.testing.assert_array_equal(getattr(first_point, name), getattr(second_point, name))
        for name in ("knob", "arclength", "residuals", "liouville_error", "max_input_force", "max_output_force",
                     "max_output_force_elastic"):
            assert getattr(first_point, name) == getattr(second_point, name)
    special = [[(s.kind, s.knob, s.interval, s.multiplier, s.contact, s.gained, str(s.normal_form)) for s in b.special]
               for b in (one, other)]
    assert special[0] == special[1]


@pytest.mark.parametrize("after", [2, 4])
def test_a_branch_that_was_saved_goes_on_as_if_it_had_never_stopped(tmp_path: Path, whole: Branch, after: int) -> None:
    stopped = Continuation(begun()).run(most_points=after)
    file = save_branch(stopped, tmp_path / "b.h5")
    assert all(len(arm.points) == after for arm in stopped.half_branches)
    resumed = load_branch(file)
    assert_same(resumed, stopped)
    Continuation(resumed).run()
    assert_same(resumed, whole)
    assert_same(load_branch(save_branch(resumed, file)), whole)


def test_checkpoints_keep_the_names_that_orbits_had_in_them(whole: Branch) -> None:
    """This way, a branch that was interrupted in an earlier version can be resumed from its file."""
    special = whole.special[0]
    kept = json.loads(json.dumps(special_as_json(special)))
    assert {"liouville", "turns"} < set(kept["before"]) and not {"liouville_error", "overlap_extrema"} & set(kept["before"])
    again = special_from_json(kept).before
    assert again.liouville_error == special.before.liouville_error == getattr(special.before, "liouville")  # noqa: B009 -- a former name
    np.testing.assert_array_equal(again.overlap_extrema, getattr(special.before, "turns"))  # noqa: B009 -- a former name


def test_points_one_by_one_are_those_of_both_threads(whole: Branch) -> None:
    one_by_one = begun()
    count = sum(1 for _ in Continuation(one_by_one))
    assert count == len(whole.points) - 1  # the starting orbit existed before
    assert_same(one_by_one, whole)


def test_a_cancelled_branch_stays_whole_and_can_be_continued(whole: Branch) -> None:
    branch, stop, grown = begun(), Stop(), []

    def cancel(arm: object) -> None:
        grown.append(arm)
        if len(grown) == 3:
            stop.set()

    with pytest.raises(Cancelled):
        Continuation(branch, stop).run(on_point=cancel)
    assert len(branch.points) < len(whole.points) and not all(arm.ended for arm in branch.half_branches)
    Continuation(branch).run()
    assert_same(branch, whole)


def test_xarray_opens_a_branch_with_its_units(tmp_path: Path, whole: Branch) -> None:
    file = save_branch(whole, tmp_path / "b.h5")
    with xarray.open_dataset(file, engine="h5netcdf", group="branch") as data:
        assert data.knob.dims == ("point",) and data.knob.attrs["units"] == "Hz"
        assert data.max_output_force_elastic.attrs["units"] == "N"
        assert data.state.dims == ("point", "component") and data.closings.dims == ("point", "contact")
        assert list(data.stable.values) == [int(p.stable) for arm in whole.half_branches for p in arm.points]
    with xarray.open_dataset(file, engine="h5netcdf", group="special") as data:
        assert (data.knob_low <= data.knob).all() and (data.knob <= data.knob_high).all()
        assert "period_doubling" in set(data.kind.values)


def test_a_file_that_is_no_branch_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "a.h5"
    other.write_bytes(b"no HDF5")
    for path in (other, tmp_path / "missing.h5"):
        with pytest.raises(BadInput, match="not a branch written by granchain"):
            load_branch(path)


def test_a_branch_that_cannot_be_followed_fails_with_its_residuals(monkeypatch: pytest.MonkeyPatch) -> None:
    from granchain_core import ComputationError
    from granchain_core.orbits.branch.equations import BranchEquations

    branch = begin_branch(scene("sec2"), "f", 2000.0, 2100.0, 1)

    def nothing(*_: object) -> None:
        raise ComputationError("Newton's residuals were 1e-3, 2e-3.", "no-convergence")

    monkeypatch.setattr(BranchEquations, "solve_near", nothing)
    assert list(Continuation(branch)) == [] and branch.half_branches[0].ended == "lost"
    assert branch.half_branches[0].step < SHORTEST_STEP
    for words in ("could not be followed beyond f = 2000 Hz", "1e-3, 2e-3", "residuals at the last orbit"):
        assert words in branch.half_branches[0].reason


@pytest.mark.parametrize(("words", "sentence"), [
    (["--from", "340", "--to", "400"], "needs --knob"),
    (["--knob", "f", "--to", "400"], "needs --from"),
    (["--knob", "freq", "--from", "340", "--to", "400"], "Unknown knob 'freq'"),
    (["--knob", "N", "--from", "3", "--to", "5"], "cannot be moved continuously along a branch"),
    (["--knob", "accuracy", "--from", "1e-3", "--to", "1e-5"], "those that can are f, A0, D, k, kappa, F0"),
    (["--knob", "wall", "--from", "1", "--to", "2"], "cannot be moved continuously"),
    (["--knob", "f", "--from", "340", "--to", "340"], "give two different ones"),
    (["--knob", "f", "--from", "0", "--to", "340"], "nearest valid value is 0.1"),
    (["--knob", "D", "--from", "100", "--to", "-3"], "nearest valid value is 0"),
    (["--knob", "f", "--from", "ten", "--to", "340"], "not 'ten'"),
    (["--knob", "f", "--from", "400", "--to", "500", "--both"], "the nearest valid value is 400"),
    (["--knob", "f", "--from", "2000", "--to", "2100", "--period", "99"], "nearest valid value is 60"),
    (["--knob", "f", "--from", "2000", "--to", "2100", "--period", "2"], "repeats after only 1; give period 1"),
    (["--knob", "f", "--from", "2000", "--to", "2100", "--points", "1"], "nearest valid value is 2"),
    (["--knob", "f", "--from", "2000", "--to", "2100", "--set", "tension=cut"], "tension"),
    (["--knob", "f", "--resume", "b.h5"], "cannot be combined with"),
    (["--resume", "missing.h5"], "not a branch written by granchain"),
    (["--knob", "f", "--from", "2000", "--to", "2100", "--out", "/no/such/b.h5"], "Cannot write /no/such/b.h5"),
])
def test_wrong_input_gets_one_sentence_and_status_2(words: list[str], sentence: str,
                                                    capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["branch", "sec2", *words]) == 2
    out, err = capsys.readouterr()
    assert out == "" and sentence in err
    assert len(err.strip().splitlines()) == 1 and "Traceback" not in err


def test_no_orbit_at_the_start_exits_with_3(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["branch", "rig", "--knob", "f", "--from", "140", "--to", "150", "--period", "1"]) == 3
    assert "found no orbit" in capsys.readouterr().err


def test_the_command_goes_on_from_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, words = str(tmp_path / "b.h5"), ["branch", "sec2", "--knob", "f", "--from", "1500", "--to", "1600", "--json"]
    assert main([*words, "--period", "1"]) == 0
    out, err = capsys.readouterr()
    whole = json.loads(out)
    assert len(whole["knob"]) == len(whole["stable"]) == len(whole["max_output_force_elastic"])
    assert whole["knob"][0] == 1500.0 and whole["knob"][-1] == 1600.0 and "reached f = 1600 Hz" in err
    special = whole["special"][0]
    assert set(special) == {"kind", "knob", "interval"} and special["kind"] == "period_doubling"
    assert special["interval"][0] <= special["knob"] <= special["interval"][1]
    assert len(whole["evidence"]) == len(whole["special"])
    assert whole["evidence"][0]["multiplier"] == pytest.approx([-1.0, 0.0], abs=1e-3)
    assert main([*words, "--period", "1", "--points", "3", "--out", file]) == 0
    capsys.readouterr()
    assert main(["branch", "sec2", "--resume", file, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == whole


def test_branches_are_switched_only_at_period_doublings() -> None:
    branch = granchain_core.branch(scene("sec2"), "f", 340.0, 348.0, 1)
    grazing = next(s for s in branch.special if s.kind == "grazing")
    assert grazing.contact == 1 and grazing.gained == "open interval"
    with pytest.raises(BadInput, match="not at a grazing"):
        switch_to_doubled(branch, grazing)
