"""`granchain figure`: every kind of file, and input that is refused before anything is computed."""

from __future__ import annotations

import csv
import io
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from PIL import Image

from app.cli import main
from granchain_core.paper import FIGURES

ROOT = Path(__file__).parents[2]


def test_a_table_has_units_in_its_names_and_all_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "a.csv"
    assert main(["figure", "3a", "--out", str(out)]) == 0
    assert capsys.readouterr().out == f"figure 3a: {FIGURES['3a'].title}; {out}\n"
    rows = list(csv.DictReader(io.StringIO(out.read_text())))
    assert list(rows[0])[:3] == ["scene", "time_s", "drive_displacement_m"] and "kinetic_energy_11_J" in rows[0]
    assert len(rows) == 4 * 192 + 1 and float(rows[-1]["time_s"]) == pytest.approx(4 / 340)
    energies = [float(value) for row in rows for name, value in row.items() if name.startswith("kinetic_energy")]
    assert max(energies) == pytest.approx(4.468e-8, rel=1e-3)


def test_a_page_needs_nothing_else_and_has_the_caption(tmp_path: Path) -> None:
    # in a separate process, because Panel, which other tests import, adds its own scripts to every Bokeh page
    subprocess.run([sys.executable, "-m", "app.cli", "figure", "5"], cwd=tmp_path, check=True, capture_output=True,
                   env={**os.environ, "PYTHONPATH": str(ROOT)})
    page = (tmp_path / "figure-5.html").read_text(encoding="utf-8")
    assert not re.search(r"<(script|link)[^>]+(src|href)=", page)
    assert "<b>Figure 5: What the shaker does" in page and "are images, whose numbers we do not have" in page


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_png_is_the_figure_with_its_caption(theme: str, tmp_path: Path) -> None:
    out = tmp_path / "a.png"
    assert main(["figure", "1", "--out", str(out), "--theme", theme]) == 0
    with Image.open(out) as picture:
        assert picture.size[0] == 1650 and picture.size[1] > 600  # one and a half times 1100 × 400, plus two lines
        colours = picture.convert("RGB").getcolors(1_000_000) or []
    paper = max(colours)[1]
    assert paper == ((255, 255, 255) if theme == "light" else (22, 26, 33))
    assert len(colours) > 20 and max(colours)[0] < 0.98 * picture.size[0] * picture.size[1]


def test_an_svg_is_one_picture_with_its_caption(tmp_path: Path) -> None:
    out = tmp_path / "a.svg"
    assert main(["figure", "5", "--out", str(out)]) == 0
    tree = ElementTree.parse(out).getroot()
    words = " ".join(one.text or "" for one in tree.iter("{http://www.w3.org/2000/svg}text"))
    assert "velocity amplitude V0 (mm/s)" in words and "Figure 5: What the shaker does" in words
    assert len(list(tree.iter("{http://www.w3.org/2000/svg}path"))) > 10
    assert not list(tree.iter("{http://www.w3.org/2000/svg}image"))  # lines, not pixels


@pytest.mark.parametrize(("words", "said"), [
    (["13"], "There is no figure '13'; there are 1 to 12, 3a and 3b, the nearest is 12."),
    (["6b"], "There is no figure '6b' of its own; figure 6 is drawn with all its panels."),
    (["two"], "the nearest is 1."), (["①"], "the nearest is 1."), (["9" * 5000], "the nearest is 12."),
    (["2", "--out", "a.pdf"], "name it a.html, not a.pdf"),
    (["2", "--out", "none/a.csv"], "Cannot write"),
    (["2", "--out", "a.csv", "--theme", "drak"], "the nearest is 'dark'"),
    (["2", "--out", "a.csv", "--data", "none.csv"], "Cannot read none.csv"),
])
def test_errors_are_reported_before_anything_is_computed(words: list[str], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                           capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("granchain_core.paper.compute", lambda *_: pytest.fail("computed"))
    assert main(["figure", *words]) == 2
    told = capsys.readouterr().err
    assert said in told and told.count("\n") == 1


def test_without_a_browser_one_sentence_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                                capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(shutil, "which", lambda _: None)
    assert main(["figure", "1", "--out", str(tmp_path / "a.png")]) == 2
    told = capsys.readouterr().err
    assert "drawn by Chromium or Chrome, and neither is on the PATH" in told and told.count("\n") == 1


def test_measured_points_are_in_the_table_with_their_interpretation(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    data, out = tmp_path / "shaker.csv", tmp_path / "a.csv"
    data.write_text("frequency_Hz,displacement_um\n60,7.5\n90,7\n")
    assert main(["figure", "5", "--data", str(data), "--out", str(out)]) == 0
    assert "shaker.csv: 2 amplitudes of displacement from 60 to 90 Hz" in capsys.readouterr().err
    rows = [row for row in csv.DictReader(io.StringIO(out.read_text())) if row["source"] == "measured"]
    assert [float(row["displacement_m"]) for row in rows] == pytest.approx([7.5e-6, 7e-6])


def test_the_list_names_every_figure(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["figure", "list"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(FIGURES)
