"""After they were interrupted or killed, run, curve, branch and map continue with the parts they had finished, and
compute none of them again.
"""

from __future__ import annotations

import json
import shutil
import signal
import sys
import time
from dataclasses import dataclass, fields
from importlib import import_module
from inspect import signature
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from granchain_core import Amplitude, BadInput, resonance_curve, scene
from granchain_core.execution.checkpoints import CheckpointFolder, folder_of
from granchain_core.runs import to_accuracy
from granchain_core.steady.curve import resonance_curve as curves
from granchain_core.steady.curve.point_checkpoints import point_checkpoints, points_in
from granchain_core.steady.curve.request import CurveRequest
from tools.kills.finished import differing, finished_in
from tools.kills.processes import Command
from tools.kills.trial import COMMANDS as LONG

#: A run long enough to get two signals, each after a finished block; the other commands are as in tools/kills.
COMMANDS = {**LONG, "run": ("run", "sec2", "--periods", "1500", "--record", "5", "--samples", "16")}
#: Frequencies of the curves that are computed here [Hz].
FREQUENCIES = tuple(np.linspace(900.0, 1100.0, 7).tolist())
linux = pytest.mark.skipif(sys.platform != "linux", reason="descendants are found in /proc")


def interrupted(name: str, number: signal.Signals, out: Path, *more: str) -> set[object]:
    """Start a command, send it a signal once a further part is finished, and return the finished parts."""
    before = finished_in(name, out)
    command = Command(*COMMANDS[name], "--out", str(out), *more)
    try:
        while finished_in(name, out) <= before and command.process.poll() is None:
            time.sleep(0.05)
        if command.process.poll() is None:
            command.send(number)
        command.end()
    finally:
        command.kill()
    there = finished_in(name, out)
    assert there > before
    if command.process.returncode != 0 and number is not signal.SIGKILL:
        said = command.err.splitlines()[-1]
        assert said.endswith(("; continue with --resume.", f"the result is in {out}.")) and "Traceback" not in command.err
    return there


@pytest.mark.long
@linux
@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_goes_on_after_two_signals(name: str, tmp_path: Path) -> None:
    """The command is terminated, then killed. SIGINT is handled like SIGTERM (test_ending.py), and `tools.kills` sends
    all signals at random.
    """
    out = tmp_path / "out.h5"
    there = interrupted(name, signal.SIGTERM, out)
    assert there <= (more := interrupted(name, signal.SIGKILL, out, "--resume"))
    assert main([*COMMANDS[name], "--out", str(out), "--resume"]) == 0
    assert more <= finished_in(name, out) and not folder_of(out).exists()
    assert main([*COMMANDS[name], "--out", str(tmp_path / "whole.h5")]) == 0
    assert differing(tmp_path / "whole.h5", out) == ""


SHORT = {
    "run": ["run", "sec2", "--periods", "20", "--record", "2", "--samples", "8"],
    "curve": ["curve", "sec2", "--from", "300", "--to", "400", "--points", "3"],
    "branch": ["branch", "sec2", "--knob", "f", "--from", "1500", "--to", "1520", "--period", "1"],
    "map": ["map", "sec2", "--x", "f=300:400:2", "--y", "A0=5e-7:6e-7:2"],
}
#: Options that change the result, by command.
OTHER = {name: ["--set", "D=90"] for name in SHORT}


@pytest.fixture(scope="module", params=SHORT)
def finished(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path, bytes]:
    """A command, its result, and the head of its folder of blocks, as an interrupted command leaves it."""
    name, out = request.param, tmp_path_factory.mktemp("finished") / "a.h5"
    kept: list[bytes] = []
    remove = CheckpointFolder.remove

    def read_and_remove(self: CheckpointFolder[object]) -> None:
        with self._lock:  # the timer's thread may be writing the last block
            self._begin()
        kept.append(self._head_file.read_bytes())
        remove(self)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(CheckpointFolder, "remove", read_and_remove)
        assert main([*SHORT[name], "--out", str(out)]) == 0
    return name, out, kept[0]


def test_a_finished_result_is_looked_at_before_its_blocks(finished: tuple[str, Path, bytes], tmp_path: Path,
                                                          monkeypatch: pytest.MonkeyPatch,
                                                          capsys: pytest.CaptureFixture[str]) -> None:
    """If a command was killed after writing the result but before removing its blocks, nothing is computed again."""
    name, result, content = finished
    out = Path(shutil.copy(result, tmp_path))
    capsys.readouterr()
    folder_of(out).mkdir()
    (folder_of(out) / f"{name}.json").write_bytes(content)
    before, computed = out.read_bytes(), []
    monkeypatch.setattr(to_accuracy, "_refined", lambda *_, **__: computed.append(1))
    monkeypatch.setattr(curves, "_carried", lambda *_: computed.append(1))
    monkeypatch.setattr(curves, "_from_rest", lambda *_: computed.append(1))
    monkeypatch.setattr(import_module("app.cli.branch"), "begin_branch", lambda *_, **__: computed.append(1))
    monkeypatch.setattr(import_module("app.cli.map"), "iter_parameter_map", lambda *_: computed.append(1))
    assert main([*SHORT[name], "--out", str(out)]) == 2  # not without --resume
    assert "continue with --resume" in capsys.readouterr().err
    assert main([*SHORT[name], "--out", str(out), "--resume", "--json"]) == 0
    told, err = capsys.readouterr()
    assert json.loads(told) and computed == [] and not folder_of(out).exists()
    assert "already finished; nothing was computed" in err or name == "branch"
    if name != "branch":  # a branch continues in its file, so the file is written again
        assert out.read_bytes() == before


def test_resuming_with_other_options_is_refused(finished: tuple[str, Path, bytes], tmp_path: Path,
                                     capsys: pytest.CaptureFixture[str]) -> None:
    name, result, content = finished
    out = Path(shutil.copy(result, tmp_path))
    capsys.readouterr()
    assert main([*SHORT[name], *OTHER[name], "--out", str(out), "--resume"]) == 2
    assert "give another --out" in capsys.readouterr().err
    folder_of(out).mkdir()
    (folder_of(out) / f"{name}.json").write_bytes(content)
    out.unlink()
    assert main([*SHORT[name], *OTHER[name], "--out", str(out), "--resume"]) == 2
    told = capsys.readouterr().err
    assert f"holds another {name}" in told
    assert f"add --resume to the command line of that {name}, give another --out, or delete the folder" in told


@pytest.mark.parametrize("name", ["run", "curve", "branch"])
def test_resume_needs_a_file(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*SHORT[name], "--resume"]) == 2
    err = capsys.readouterr().err
    assert "--resume needs" in err and len(err.splitlines()) == 1


@pytest.mark.parametrize(("start", "amplitude", "digest"), [
    ("rest", None, "4d9634abc0b6451d"), ("down", None, "5da1a17261774351"),
    ("up", Amplitude("constant-velocity", (3e-3,)), "ea0ac7c017c10a79"),
    ("rest", Amplitude.table([50.0, 2000.0], [8e-7, 6e-7]), "708a4cc8a10e19ef"),
])
def test_blocks_of_earlier_versions_are_found(start: str, amplitude: Amplitude | None, digest: str) -> None:
    """The digests are those of the version before CurveRequest."""
    assert CurveRequest(scene("sec2").evolve(N=3), FREQUENCIES, start, amplitude).digest == digest


def test_the_digest_of_a_curve_contains_everything_that_changes_it() -> None:
    """Each argument of `resonance_curve` is a field of the request, or listed here because no point depends on it."""
    how = {"stop", "on_point", "workers", "known", "scheduler"}
    assert {field.name for field in fields(CurveRequest)} == set(signature(resonance_curve).parameters) - how

    @dataclass(frozen=True)
    class Longer(CurveRequest):
        skipped: int = 0

    asked = CurveRequest(scene("sec2"), FREQUENCIES)
    assert Longer(scene("sec2"), FREQUENCIES).digest == asked.digest != Longer(scene("sec2"), FREQUENCIES, skipped=1).digest


@pytest.mark.parametrize("start", ["rest", "up", "down"])
def test_known_points_are_not_computed_again_and_the_others_are_the_same(start: str, tmp_path: Path,
                                                                         monkeypatch: pytest.MonkeyPatch) -> None:
    """If the state is carried along, a curve continues from the last known point before the first gap."""
    asked = CurveRequest(scene("sec2").evolve(N=3), FREQUENCIES, start)
    whole = asked.compute(workers=1)
    kept = point_checkpoints(asked, tmp_path / "c.h5")
    order = sorted(whole.points, key=lambda p: p.frequency, reverse=start == "down")
    for point in (*order[:3], order[4]):
        kept.add(point)
    kept.write()
    again = point_checkpoints(asked, tmp_path / "c.h5")
    again.open(resume=True)
    known, new = points_in(again), []
    assert [p.frequency for p in known] == [p.frequency for p in (*order[:3], order[4])]
    for mine, its in zip(known, (*order[:3], order[4]), strict=True):
        assert (mine.regime, mine.force_errors, mine.max_output_force) == (its.regime, its.force_errors, its.max_output_force)
        assert mine.state.displacement.tobytes() == its.state.displacement.tobytes()
    found = asked.compute(on_point=new.append, known=known, workers=1)
    assert len(new) == (3 if start == "rest" else 4)
    assert [p.frequency for p in found.points] == sorted(FREQUENCIES)
    for mine, its in zip(found.points, whole.points, strict=True):
        if start != "rest":
            assert mine.max_output_force == its.max_output_force
        assert mine.max_output_force == pytest.approx(its.max_output_force, rel=1e-7)  # rounding in the batch


def pieces(out: Path, resume: bool = False) -> CheckpointFolder[int]:
    kept: CheckpointFolder[int] = CheckpointFolder(out, "count", "digest", "numbers", lambda found: json.dumps(found).encode())
    kept.open(resume)
    return kept


def numbers(kept: CheckpointFolder[int]) -> list[int]:
    return [number for content in kept.blocks() for number in json.loads(content)]


def test_the_last_piece_is_written_soon(tmp_path: Path) -> None:
    kept = pieces(tmp_path / "a")
    kept.add(1)
    assert kept._later is not None
    kept._later.join(60.0)
    assert numbers(kept) == [1]


def test_blocks_without_a_head_are_not_read(tmp_path: Path) -> None:
    """They may be left over from another computation, if their removal was interrupted."""
    kept = pieces(tmp_path / "a")
    kept.add(1)
    kept.write()
    (kept.path / "count.json").unlink()
    assert numbers(pieces(tmp_path / "a", resume=True)) == []
    kept.remove()
    assert not kept.path.exists()


def test_the_head_of_a_finished_checkpoint_is_removed_last(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = pieces(tmp_path / "a")
    kept.add(1)
    kept.write()
    removed: list[str] = []
    unlink = Path.unlink
    monkeypatch.setattr(Path, "unlink", lambda path, missing_ok=False: (removed.append(path.suffix), unlink(path, missing_ok)))
    kept.remove()
    assert removed == [".block", ".json"]


def test_a_folder_that_cannot_be_written_is_one_sentence(tmp_path: Path) -> None:
    kept = pieces(tmp_path / "a")
    folder_of(tmp_path / "a").write_text("a file")
    kept.add(1)
    with pytest.raises(BadInput, match=r"Cannot write .*a\.blocks"):
        kept.write()
    shutil.rmtree(folder_of(tmp_path / "a"), ignore_errors=True)
