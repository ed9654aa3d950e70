"""A0 as a function of frequency: formulas, tables, refused input, and use in curves, maps and branches."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli import main
from granchain_core import Amplitude, BadInput, branch, parameter_map, resonance_curve, scene, settle
from granchain_core.experiment import read_amplitude
from granchain_core.parameter_maps import Grid
from granchain_core.parameter_maps.scheduled import describe
from granchain_core.steady.curve.curve import Curve
from granchain_core.store import load_branch, save_branch, save_curve
from granchain_core.store.curves import load_curve
from granchain_core.store.parameter_maps import load_parameter_map, save_parameter_map

CHAIN = scene("sec2").evolve(N=2)


@pytest.mark.parametrize(("formula", "value", "expected"), [
    ("constant-displacement", 7e-6, 7e-6), ("constant-velocity", 3e-3, 3e-3 / (2 * np.pi * 60)),
    ("constant-acceleration", 1.5, 1.5 / (2 * np.pi * 60) ** 2)])
def test_a_formula_gives_the_amplitude_of_constant_velocity_or_acceleration(formula: str, value: float, expected: float) -> None:
    assert Amplitude(formula, (value,)).at(60.0) == pytest.approx(expected)
    assert read_amplitude(f"{formula}={value}") == Amplitude(formula, (value,))


def test_a_table_is_straight_between_and_ends_where_it_ends(tmp_path: Path) -> None:
    path = tmp_path / "shaker.csv"
    path.write_text("f [Hz];A0 [µm]\n100;6\n50;8\n", encoding="utf-8")
    table = read_amplitude(str(path))
    assert table.at(75.0) == pytest.approx(7e-6) and table.at(50.0) == pytest.approx(8e-6)
    with pytest.raises(BadInput, match=r"from 50 to 100 Hz, not at 101 Hz; the nearest valid value is 100"):
        table.at(101.0)
    assert "A0 from 6 to 8 µm over 2 frequencies of shaker.csv" in table.words


@pytest.mark.parametrize(("text", "sentence"), [
    ("constant-speed=1", "Unknown drive 'constant-speed'"), ("constant-velocity=fast", "is not a number in m/s"),
    ("constant-velocity=0", "is 0 m/s; it must be a number above 0"), ("none.csv", "Cannot read")])
def test_a_malformed_amplitude_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        read_amplitude(text)


@pytest.mark.parametrize(("data", "sentence"), [
    (None, "has formula, values"), ({}, "has formula, values"),
    ({"formula": "table", "values": [1e-6], "frequencies": [], "source": ""}, "as many amplitudes as frequencies"),
    ({"formula": 1, "values": [1e-6], "frequencies": [], "source": ""}, "has a formula, numbers"),
    ({"formula": "table", "values": [True, 2.0], "frequencies": [1, 2], "source": ""}, "has a formula, numbers"),
    ({"formula": "table", "values": [1e-6, 1e-6], "frequencies": [2, 1], "source": ""}, "which ascend")])
def test_a_damaged_description_is_refused(data: Any, sentence: str) -> None:
    with pytest.raises(BadInput, match=sentence):
        Amplitude.from_json(data)


def test_every_point_has_its_own_amplitude() -> None:
    """Each point is the same as in a curve of its own with that amplitude. k does not change."""
    drive = Amplitude.table([1800.0, 2000.0], [4e-7, 6e-7])
    curve = resonance_curve(CHAIN, [1800.0, 1900.0, 2000.0], amplitude=drive)
    assert list(curve.drive_amplitude) == pytest.approx([4e-7, 5e-7, 6e-7])
    for point, a in zip(curve.points, curve.drive_amplitude, strict=True):
        alone = resonance_curve(CHAIN.evolve(A0=a), [point.frequency]).points[0]
        assert point.max_output_force == pytest.approx(alone.max_output_force, rel=1e-9)


def test_the_amplitude_is_saved_with_the_curve(tmp_path: Path) -> None:
    drive = Amplitude("constant-velocity", (6e-3,))
    curve = resonance_curve(CHAIN, [1800.0, 2000.0], amplitude=drive)
    save_curve(curve, tmp_path / "a.h5")
    again = load_curve(tmp_path / "a.h5")
    assert again.amplitude == drive and list(again.drive_amplitude) == list(curve.drive_amplitude)
    plain = Curve(CHAIN, "rest", curve.points)
    save_curve(plain, tmp_path / "b.h5")
    assert load_curve(tmp_path / "b.h5").amplitude is None


def test_the_command_line_takes_an_amplitude_and_resumes_with_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["curve", "sec2", "--set", "N=2", "--from", "1800", "--to", "2000", "--points", "3", "--json", "--out", str(tmp_path / "a.h5")]
    assert main([*words, "--amplitude", "constant-velocity=6e-3"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["drive_amplitude"] == pytest.approx([6e-3 / (2 * np.pi * f) for f in printed["frequency"]])
    assert main([*words, "--amplitude", "constant-velocity=6e-3", "--resume"]) == 0
    assert "already finished" in capsys.readouterr().err
    assert main([*words, "--amplitude", "constant-velocity=7e-3", "--resume"]) == 2
    assert "a finished curve that was computed with other options" in capsys.readouterr().err


def test_a_question_about_an_amplitude_file_shows_its_rows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "shaker.csv"
    path.write_text("1.8;5\n2.0;6\n", encoding="utf-8")
    words = ["curve", "sec2", "--set", "N=2", "--from", "1800", "--to", "2000", "--points", "2", "--amplitude", str(path)]
    assert main(words) == 2
    asked = capsys.readouterr().err
    assert "line 1" in asked and "1.8" in asked and "--column" in asked
    assert main([*words, "--column", "f=1:kHz", "--column", "A0=2:nm", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["drive_amplitude"] == pytest.approx([5e-9, 6e-9])


DRIVE = Amplitude.table([1900.0, 2000.0, 2100.0], [4e-7, 5e-7, 5.5e-7], "a shaker")


def test_a_map_drives_each_frequency_with_its_amplitude(tmp_path: Path) -> None:
    """Each cell equals that of a map at its amplitude. The file restores the amplitude, and the digest depends on it.
    """
    axes = ("f", [1900.0, 2000.0]), ("D", [80.0, 100.0])
    found = parameter_map(CHAIN, *axes, amplitude=DRIVE)
    for f in (1900.0, 2000.0):
        alone = parameter_map(CHAIN.evolve(A0=DRIVE.at(f)), ("f", [f]), axes[1]).column("max_output_force")[:, 0]
        np.testing.assert_array_equal(found.column("max_output_force")[:, axes[0][1].index(f)], alone)
    again = load_parameter_map(save_parameter_map(found, tmp_path / "a.h5"))
    assert again.grid == found.grid and again.grid.amplitude == DRIVE
    assert found.grid.digest != replace(found.grid, amplitude=None).digest
    assert Grid(**{**vars(found.grid), "amplitude": Amplitude.from_json(describe(found.grid)["amplitude"])}) == found.grid


def test_a_branch_follows_its_amplitude_and_keeps_it(tmp_path: Path) -> None:
    """The ends of the branch are the orbits at these frequencies and amplitudes."""
    found = branch(CHAIN, "f", 2000.0, 2100.0, amplitude=DRIVE)
    for point in (found.points[0], found.points[-1]):
        alone = settle(CHAIN.evolve(f=point.knob, A0=DRIVE.at(point.knob))).run.max_output_force_elastic
        assert point.max_output_force_elastic == pytest.approx(alone, rel=1e-5)  # the settled orbit's accuracy is 1e-6
    assert load_branch(save_branch(found, tmp_path / "a.h5")).axis == found.axis


@pytest.mark.parametrize(("words", "sentence"), [
    (["map", "sec2", "--x", "D=1:2:2", "--y", "F0=1:2:2"], "make f a knob"),
    (["map", "sec2", "--x", "f=1900:2000:2", "--y", "A0=1e-7:2e-7:2"], "A0 cannot vary independently"),
    (["branch", "sec2", "--knob", "D", "--from", "1", "--to", "2"], "make f a knob"),
])
def test_knobs_that_contradict_a_given_amplitude_are_refused(words: list[str], sentence: str, tmp_path: Path,
                                                  capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*words, "--amplitude", "constant-velocity=6e-3", "--out", str(tmp_path / "a.h5")]) == 2
    assert sentence in capsys.readouterr().err
