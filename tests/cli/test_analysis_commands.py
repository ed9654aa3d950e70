"""The commands spectrum, lyapunov, rotation, bifurcation-diagram, attractors, basins, pulse and bands: their output,
pictures and refusals.
"""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import pytest

from app.cli import main
from granchain_core import attractors, scene

SHORT = ["sec2", "--set", "N=2", "--set", "f=2000"]
COMMANDS = {
    "spectrum": [*SHORT, "--samples", "32"],
    "lyapunov": [*SHORT, "--periods", "20"],
    "rotation": ["sec2", "--set", "f=1700", "--periods", "2000"],
    "bifurcation-diagram": [*SHORT, "--over", "f=1900:2000:2", "--keep", "4"],
    "attractors": [*SHORT, "--random-states", "2"],
    "basins": [*SHORT, "--x", "u1=0:2e-7:2", "--y", "v1=0:1e-3:2"],
    "pulse": ["impact", "--set", "N=5"], "bands": ["precompressed"],
}
#: A data source in the picture of each command that has one.
SOURCES = {"spectrum": "lines", "lyapunov": "exponents", "rotation": "convergence", "bifurcation-diagram": "strobes",
           "attractors": "period 1", "basins": "basin 1"}
#: A group in the file of each command that has `--out`.
GROUPS = {"spectrum": "spectrum", "lyapunov": "lyapunov", "rotation": "rotation", "bifurcation-diagram": "strobes", "basins": "basins",
          "pulse": "pulse", "orbit": "multipliers"}


@pytest.mark.parametrize("command", SOURCES)
def test_a_picture_has_the_points_of_the_result(command: str, tmp_path: Path) -> None:
    page = tmp_path / "a.html"
    assert main([command, *COMMANDS[command], "--picture", str(page)]) == 0
    assert f'"name": "{SOURCES[command]}"' in page.read_text(encoding="utf-8").replace('\\"', '"').replace('":"', '": "')


@pytest.mark.parametrize("command", [*GROUPS])
def test_the_file_of_a_command_has_its_result(command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file has the command's main group, and the scene at the root; the output is the same as without a file."""
    words = [command, *COMMANDS.get(command, SHORT)]
    assert main([*words, "--out", str(tmp_path / "a.h5")]) == 0
    printed = capsys.readouterr().out
    with h5py.File(tmp_path / "a.h5") as file:
        assert GROUPS[command] in file and file.attrs["scene_name"] == words[1]
    assert main(words) == 0
    assert capsys.readouterr().out == printed
    assert main([*words, "--out", str(tmp_path / "none" / "a.h5")]) == 2


@pytest.mark.parametrize(("command", "words"), [
    ("spectrum", "Fourier series of a motion of period 1"), ("lyapunov", "of 4 exponents resolved"),
    ("rotation", "rotation number 0.22181"), ("bifurcation-diagram", "settled within"), ("basins", "100%"),
    ("attractors", "100 % (34 to 100 %)             2.30266     yes       5  period 1"),
    ("pulse", "energy closes to"), ("pulse", "by sampling of forces "), ("pulse", ", speeds "), ("bands", "cut-off 7200.22 Hz"),
])
def test_a_command_prints_its_result_in_words(command: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, *COMMANDS[command]]) == 0
    assert words in capsys.readouterr().out


@pytest.mark.parametrize(("words", "sentence"), [
    (["spectrum", *SHORT, "--force", "wall"], "force 'wall'"), (["lyapunov", *SHORT, "--periods", "3"], "outside 20 to"),
    (["rotation", *SHORT, "--periods", "3"], "periods = 3 is outside 1000 to"), (["rotation", "impact"], "drive = rest"),
    (["bifurcation-diagram", *SHORT, "--over", "f=1:2"], "must have the form KNOB=a:b:n"),
    (["bifurcation-diagram", *SHORT, "--over", "wall=1:2:3"], "knob of a bifurcation diagram 'wall'"),
    (["bifurcation-diagram", *SHORT, "--over", "f=1000:1100:2", "--bead", "3"], "--bead 3 is outside 1 to 2"),
    (["attractors", *SHORT, "--random-states", "-1"], "--random-states -1 is outside 0 to 10000"),
    (["attractors", *SHORT, "--seed", "-1"], "--seed -1 is outside 0 to"), (["attractors", "impact"], "drive = rest"),
    (["basins", *SHORT, "--x", "u9=0:1:2", "--y", "v1=0:1:2"], "Coordinate 'u9' does not exist"),
    (["pulse", "impact", "--set", "N=2"], "at least three beads"), (["bands", "sec2"], "Without a preload"),
])
def test_invalid_arguments_are_refused_with_a_sentence(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert sentence in capsys.readouterr().err


def test_a_command_works_by_its_older_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bifurcation-diagram", *COMMANDS["bifurcation-diagram"]]) == 0
    printed = capsys.readouterr().out
    assert main(["strobes", *COMMANDS["bifurcation-diagram"]]) == 0
    assert capsys.readouterr().out == printed


def test_starts_without_a_steady_state_are_counted_and_the_first_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    """Two of four starts press bead 2 a metre into the wall, and their numbers overflow immediately."""
    assert main(["basins", *SHORT, "--x", "u1=-1e-3:1e-3:2", "--y", "u2=0:1:2"]) == 0
    *_, one, without = capsys.readouterr().out.splitlines()
    assert one.startswith("  50%") and "period 1" in one
    assert without.startswith("  50%") and "no steady state: 2 of 4 starts failed, the first at u1 = -0.001, u2 = 1. " in without
    assert "The motion of bead 1 stopped being a finite number" in without


def test_attractors_are_those_of_the_function(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """JSON and file agree with the Python function for the same seed; without random states, no share is stated."""
    words = ["attractors", *SHORT, "--seed", "3", "--json"]
    assert main([*words, "--random-states", "2", "--out", str(tmp_path / "a.h5")]) == 0
    (told,) = json.loads(capsys.readouterr().out)["attractors"]
    (one,) = attractors(scene("sec2").evolve(N=2, f=2000.0), 2, seed=3)
    assert (told["max_output_force"], told["share"], told["stable"]) == (one.max_output_force, one.share, one.stable)
    assert told["starts"] == ["rest", "up", "down", "random 0", "random 1"] == [origin.name for origin in one.origins]
    with h5py.File(tmp_path / "a.h5") as file:
        assert file["attractors/max_output_force"][:].tolist() == [one.max_output_force]
    assert main([*words, "--random-states", "0"]) == 0
    (told,) = json.loads(capsys.readouterr().out)["attractors"]
    assert (told["share"], told["share_error"], told["starts"]) == (None, None, ["rest", "up", "down"])
