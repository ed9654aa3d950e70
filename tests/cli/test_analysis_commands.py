"""spectrum, lyapunov, strobes, basins, pulse and bands: their JSON, their words, their pictures, and what they refuse."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli import main

SHORT = ["sec2", "--set", "N=2", "--set", "f=2000"]
COMMANDS = {
    "spectrum": [*SHORT, "--samples", "32"],
    "lyapunov": [*SHORT, "--periods", "20"],
    "strobes": [*SHORT, "--over", "f=1900:2000:2", "--keep", "4"],
    "basins": [*SHORT, "--x", "u1=0:2e-7:2", "--y", "v1=0:1e-3:2"],
    "pulse": ["impact", "--set", "N=5"], "bands": ["precompressed"],
}
KEYS = {
    "spectrum": {"force", "period", "resolution", "aliasing", "frequency", "amplitude", "phase", "transfer"},
    "lyapunov": {"exponents", "errors", "resolved", "dimension", "dimension_low", "dimension_high", "mean_trace", "liouville", "periods"},
    "strobes": {"knob", "start", "bead", "values", "regime", "period", "displacement", "velocity"},
    "basins": {"x", "y", "number", "attractors"}, "bands": {"bands", "cut_off"},
    "pulse": {"contact", "time", "force", "speed_beads", "speed", "width", "velocity", "error_estimate", "energy_residual"},
}
#: A source in the picture of each, where it has one.
SOURCES = {"spectrum": "lines", "strobes": "strobes", "basins": "basin 1"}


@pytest.mark.parametrize("command", COMMANDS)
def test_json_has_its_keys_and_a_picture_its_points(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "a.html"
    picture = ["--picture", str(page)] if command in SOURCES else []
    assert main([command, *COMMANDS[command], "--json", *picture]) == 0
    assert set(json.loads(capsys.readouterr().out)) == KEYS[command]
    assert not picture or f'"name": "{SOURCES[command]}"' in page.read_text(encoding="utf-8").replace('\\"', '"').replace('":"', '": "')


@pytest.mark.parametrize(("command", "words"), [
    ("spectrum", "Fourier series of a motion of period 1"), ("lyapunov", "of 4 exponents resolved"),
    ("strobes", "settled within"), ("basins", "100%"),
    ("pulse", "energy closes to"), ("bands", "cut-off 7200.22 Hz"),
])
def test_the_result_in_words(command: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, *COMMANDS[command]]) == 0
    assert words in capsys.readouterr().out


@pytest.mark.parametrize(("words", "sentence"), [
    (["spectrum", *SHORT, "--force", "wall"], "force 'wall'"), (["lyapunov", *SHORT, "--periods", "3"], "outside 20 to"),
    (["strobes", *SHORT, "--over", "f=1:2"], "must have the form KNOB=a:b:n"),
    (["strobes", *SHORT, "--over", "wall=1:2:3"], "knob of a strobe diagram 'wall'"),
    (["strobes", *SHORT, "--over", "f=1000:1100:2", "--bead", "3"], "--bead 3 is outside 1 to 2"),
    (["basins", *SHORT, "--x", "u9=0:1:2", "--y", "v1=0:1:2"], "Coordinate 'u9' is none"),
    (["pulse", "impact", "--set", "N=2"], "at least three beads"), (["bands", "sec2"], "Without a preload"),
])
def test_what_cannot_be_is_refused_with_a_sentence(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert sentence in capsys.readouterr().err
