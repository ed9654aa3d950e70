"""A measured motion drives the chain, and the forces in its file are compared with the computed ones."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure
from sine import CHAIN, sine

import granchain
from app.cli import main
from granchain_core import Driven, Signal, drive
from granchain_core.experiment import Series, read_experiment


def test_a_measured_velocity_or_displacement_drives_the_chain(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Both files give the motion of the formula they were written from. The result is saved with units."""
    omega, time = 2.0 * np.pi * 900.0, np.linspace(0.0, 0.004, 801)
    rows = {"velocity": (CHAIN.A0 * omega * np.cos(omega * time), "m/s"), "displacement": (CHAIN.A0 * np.sin(omega * time), "m")}
    exact = drive(CHAIN, sine(CHAIN.A0, 900.0, 3.6)).max_output_force_elastic
    for name, (values, unit) in rows.items():
        path = tmp_path / f"{name}.csv"
        path.write_text(f"time (s),{name} ({unit})\n" + "".join(f"{t:.12e},{x:.12e}\n" for t, x in zip(time, values, strict=True)), "utf-8")
        out = tmp_path / f"{name}.h5"
        assert main(["run", "sec2", "--set", "N=3", "--drive", str(path), "--json", "--out", str(out)]) == 0
        printed = json.loads(capsys.readouterr().out)
        # at 222 samples per period, the trapezoidal rule for the velocity is (2π/222)²/12 = 7e-5 too small
        assert printed["max_output_force_elastic"] == pytest.approx(exact, rel=5e-4) and name in printed["drive"]
        with h5py.File(out) as file:
            assert file["driven/drive_displacement"].attrs["units"] == "m" and len(file["driven/time"]) >= 801


def recorded(path: Path, offset: float = 0.0, title: str = "velocity (mm/s),input force (mN),output force (N)") -> Driven:
    """Write the velocity and both forces of a computed motion to a file, the output force with an offset [N].

    Returns the motion.
    """
    time = np.linspace(0.0, 3.6 / 900.0, 801)
    found = drive(CHAIN, Signal.from_velocity(time, 2.0 * np.pi * 900.0 * CHAIN.A0 * np.cos(2.0 * np.pi * 900.0 * time)))
    rows = zip(time, found.signal.velocity * 1e3, found.input_force * 1e3, found.output_force + offset, strict=True)
    path.write_text(f"time (s),{title},temperature\n" + "".join(",".join(f"{one:.15e}" for one in row) + ",20\n" for row in rows), "utf-8")
    return found


def test_forces_in_a_file_of_a_drive_are_compared(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file has the computed forces in other units. The only difference is one sensor's offset, which is kept."""
    path, out, picture = tmp_path / "rig.csv", tmp_path / "rig.h5", tmp_path / "rig.html"
    recorded(path, offset=-0.25)
    words = ["run", "sec2", "--set", "N=3", "--drive", str(path)]
    assert main([*words, "--json", "--out", str(out), "--picture", str(picture)]) == 0
    printed, said = capsys.readouterr()
    found = json.loads(printed)
    assert found["residual_input"]["largest"] < 1e-12 and found["residual_input"]["compared"] == 801
    assert [found["residual_output"][name] for name in ("rms", "largest", "mean")] == pytest.approx([0.25] * 3)
    assert "left out: temperature" in said and "temperature" in found["understood"] and "input force in mN" in said
    assert "The velocity moves the driver; the measured input and output force are compared with the computed ones" in said
    assert "No offset of a sensor is subtracted." in said and "thin: measured" in picture.read_text("utf-8")
    with h5py.File(out) as file:
        assert {"input_force", "output_force", "drive_velocity"} <= set(file["measured"])
    assert main(words) == 0
    assert "output force, model − measured at 801 of 801 samples: rms 0.25 N" in capsys.readouterr().out


def test_a_file_without_forces_and_a_formula_have_nothing_to_compare(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, time = tmp_path / "both.csv", np.linspace(0.0, 2e-3, 201)
    rows = "".join(f"{t:.9f},{1e-3 * np.sin(6e3 * t):.9e},0\n" for t in time)
    path.write_text("time (s),velocity (m/s),displacement (m)\n" + rows, "utf-8")
    for words, sentence in ((str(path), "the file has no force to compare. The displacement is not used."),
                            ("burst=2000:2:0.002", "burst")):
        assert main(["run", "sec2", "--set", "N=3", "--drive", words, "--json"]) == 0
        printed, said = capsys.readouterr()
        found = json.loads(printed)
        assert (found["residual_input"], found["residual_output"]) == (None, None) and sentence in said
    assert found["understood"] is None


def test_one_measured_force_is_drawn_beside_the_computed_one_and_within_its_axis(tmp_path: Path) -> None:
    found = recorded(tmp_path / "rig.csv", offset=50.0)
    measured = read_experiment(tmp_path / "rig.csv")
    assert isinstance(measured, Series)
    drawn = granchain.figure(found, measured=replace(measured, input_force=None))
    source = drawn.select_one({"name": "measured output", "type": ColumnDataSource})
    assert drawn.select_one({"name": "measured drive"}) is None and source.data["force"].min() >= 49.0
    assert drawn.select_one({"name": "output", "type": figure}).x_range.end > source.data["force"].max()
    assert granchain.figure(found).select_one({"name": "measured output"}) is None
