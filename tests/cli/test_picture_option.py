"""`--picture FILE.html` writes one self-contained file with the figure, and does not change the result."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import h5py
import pytest

import granchain_core.accuracy
from app.cli import main
from app.cli.check import heading
from granchain_core import Scene, WorkPrecision, scene
from granchain_core.accuracy import Row
from granchain_core.hard_cases import CASES, Case, Check, runner, table

ROOT = Path(__file__).parents[2]
SHORT = ["sec2", "--set", "N=2"]
COMMANDS = {
    "curve": [*SHORT, "--from", "1900", "--to", "2000", "--points", "2"],
    "curve --data": [*SHORT, "--from", "1900", "--to", "2000", "--points", "2", "--data", "../measured.csv", "--elastic"],
    "orbit": [*SHORT, "--set", "f=2000"],
    "branch": [*SHORT, "--knob", "f", "--from", "2000", "--to", "2020"],
    "run": [*SHORT, "--set", "f=2000", "--periods", "2", "--record", "2"],
    "run --drive": [*SHORT, "--drive", "burst=2000:2:0.002"],
    "pulse": ["impact", "--set", "N=4"],
    "map": [*SHORT, "--x", "f=1900:2000:2", "--y", "A0=5e-7:6e-7:2", "--out", "map.h5"],
}
#: A data source that each figure must have.
SOURCES = {"run": "input force", "run --drive": "input force", "pulse": "output force", "curve": "rest",
           "curve --data": "measured", "orbit": "within", "branch": "orbits", "map": "cells"}


def document(page: str) -> dict[str, object]:
    """Return the Bokeh document in a page."""
    (found,) = re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', page, re.DOTALL)
    return dict(next(iter(json.loads(found).values())))


#: Runs all commands in one process, which imports the core only once; prints the output of each by its name.
_PROGRAM = """
import contextlib, io, json, os, sys
from app.cli import main

told = {}
for name, words in json.loads(sys.argv[1]).items():
    os.mkdir(name)
    os.chdir(name)
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert main(words) == 0, name
    told[name] = out.getvalue()
    os.chdir("..")
print(json.dumps(told))
"""


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[str, str]]:
    """A function that returns a command's output and its page. All commands run in a separate process, because Panel,
    which other tests import, adds its own scripts to every Bokeh page.
    """
    folder = tmp_path_factory.mktemp("pictures")
    (folder / "measured.csv").write_text("frequency_Hz,max_output_force_N\n1900,0.5\n1980,0.6\n", encoding="utf-8")
    words = {name: [name.split()[0], *COMMANDS[name], "--json", "--picture", "a.html"] for name in COMMANDS}
    done = subprocess.run([sys.executable, "-c", _PROGRAM, json.dumps(words)], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    return lambda name: (told[name], (folder / name / "a.html").read_text(encoding="utf-8"))


@pytest.mark.parametrize("command", COMMANDS)
def test_the_figure_is_in_a_file_that_needs_nothing_else(command: str, drawn: Callable[[str], tuple[str, str]]) -> None:
    told, page = drawn(command)
    json.loads(told)  # still a single JSON object
    assert not re.search(r"<(script|link)[^>]+(src|href)=", page)
    assert re.search(rf'"name": "ColumnDataSource", "id": "[^"]+", "attributes": {{"name": "{SOURCES[command]}", ',
                     json.dumps(document(page)))


def test_an_unwritable_picture_is_refused_before_anything_is_computed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, words in (("a.png", "writes an HTML file; name it a.html, not a.png"), (str(tmp_path / "none" / "a.html"), "Cannot write")):
        assert main(["orbit", *COMMANDS["orbit"], "--picture", name]) == 2
        assert words in capsys.readouterr().err


def test_a_map_of_too_many_cells_is_not_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["map", "sec2", "--x", "f=100:200:300", "--y", "A0=5e-7:6e-7:300", "--out", str(tmp_path / "a.h5")]
    assert main([*words, "--picture", str(tmp_path / "a.html")]) == 2
    assert "--picture draws up to 40000 cells and this map has 90000" in capsys.readouterr().err


def test_an_observers_forces_are_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    force = tmp_path / "force.csv"
    force.write_text("time (ms),force (N)\n" + "".join(f"{0.01 * i:.2f},{min(i, 40 - i) / 20:.2f}\n" for i in range(41)))
    assert main(["observe", *SHORT, "--input", str(force), "--json", "--picture", str(tmp_path / "a.html")]) == 0
    assert '"output force, computed"' in json.dumps(document((tmp_path / "a.html").read_text(encoding="utf-8")))


def test_accuracy_is_drawn_for_the_accuracy_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def measured(chosen: Scene, *_: object) -> WorkPrecision:
        return WorkPrecision(chosen, "dop853", "SciPy's DOP853", 1e-11, [Row("rk4", "2 × the default steps", 1e-5, 0.001, 7, 2.0)])

    monkeypatch.setattr(granchain_core.accuracy, "work_precision", measured)
    assert main(["accuracy", *SHORT, "--set", "accuracy=1e-4", "--picture", str(tmp_path / "a.html"),
                 "--out", str(tmp_path / "a.h5")]) == 0
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["accuracy/wall_s"][:].tolist() == [0.001]
    drawn = json.dumps(document((tmp_path / "a.html").read_text(encoding="utf-8")))
    assert '"asked 1e-4"' in drawn and '"error 1e-05, 1 ms, 7 evaluations"' in drawn
    assert scene("sec2").accuracy != 1e-4


def test_the_pictures_of_the_hard_cases_are_drawn_under_their_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def rows(quick: bool, workers: int | None = None):  # type: ignore[no-untyped-def]
        for case in CASES:
            yield case.name, [Check(case.name, "one", 0.5, 1.0, True, 0.1, case.hard, case.naive, case.oracle)]

    (quickest,) = (case for case in CASES if case.name == "touch and graze")
    without = [case if case is quickest else Case(**{**vars(case), "picture": None}) for case in CASES]
    monkeypatch.setattr(runner, "run_cases", rows)
    monkeypatch.setattr(table, "CASES", tuple(without))
    assert main(["check", "--quick", "--json", "--picture", str(tmp_path / "a.html")]) == 0
    drawn = json.dumps(document((tmp_path / "a.html").read_text(encoding="utf-8")))
    assert drawn.count('"name": "Div"') == 1 and "Touch and graze" in drawn


def test_a_heading_raises_powers() -> None:
    assert heading("10^5 periods & F^{1/6}") == "<h3>10<sup>5</sup> periods &amp; F<sup>1/6</sup></h3>"
