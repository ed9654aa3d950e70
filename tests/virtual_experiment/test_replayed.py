"""A virtual record is replayed by the model that made it: the remaining difference with known start and sensors, and
without.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from granchain_core import BadInput, Signal, drive, run, scene, settle
from granchain_core.experiment import Sensors, Series, compared_forces, read_data, read_experiment
from granchain_core.fitting.beginning import in_motion, settled_beginning
from granchain_core.store import save
from granchain_core.virtual_experiment import virtual_series_csv

RIG = scene("fig12-60")
CHAIN = scene("sec2").evolve(N=3, f=1000.0)


def relative(path: Path, *options: str, capsys: pytest.CaptureFixture[str]) -> tuple[float, str]:
    """Drive the rig with a file. Return the larger relative rms difference of the two forces, and the messages."""
    assert main(["run", "fig12-60", "--drive", str(path), "--json", *options]) == 0
    printed, said = capsys.readouterr()
    found = json.loads(printed)
    return max(found["residual_input"]["relative"], found["residual_output"]["relative"]), said


def test_perfect_sensors_leave_nothing_on_the_settled_motion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Replayed from rest, the same record differs by more than its own size, and a sentence says why."""
    path = tmp_path / "perfect.csv"
    path.write_text(virtual_series_csv(RIG, 4, Sensors(rate=20e3)), "utf-8")
    left, said = relative(path, "--start", "settled", capsys=capsys)
    assert left < 0.002 and "begins in the settled motion at drive phase" in said and "begins in motion" not in said
    left, said = relative(path, capsys=capsys)
    assert left > 1.0 and "The record begins in motion" in said


@pytest.mark.parametrize(("rate", "limit"), [(20e3, 0.005), (2e3, 0.02)])
def test_a_slow_sensor_leaves_nothing_if_its_bandwidth_is_known(
        rate: float, limit: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """At 2 kHz, the rest comes from straight lines between velocity samples. Without the bandwidth, it is over 0.2."""
    path = tmp_path / "slow.csv"
    path.write_text(virtual_series_csv(RIG, 4, Sensors(rate=rate, bandwidth=1e3)), "utf-8")
    assert relative(path, "--start", "settled", "--bandwidth", "1000", capsys=capsys)[0] < limit
    assert relative(path, "--start", "settled", capsys=capsys)[0] > 0.2


def test_a_record_that_begins_before_the_shaker_is_replayed_from_rest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The command needs no start. A slow sensor still needs its bandwidth."""
    path = tmp_path / "rest.csv"
    for bandwidth in ([], ["--bandwidth", "1000"]):
        assert main(["virtual", "fig12-60", "--rate", "20000", "--periods", "6", "--start", "rest", "--out", str(path), *bandwidth]) == 0
        assert "2000 rows" in capsys.readouterr().out
        left, said = relative(path, *bandwidth, capsys=capsys)
        assert left < 0.01 and "begins in motion" not in said
    found = read_experiment(path)
    assert isinstance(found, Series) and found.virtual and found.velocity is not None
    still = found.time < 1.0 / 60.0
    assert np.abs(found.velocity[still]).max() < 1e-4 * found.velocity.max()
    assert found.velocity.max() == pytest.approx(RIG.A0 * 120.0 * np.pi, rel=1e-3)
    for bad, sentence in ((["--start", "end"], "settled"),
                          (["--start", "rest", "--kind", "curve", "--from", "60", "--to", "60"], "--kind series")):
        assert main(["virtual", "fig12-60", *bad]) == 2
        assert sentence in capsys.readouterr().err


def test_the_inertia_of_a_tip_is_part_of_the_comparison() -> None:
    sensors = Sensors(rate=50e3, tip_mass=0.01, bandwidth=5e3)
    found = read_data(virtual_series_csv(CHAIN, 10, sensors).encode())
    assert isinstance(found, Series) and found.velocity is not None
    begin = settled_beginning(CHAIN, found, sensors)
    signal = Signal.from_velocity(found.time, found.velocity, start=begin.displacement).finer(2e-6)
    moved = drive(CHAIN, signal, begin.state)
    left = compared_forces(found, moved, sensors)["input_force"].relative
    bare = compared_forces(found, moved, Sensors(bandwidth=5e3))["input_force"].relative
    assert left is not None and bare is not None and left < 0.02 < 10.0 * left < bare


def test_measured_forces_determine_the_period_in_which_a_record_begins() -> None:
    """In a motion of period 2, the drive velocity is the same in both periods, but the state is not."""
    chain = scene("sec2").evolve(N=3, f=1900.0)
    settled = settle(chain)
    assert settled.regime.period == 2
    for seed in range(3):
        found = read_data(virtual_series_csv(chain, 6, Sensors(rate=200e3), seed).encode())
        assert isinstance(found, Series) and found.velocity is not None
        begin = settled_beginning(chain, found)
        assert "of 2" in begin.words
        moved = drive(chain, Signal.from_velocity(found.time, found.velocity, start=begin.displacement), begin.state)
        left = compared_forces(found, moved)["output_force"].relative
        assert left is not None and left < 0.05


def test_a_displacement_determines_the_phase_as_a_velocity_does() -> None:
    time, omega = np.linspace(0.0, 5e-3, 501), 2e3 * np.pi
    moving = Series(time, CHAIN.A0 * omega * np.cos(omega * time + 1.0), None, None, "made")
    standing = Series(time, None, None, None, "made", displacement=3e-7 + CHAIN.A0 * np.sin(omega * time + 1.0))
    one, other = settled_beginning(CHAIN, moving), settled_beginning(CHAIN, standing)
    assert one.state.phase == pytest.approx(1.0 / (2.0 * np.pi)) == other.state.phase
    assert one.displacement == pytest.approx(CHAIN.A0 * np.sin(1.0)) == other.displacement


def test_a_record_may_begin_with_a_recorded_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The second half of a motion from rest starts where the file of the first half ends."""
    whole = run(CHAIN, periods=0, record=6, samples=400)
    half = 3 * 400
    time = whole.time[half:] - whole.time[half]
    velocity = CHAIN.A0 * 2e3 * np.pi * np.cos(2e3 * np.pi * whole.time[half:])
    rows = zip(time, velocity, whole.input_force[half:], whole.output_force[half:], strict=True)
    (tmp_path / "rest.csv").write_text("time (s),velocity (m/s),input force (N),output force (N)\n" + "".join(
        ",".join(f"{one:.12e}" for one in row) + "\n" for row in rows), "utf-8")
    first = run(CHAIN, periods=0, record=3, samples=400)
    save(first, tmp_path / "first.h5")
    words = ["run", "sec2", "--set", "N=3", "--set", "f=1000", "--drive", str(tmp_path / "rest.csv"), "--json"]
    assert main([*words, "--start", str(tmp_path / "first.h5")]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert "first.h5" in printed["start"] and printed["bandwidth"] is None
    # straight lines between 400 samples per period; the input force has jumps, which may fall on either side of a
    # sample
    assert printed["residual_output"]["relative"] < 0.01
    assert main(words) == 0
    from_rest = json.loads(capsys.readouterr().out)
    assert from_rest["start"] == "rest" and from_rest["residual_output"]["relative"] > 0.1
    assert main(["run", "sec2", "--set", "N=2", "--drive", str(tmp_path / "rest.csv"), "--start", str(tmp_path / "first.h5")]) == 2
    assert "add --set N=3" in capsys.readouterr().err


def test_a_record_that_begins_at_rest_is_not_warned_of() -> None:
    time = np.linspace(0.0, 1.0, 9)
    force = np.r_[0.0, 0.0, np.ones(7)]
    assert in_motion(Series(time, force, force, force, "made"), 0.0) == ""
    assert in_motion(Series(time, None, None, force + 2.0, "made"), 2.0) == ""
    assert "first sample of its input force" in in_motion(Series(time, force, force[::-1], force, "made"), 0.0)


@pytest.mark.parametrize(("chain", "series", "words"), [
    (CHAIN, Series(np.linspace(0.0, 1.0, 9), None, None, np.zeros(9), "made"), "neither velocity nor displacement"),
    (CHAIN, Series(np.linspace(0.0, 5e-3, 501), np.cos(3e3 * np.linspace(0.0, 5e-3, 501)), None, None, "made"),
     "is not a sine of f = 1000 Hz"),
    (CHAIN.evolve(dissipation="none"),
     Series(np.linspace(0.0, 5e-3, 501), np.cos(2e3 * np.pi * np.linspace(0.0, 5e-3, 501)), None, None, "made"),
     "a drive phase does not determine its state"),
    (scene("impact"), Series(np.linspace(0.0, 1.0, 9), np.zeros(9), None, None, "made"), "drive")])
def test_records_without_a_settled_beginning_are_refused(chain, series: Series, words: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInput, match=words):
        settled_beginning(chain, series)


@pytest.mark.parametrize(("words", "sentence"), [
    (["run", "sec2", "--start", "settled"], "--start is for --drive"),
    (["run", "sec2", "--bandwidth", "1000"], "--bandwidth is for --drive FILE"),
    (["run", "sec2", "--drive", "burst=300:3:0.1", "--start", "settled"], "--start is for --drive FILE"),
    (["fit", "sec2", "--features", "paper", "--bandwidth", "1e3", "--free", "D=50:200"], "--bandwidth is for a series")])
def test_the_options_are_refused_where_they_mean_nothing(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert sentence in capsys.readouterr().err


def test_a_fit_through_a_slow_sensor_finds_the_truth(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "slow.csv"
    path.write_text(virtual_series_csv(CHAIN, 6, Sensors(noise=0.005, bandwidth=3e3)), "utf-8")
    words = ["fit", "sec2", "--set", "N=3", "--set", "f=1000", "--data", str(path), "--error", "0.005", "--free", "D=60:160", "--json"]
    assert main([*words, "--bandwidth", "3000"]) == 0
    known = json.loads(capsys.readouterr().out)
    assert known["verdict"] == "can" and known["parameters"][0]["low"] < 100.0 < known["parameters"][0]["high"]
    assert main([*words, "--no-intervals"]) == 0
    assert json.loads(capsys.readouterr().out)["verdict"] == "cannot"


def test_an_observer_compares_through_the_sensor(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Only the record's output was filtered. With a known bandwidth, coarse samples do not count as a missed pulse."""
    true = run(CHAIN, periods=0, record=4, samples=1000)
    slow = Sensors(bandwidth=2e3)
    out = slow.passed(true.time, true.output_force, true.time)
    path = tmp_path / "force.csv"
    path.write_text("time_s,force_N,output_force_N\n" + "".join(
        f"{t:.9e},{i:.9e},{o:.9e}\n" for t, i, o in zip(true.time, true.input_force, out, strict=True)), "utf-8")
    found = []
    for options in ([], ["--bandwidth", "2000"]):
        assert main(["observe", "sec2", "--set", "N=3", "--input", str(path), "--json", *options]) == 0
        found.append(json.loads(capsys.readouterr().out))
    assert found[0]["bandwidth"] is None and found[1]["bandwidth"] == 2e3
    assert found[1]["residual"]["relative"] < 0.02 < 0.2 < found[0]["residual"]["relative"]
    coarse = tmp_path / "coarse.csv"
    coarse.write_text("time_s,force_N\n" + "".join(f"{i * 1e-4:.4g},{max(0.0, np.sin(i * 0.4)):.6g}\n" for i in range(40)), "utf-8")
    assert main(["observe", "sec2", "--set", "N=3", "--input", str(coarse)]) == 2
    assert "may be as short as" in capsys.readouterr().err
    assert main(["observe", "sec2", "--set", "N=3", "--input", str(coarse), "--bandwidth", "1000"]) == 0
    assert isinstance(read_experiment(path), Series)
