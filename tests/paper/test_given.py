"""A user's files for a figure are read or refused with a line number, and a series is put in phase."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from granchain_core import BadInput, scene
from granchain_core.experiment import Measured, Series, Shaker, read_experiment
from granchain_core.paper import compute, figure_of, read_given
from granchain_core.paper.computations import column
from granchain_core.paper.results import SHOWN


def written(folder: Path, text: str) -> str:
    """Write this text to a file and return its name."""
    path = folder / "data.csv"
    path.write_text(text, encoding="utf-8")
    return str(path)


def lines(header: str, rows: int = 12) -> str:
    """Return a header and some rows of ascending numbers."""
    width = header.count(",") + 1
    return header + "\n" + "".join(",".join(str(i + 1) for _ in range(width)) + "\n" for i in range(rows))


def test_the_first_line_gives_quantities_and_units_of_a_file(tmp_path: Path) -> None:
    series = read_experiment(written(tmp_path, lines("time (ms),velocity (mm/s),input_force_mN")))
    assert isinstance(series, Series) and series.output_force is None
    assert series.time[1] == pytest.approx(1e-3) and series.velocity is not None and series.velocity[0] == pytest.approx(1e-3)
    assert series.input_force is not None and series.input_force[2] == pytest.approx(3e-3)
    shaker = read_experiment(written(tmp_path, "Frequency (kHz);displacement (µm)\n0,1;8\n0,05;7,5\n"))
    assert isinstance(shaker, Shaker) and list(shaker.frequency) == [50.0, 100.0]
    assert shaker.displacement == pytest.approx([7.5e-6, 8e-6])
    assert isinstance(read_experiment(written(tmp_path, "frequency_Hz,force_N\n50,1\n60,2\n")), Measured)


@pytest.mark.parametrize(("text", "said"), [
    ("1,2\n3,4\n", "The columns have no titles"),
    (lines("time_s"), "has no column separator"),
    (lines("time_s,colour"), "What 'colour' holds is not clear"),
    (lines("time,velocity_m_s"), "Column 'time' has no unit"),
    ("time_s,velocity_m_s\n" + "".join(f"{t},1\n" for t in (0, 1, 2, 3, 3, 4, 5, 6, 7, 8, 9)), "Line 6: time 3 s does not come after"),
    ("frequency_Hz,velocity_m_s\n50,1\n0,1\n", "Line 3: a frequency must be above 0"),
    ("frequency_Hz,velocity_m_s\n50,1\n60,abc\n", "Line 3: 'abc' is not a number"),
])
def test_ambiguous_files_are_refused(text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"data\.csv") as problem:
        read_experiment(written(tmp_path, text))
    assert said in str(problem.value)


@pytest.mark.parametrize(("number", "header", "files", "said"), [
    ("11", "time_s,velocity_m_s", ("{}",), "Figure 11 shows nothing that was measured"),
    ("5", "time_s,velocity_m_s", ("{}",), "Figure 5 takes the shaker's amplitude"),
    ("12", "time_s,velocity_m_s", ("{}",), "say to which"),
    ("12", "time_s,velocity_m_s", ("70={}",), "no series at 70 Hz; it has 60, 90, 100 Hz, the nearest is 60"),
    ("12", "time_s,velocity_m_s", ("60={}", "60={}"), "Two series are given for 60 Hz"),
    ("5", "frequency_Hz,velocity_m_s", ("{}", "{}"), "Two files hold"),
])
def test_a_figure_says_which_files_it_takes(number: str, header: str, files: tuple[str, ...], said: str, tmp_path: Path) -> None:
    name, figure = written(tmp_path, lines(header)), figure_of(number)
    with pytest.raises(BadInput, match=said):
        read_given(number, figure.takes, figure.frequencies, [one.format(name) for one in files])


def test_a_missing_file_is_reported() -> None:
    with pytest.raises(BadInput, match=r"Cannot read none\.csv"):
        read_experiment("none.csv")


def recorded(periods: int, late: float) -> Series:
    """Return trains of model (5) at 90 Hz over some periods, begun `late` seconds later, as if they were measured."""
    found = column(90.0, None, False, None)
    time = np.arange(periods * 960) / (960 * 90.0)
    phase = np.mod(time + late, 1.0 / 90.0)
    own = found.time[:961]
    return Series(time, *(np.interp(phase, own, values[:961]) for values in (
        found.velocity, found.input_force, found.output_force)), "a recording")


@pytest.mark.parametrize("late", [0.0, 0.0033, 0.0100])
@pytest.mark.parametrize("only", ["input force", "velocity"])
def test_a_series_is_put_in_phase(late: float, only: str) -> None:
    """The model's own trains, cut anywhere, coincide with the model, to the interpolation error of 1e-3 of the largest.
    """
    series = recorded(20, late)
    if only == "velocity":
        series = Series(series.time, series.velocity, None, series.output_force, "")
    found = column(90.0, series, False, None)
    measured = found.measured
    assert measured is not None and measured.velocity is not None and measured.output_force is not None
    assert measured.time[0] < 1e-4 and measured.time[-1] > SHOWN - 1.0 / 90.0 - 1e-4
    model = np.interp(measured.time, found.time, found.velocity)
    assert np.abs(measured.velocity - model).max() < 1e-3 * np.abs(model).max()
    forces = np.interp(measured.time, found.time, found.output_force)
    assert np.sqrt(np.mean((measured.output_force - forces) ** 2)) < 0.02 * forces.max()


def test_model_3_is_fed_with_the_measured_force() -> None:
    """With model (5)'s own force, it approaches that motion from rest: at 90 Hz by a factor of 0.57 per period, here
    over 21 periods.
    """
    found = column(90.0, recorded(30, 0.0), True, None)
    assert found.observer is not None and found.observer_time is not None and "measured" in found.observer_words
    model = np.interp(found.observer_time, found.time, found.output_force)
    assert np.sqrt(np.mean((found.observer - model) ** 2)) < 0.02 * model.max()
    without = Series(np.arange(20.0), np.zeros(20), None, None, "")
    with pytest.raises(BadInput, match="no column input_force_N"):
        column(90.0, without, True, None)


def test_data_reaches_the_result(tmp_path: Path) -> None:
    figure = figure_of("5")
    given = read_given("5", figure.takes, figure.frequencies, [written(tmp_path, "frequency_Hz,velocity_mm_s\n50,2\n60,2.5\n")])
    rows = [row for row in compute("5", given).rows() if row["source"] == "measured"]
    assert [row["frequency_Hz"] for row in rows] == [50.0, 60.0]
    assert rows[0]["displacement_m"] == pytest.approx(2e-3 / (2 * np.pi * 50.0))
    assert given.sentences == ["data.csv: 2 amplitudes of velocity from 50 to 60 Hz; frequency in Hz, velocity in mm/s; "
                               "columns separated by commas, decimal point"]
    assert scene("rig").A0 in {row["displacement_m"] for row in compute("5").rows()}
