"""Exports: tables that granchain reads again, and programs that reproduce the page's results."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from app.frames import samples_for
from app.session.export import EXPORTS, TEXTS, ExportedPicture, curve_csv, notebook, script, trains_csv
from granchain_core import resonance_curve, scene, settle
from granchain_core.experiment import Answers, Measured, read_data

ROOT = Path(__file__).resolve().parents[2]
SHOWN = scene("sec2").evolve(f=880.0)


@pytest.fixture(scope="module")
def screen() -> ExportedPicture:
    """A motion at 880 Hz, where it depends on the previous state, with three points of the curve."""
    start = settle(SHOWN.evolve(f=860.0)).state
    found = settle(SHOWN, start=start, samples=samples_for(SHOWN))
    points = resonance_curve(SHOWN.evolve(f=30.0), [340.0, 620.0, 1600.0]).points
    return ExportedPicture(found.run, start, {"rest": points}, "v=1&scene=sec2&f=880.0")


def run_again(program: str, tmp_path: Path) -> str:
    """Run a program and return its output."""
    path = tmp_path / "again.py"
    path.write_text(program, encoding="utf-8")
    done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, timeout=300, check=False,
                          env={**os.environ, "PYTHONPATH": str(ROOT)}, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_script_computes_the_numbers_of_the_page_to_the_last_digit(screen: ExportedPicture, tmp_path: Path) -> None:
    printed = run_again(script(screen) + "\nprint(repr(run.max_output_force))\n", tmp_path)
    assert printed.count("as on the page") == 3 and "but the page" not in printed
    assert repr(screen.run.max_output_force) in printed  # not only to the digits shown
    assert "3 points, largest difference from the page 0.0e+00" in printed
    # the start matters: from rest, the motion is another
    assert settle(SHOWN).run.regime.period != screen.run.regime.period


def test_a_script_names_the_numbers_that_differ(screen: ExportedPicture, tmp_path: Path) -> None:
    other = script(screen).replace("f=880.0)", "f=881.0)", 1)
    assert "but the page had" in run_again(other, tmp_path)


def test_the_notebook_runs_and_finds_the_same(screen: ExportedPicture, tmp_path: Path) -> None:
    """Its pictures are those of `granchain.figure`; the code that displays them in a notebook is replaced here."""
    content = json.loads(notebook(screen))
    assert (content["nbformat"], content["nbformat_minor"]) == (4, 5)
    assert len({cell["id"] for cell in content["cells"]}) == len(content["cells"])
    code = ["".join(cell["source"]) for cell in content["cells"] if cell["cell_type"] == "code"]
    shown = re.sub(r"^output_notebook.*$", "drawn = []\nshow = drawn.append", "\n\n".join(code), flags=re.MULTILINE)
    printed = run_again(shown + "\nprint(len(drawn), 'pictures')\n", tmp_path)
    assert printed.count("as on the page") == 3 and "2 pictures" in printed


def test_the_curve_can_be_read_again(screen: ExportedPicture) -> None:
    found = read_data(curve_csv(screen.curves).encode(), Answers(), ("curve",), "curve.csv", 2_000_000, 100_000)
    assert isinstance(found, Measured)
    points = screen.curves["rest"]
    assert list(found.frequency) == [point.frequency for point in points]
    assert list(found.force) == [point.max_output_force for point in points]


def test_the_curve_has_the_evidence_for_its_regimes(screen: ExportedPicture) -> None:
    rows = list(csv.DictReader(io.StringIO(curve_csv(screen.curves))))
    for row, point in zip(rows, screen.curves["rest"], strict=True):
        assert int(row["periods_run"]) == point.regime.periods_run
        for name in ("decay", "multiplier", "distance", "return_distance", "return_limit"):
            assert (float(row[name]) if row[name] else None) == getattr(point.regime, name)
        assert (row["orbit_found_by"] or None) == point.regime.orbit_found_by
    assert curve_csv({}).splitlines()[0].endswith("largest_window_ratio,orbit_found_by")


def test_the_trains_have_every_sample_and_every_jump(screen: ExportedPicture) -> None:
    lines = trains_csv(screen.run).splitlines()
    comments = [line for line in lines if line.startswith("#")]
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[len(comments) + 1:]])
    assert lines[len(comments)].split(",")[2:4] == ["input_force_N", "output_force_N"]
    assert np.array_equal(rows[:, 3], screen.run.output_force) and rows[0, 0] == 0.0
    jumps = screen.run.jumps
    ends = [c for c in jumps.contact if c in (0, SHOWN.N)]
    assert len(comments) == len(ends) >= 1


def test_every_offered_file_can_be_written(screen: ExportedPicture) -> None:
    assert all(write(screen) for _, write in TEXTS.values())
    assert {*EXPORTS} == {"hdf5", *TEXTS}  # the list on the page
