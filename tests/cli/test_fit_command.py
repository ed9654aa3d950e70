"""`granchain fit`: parameters with intervals and a verdict, as a table, JSON, a file and a picture."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from app.cli.fit import _error
from granchain_core import resonance_curve, scene

ROOT = Path(__file__).parents[2]
CHAIN = ["sec2", "--set", "N=2"]


@pytest.fixture()
def data(tmp_path: Path) -> str:
    """A file with a curve of two beads, with D = 115 N s/m and 3 % noise, in kHz and mN with decimal commas."""
    curve = resonance_curve(scene("sec2").evolve(N=2, D=115.0), np.linspace(1500.0, 2600.0, 7))
    random = np.random.default_rng(3)
    rows = [(p.frequency / 1e3, 1e3 * p.max_output_force * (1 + 0.03 * random.standard_normal())) for p in curve.points]
    text = "f [kHz];F [mN]\n" + "".join(f"{f:.6f};{force:.6f}\n" for f, force in rows).replace(".", ",")
    (tmp_path / "mine.csv").write_text(text, encoding="utf-8")
    return str(tmp_path / "mine.csv")


def test_a_table_a_sentence_and_every_residual(data: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "fit.json"
    assert main(["fit", *CHAIN, "--data", data, "--free", "D=50:200", "--error", "0.03", "--out", str(out)]) == 0
    said = capsys.readouterr()
    assert re.search(r"^D +1\d\d\.\d+ N s/m +1\d\d\.?\d* to 1\d\d", said.out, re.MULTILINE)
    assert "The model can describe the data" in said.out and said.out.count("standard deviations") == 7
    assert "frequency in kHz, force in mN" in said.err
    kept = json.loads(out.read_text(encoding="utf-8"))
    assert len(kept["landscape"]["D"]) == len(kept["landscape"]["misfit"]) == kept["evaluations"]
    parameter = kept["parameters"][0]
    assert parameter["low"] < 115.0 < parameter["high"]


def test_a_fit_of_force_trains_has_a_table_and_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """There are no rows of residuals, since the samples of a force have no frequency."""
    chain, file = [*CHAIN, "--set", "f=2000"], str(tmp_path / "trains.csv")
    assert main(["virtual", *chain, "--noise", "0.02", "--periods", "4", "--out", file]) == 0
    capsys.readouterr()
    assert main(["fit", *chain, "--data", file, "--free", "D=60:180", "--error", "0.02"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("parameter") and said[1].startswith("D ") and len(said) == 3


@pytest.mark.parametrize(("words", "sentence"), [
    (["--free", "D=50:200"], "either --data FILE or --features paper"),
    (["--features", "mine", "--free", "D=50:200"], "'mine' is not known"),
    (["--features", "paper", "--per-frequency", "--free", "A0=1e-6:1e-5"], "states no forces"),
    (["--features", "paper"], "Say what to fit"),
    (["--features", "paper", "--free", "D=50:200", "--prior", "k=1:2"], "has no matching --free"),
    (["--features", "paper", "--free", "D=50:200", "--error", "0"], "must be above 0"),
    (["--features", "paper", "--free", "D=50:200", "--error", "3N"], "these data take Hz, for example --error 3Hz"),
    (["--features", "paper", "--free", "D=50:200", "--error=-1Hz"], "must be above 0"),
    (["--data", "none.csv", "--free", "D=50:200"], "Cannot read none.csv"),
    (["--features", "paper", "--free", "D=50:200", "--picture", "a.png"], "writes an HTML file"),
])
def test_bad_arguments_are_refused_before_anything_is_computed(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fit", *CHAIN, *words]) == 2
    assert sentence in capsys.readouterr().err


def test_the_picture_is_one_file(data: str, tmp_path: Path) -> None:
    # in a separate process, because Panel, which other tests import, adds its own scripts to every Bokeh page
    out = tmp_path / "a.html"
    done = subprocess.run([sys.executable, "-m", "app.cli", "fit", *CHAIN, "--data", data, "--free", "D=50:200", "--error", "0.03",
                           "--json", "--picture", str(out)], cwd=ROOT, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["verdict"] == "can"
    page = out.read_text(encoding="utf-8")
    assert not re.search(r"<(script|link)[^>]+(src|href)=", page)
    for name in ("measured", "residuals", "model", "landscape of D"):
        assert f'"name": "{name}"' in page or f'"name":"{name}"' in page


def test_a_row_has_the_measured_force_and_the_models_motion_in_words(data: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fit", *CHAIN, "--data", data, "--free", "D=50:200", "--error", "0.03", "--no-intervals", "--design", "4"]) == 0
    rows = [line for line in capsys.readouterr().out.splitlines() if "standard deviations  " in line]
    assert rows and all(re.search(r"Hz  measured +\S+ N  model +\S+ N +[+-]\S+ standard deviations  period 1$", row) for row in rows)


@pytest.mark.parametrize(("text", "unit", "value"), [
    ("3%", "%", 0.03), ("0.03", "%", 0.03), ("0.2N", "N", 0.2), ("0.2", "N", 0.2), ("3Hz", "Hz", 3.0), (None, "N", None)])
def test_an_error_may_have_its_unit(text: str | None, unit: str, value: float | None) -> None:
    assert _error(text, unit) == (None if value is None else pytest.approx(value))
