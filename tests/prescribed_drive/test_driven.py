"""Drives other than the harmonic one: kernel against harmonic runs and closed forms, signals against their formulas."""

from __future__ import annotations

import functools
import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

import granchain
from app.cli import main
from app.cli.driven import _fine_enough
from granchain_core import BadInput, Driven, Run, Signal, drive, run, scene
from granchain_core.errors import Cancelled
from granchain_core.execution.stop import Stop
from granchain_core.experiment import Sensors, Series, read_experiment
from granchain_core.prescribed_drive.moved_chain import MovedChain
from granchain_core.prescribed_drive.signal import KNOTS
from granchain_core.scene.state import rest

CHAIN = scene("sec2").evolve(N=3)


def sine(amplitude: float, frequency: float, periods: float) -> Signal:
    """Return the harmonic drive as a signal."""
    omega = 2.0 * np.pi * frequency
    return Signal.of(lambda t: amplitude * omega * np.cos(omega * t), lambda t: amplitude * np.sin(omega * t),
                     periods / frequency, frequency, "sine")


def test_a_sine_moves_the_chain_as_the_harmonic_drive_does() -> None:
    """A prescribed sine uses another drive slot and another loop, and gives the same displacements and largest forces.
    """
    found = drive(CHAIN, sine(CHAIN.A0, CHAIN.f, 6))
    exact = run(CHAIN, periods=0, record=6, samples=400)
    assert found.status == "done" and found.energy_residual < 1e-5
    # the signal's velocity is off by (2π/400)²/12 = 2e-5, its displacement by 4e-8, and each of the motions by 1e-6
    np.testing.assert_allclose(found.displacement, exact.displacement, atol=5e-6 * np.abs(exact.displacement).max())
    assert found.max_output_force_elastic == pytest.approx(exact.max_output_force_elastic, rel=2e-5)
    assert found.max_input_force == pytest.approx(exact.max_input_force, rel=1e-4)  # the dashpot feels the velocity


def test_errors_and_energy_are_those_of_finer_computations() -> None:
    """For a chirp through the first resonance, stated errors cover the difference from a run 1,000 times as accurate.
    """
    signal = Signal.chirp(CHAIN.A0, 800.0, 1600.0, 0.01)
    rough, fine = drive(CHAIN.evolve(accuracy=1e-5), signal), drive(CHAIN.evolve(accuracy=1e-8), signal)
    difference = np.abs(rough.displacement - fine.displacement).max() / np.abs(fine.displacement).max()
    assert difference <= rough.displacement_error <= 1e-5
    assert fine.energy_residual < 1e-7 and fine.energy_residual < rough.energy_residual
    assert abs(rough.max_output_force - fine.max_output_force) <= rough.force_errors.output * fine.max_output_force


def test_a_driver_at_constant_velocity_gives_a_free_bead_the_speed_of_a_collision() -> None:
    """Without damping, a heavy body at speed v throws a bead forward at 2v (one bead, a wall too soft to matter)."""
    chain = scene("sec2").evolve(N=1, dissipation="none", wall=1e-6)
    time = np.linspace(0.0, 2e-3, 2001)
    found = drive(chain, Signal.from_velocity(time, np.full(2001, 1e-3)))
    # the wall, a millionth as stiff, slows the bead by less than √(K_wall δ^{5/2}/m v²) with δ = 4 µm: 1e-4
    assert found.velocity[300:600].max() == pytest.approx(2e-3, rel=1e-3)


@pytest.mark.parametrize(("signal", "formula"), [
    (Signal.chirp(1.0, 100.0, 300.0, 0.05), lambda t: np.sin(2 * np.pi * (100 * t + 2000 * t**2))),
    (Signal.burst(1.0, 100.0, 5, 0.08),
     lambda t: np.where(t < 0.05, np.sin(200 * np.pi * t) * np.sin(20 * np.pi * t) ** 2, 0.0)),
    (Signal.tones(1.0, 100.0, 130.0, 0.05, 0.5),
     lambda t: (np.sin(200 * np.pi * t) + 0.5 * np.sin(260 * np.pi * t)) / 1.5)])
def test_signals_follow_their_formulas(signal: Signal, formula) -> None:  # type: ignore[no-untyped-def]
    """Signals agree with their formulas at the knots and, through the quadratics, between them."""
    pieces, half = signal.quadratics(), 0.5 * np.diff(signal.time)
    between = pieces[:, 0] + half * (pieces[:, 1] + half * pieces[:, 2])
    # three corrections leave 1e-9 of a kink at the knots; between them the error is (2π/400)³ · 0.008 = 3e-8
    np.testing.assert_allclose(signal.displacement, formula(signal.time), atol=1e-9)
    np.testing.assert_allclose(between, formula(signal.time[:-1] + half), atol=signal.displacement_error)
    assert signal.displacement_error < 4e-8


@pytest.mark.parametrize("accuracy", [1e-6, 1e-8, 1e-10])
def test_the_largest_forces_of_a_sine_are_within_their_errors_of_the_harmonic_run(accuracy: float) -> None:
    """The harmonic run uses another driver and another method, with errors below 1e-9."""
    found = drive(CHAIN.evolve(accuracy=accuracy), sine(CHAIN.A0, CHAIN.f, 3))
    exact = run(CHAIN.evolve(accuracy=1e-10), periods=0, record=3, samples=4)
    errors = found.force_errors
    for name, stated in (("max_input_force", errors.input), ("max_output_force", errors.output),
                         ("max_output_force_elastic", errors.elastic)):
        assert abs(getattr(found, name) / getattr(exact, name) - 1.0) <= stated + 1e-9
    # the dashpot of contact 0, which contributes part of the force, feels the velocity error of 2e-5
    assert 1e-7 < errors.input < 2e-5


#: One signal for each dissipation law.
FORMULAS: dict[str, Callable[[], Signal]] = {
    "linear": lambda: Signal.chirp(CHAIN.A0, 300.0, 600.0, 0.02),
    "tsuji": lambda: Signal.tones(CHAIN.A0, 700.0, 1103.0, 0.007, 0.3),
    "none": lambda: Signal.tones(CHAIN.A0, 700.0, 1103.0, 0.004, 0.3)}


@functools.cache
def with_fine_knots(law: str) -> Driven:
    """Return the chain with this law, driven by its signal with 16 times as many knots. Computed once per law."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("granchain_core.prescribed_drive.signal.KNOTS", 16 * KNOTS)
        return drive(CHAIN.evolve(dissipation=law, accuracy=1e-10), FORMULAS[law]())


@pytest.mark.parametrize("accuracy", [1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("law", FORMULAS)
def test_the_error_of_the_largest_input_force_includes_that_of_the_knots(law: str, accuracy: float) -> None:
    """Stated errors cover the difference from 16 times as many knots, where the velocity error is 1/256 as large."""
    found, fine = drive(CHAIN.evolve(dissipation=law, accuracy=accuracy), FORMULAS[law]()), with_fine_knots(law)
    wrong = abs(found.max_input_force / fine.max_input_force - 1.0)
    stated = found.force_errors.input
    assert stated is not None and fine.force_errors.input is not None
    assert wrong <= stated + fine.force_errors.input
    # the bound combines the largest velocity error with the largest damping: observed, 5 to 30 times the actual error
    assert stated <= 100.0 * max(wrong, accuracy)
    assert (found.status == "done") == (found.displacement_error <= accuracy)


def test_a_burst_with_a_kink_at_its_end_leaves_the_driver_where_it_was() -> None:
    """Its velocity has a kink between two knots. Without corrections, the driver ended 5e-7 of its amplitude away."""
    signal = Signal.burst(1.0, 2000.0, 2.3, 0.004)
    assert abs(signal.displacement[-1]) < 1e-12  # rounding of a sum of 6400 terms
    assert signal.velocity_error < 2e-4 * np.abs(signal.velocity).max()


def test_a_motion_that_is_given_at_knots_has_no_error_of_its_own() -> None:
    signal = Signal.from_velocity([0.0, 1e-4, 2e-4], [0.0, 1e-3, 1e-3])
    assert signal.velocity_error == 0.0 and signal.displacement_error == 0.0


SAMPLED = scene("sec2").evolve(f=340.0)
OMEGA = 2.0 * np.pi * SAMPLED.f


def samples(kind: str, time: np.ndarray) -> np.ndarray:
    """Return the velocity or displacement of the harmonic drive at these times."""
    return SAMPLED.A0 * (OMEGA * np.cos(OMEGA * time) if kind == "velocity" else np.sin(OMEGA * time))


def sampled(kind: str, time: np.ndarray, **how: object) -> Signal:
    """Return the signal made from samples at these times."""
    make = Signal.from_velocity if kind == "velocity" else Signal.from_displacement
    return make(time, samples(kind, time), **how)  # type: ignore[arg-type]


def written(path: Path, kind: str, time: np.ndarray) -> str:
    """Write a CSV file with these samples under a header line and return its path."""
    rows = "".join(f"{t:.12e},{x:.12e}\n" for t, x in zip(time, samples(kind, time), strict=True))
    path.write_text(f"time (s),{kind} ({'m/s' if kind == 'velocity' else 'm'})\n{rows}", "utf-8")
    return str(path)


@pytest.fixture(scope="module")
def harmonic() -> Run:
    """Seventeen periods under the harmonic drive, accurate to 1e-8."""
    return run(SAMPLED.evolve(accuracy=1e-8), periods=0, record=17, samples=400)


@pytest.mark.parametrize("kind", ["velocity", "displacement"])
@pytest.mark.parametrize("count", [4, 5, 10, 20, 100, 400])
def test_the_error_of_sampling_a_drive_is_stated(kind: str, count: int, harmonic: Run) -> None:
    """Compare with the harmonic run. With 4 velocity samples per period, every second one gives the same lines."""
    found = drive(SAMPLED, sampled(kind, np.arange(17 * count + 1) / (count * SAMPLED.f)))
    every = (8 if kind == "displacement" else 1) * count // math.gcd(400, count)  # instants in both records
    moved, true = found.displacement[::every], harmonic.displacement[:: 400 // math.gcd(400, count)]
    assert np.abs(moved - true).max() <= found.displacement_error * np.abs(true).max()
    errors = found.force_errors
    for name, stated in (("max_input_force", errors.input), ("max_output_force", errors.output),
                         ("max_output_force_elastic", errors.elastic)):
        wrong = abs(getattr(found, name) / getattr(harmonic, name) - 1.0)
        assert stated is not None and wrong <= stated
        if count == 400:
            assert stated < 1e-4
    assert found.status == "accuracy-not-reached" and found.interpolation_error > 0.7 * found.displacement_error


@pytest.mark.parametrize("kind", ["velocity", "displacement"])
def test_an_exact_motion_of_the_driver_has_no_sampling_error(kind: str) -> None:
    """Coarse or uneven times then make no difference. A formula has no samples either."""
    time = np.r_[0.0:0.01:1e-4, 0.02:0.03:1e-4]
    exact = sampled(kind, time, exact=True)
    assert exact.coarser == ()
    found = drive(CHAIN, exact)
    assert found.interpolation_error == 0.0 and found.status == "done"
    assert drive(CHAIN, Signal.burst(CHAIN.A0, 2000.0, 2, 0.002)).interpolation_error == 0.0


def test_the_order_is_two_for_a_smooth_velocity_and_one_for_jumps() -> None:
    time = np.linspace(0.0, 0.01, 401)
    assert sampled("velocity", time).order == pytest.approx(2.0, abs=0.01)
    assert Signal.from_velocity(time, np.where(time % 0.0037 < 0.0021, 1e-3, -1e-3)).order < 1.3


@pytest.mark.parametrize(("kind", "choice"), [("velocity", "choose zero (no velocity in it) or interpolate (a straight line across it)"),
                                              ("displacement", "choose interpolate (a smooth curve across it)")])
def test_a_gap_in_a_measured_motion_is_refused_with_its_line(
        kind: str, choice: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The sentence of `granchain observe`; Python says the sample."""
    time = np.delete(np.arange(0.0, 0.01, 1e-5), np.s_[50:450])
    path = written(tmp_path / "gap.csv", kind, time)
    assert main(["run", "sec2", "--set", "N=2", "--drive", path]) == 2
    sentence = f"0.00401 s after the sample before, where 1e-05 s is usual: a gap; {choice}."
    assert capsys.readouterr().err == f"Line 52: {sentence}\n"
    with pytest.raises(BadInput, match=re.escape(f"Sample 50: {sentence}")):
        sampled(kind, time)


def test_a_gap_is_bridged_as_chosen_and_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    time = np.delete(np.arange(0.0, 0.01, 1e-5), np.s_[50:450])
    zero, line = (sampled("velocity", time, gap=gap) for gap in ("zero", "interpolate"))
    assert len(zero.time) == len(time) + 2 and (zero.velocity == 0.0).sum() == 2
    stands = zero.displacement_at(np.array([0.001, 0.004]))
    assert stands[0] == stands[1]
    assert line.displacement_at(np.array([0.001])) != line.displacement_at(np.array([0.004]))
    assert "1 gap taken as zero velocity, the first at 0.00049 s" in zero.words
    path = written(tmp_path / "gap.csv", "displacement", time)
    assert main(["run", "sec2", "--set", "N=2", "--drive", path, "--gap", "interpolate", "--json"]) == 0
    printed = capsys.readouterr()
    assert "1 gap interpolated, the first at 0.00049 s" in json.loads(printed.out)["drive"]
    assert "The samples limit it: the motion between them adds" in printed.err
    assert main(["run", "sec2", "--set", "N=2", "--drive", path, "--gap", "zero"]) == 2
    assert "choose interpolate" in capsys.readouterr().err


def test_noise_has_its_band_and_its_strength() -> None:
    signal = Signal.noise(1.0, 200.0, 400.0, 1.0, seed=3)
    assert np.array_equal(signal.velocity, Signal.noise(1.0, 200.0, 400.0, 1.0, seed=3).velocity)
    power = np.abs(np.fft.rfft(signal.displacement * np.hanning(len(signal.time)))) ** 2
    frequency = np.fft.rfftfreq(len(signal.time), signal.time[1])
    assert power[(frequency > 195) & (frequency < 405)].sum() > 0.999 * power.sum()
    # a mean of 200 squared sines over 200 periods: to about a tenth
    assert signal.displacement[len(signal.time) // 50:].std() == pytest.approx(np.sqrt(0.5), rel=0.1)


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


@pytest.mark.parametrize(("words", "sentence"), [
    (["run", "sec2", "--drive", "chirp=300:600"], "chirp=f0:f1:duration"), (["run", "sec2", "--drive", "crisp=1:2:3"], "crisp"),
    (["run", "sec2", "--drive", "noise=600:300:1"], "from a lower to a higher"),
    (["run", "impact", "--drive", "burst=300:3:0.1"], "drive = rest"),
    (["run", "sec2", "--drive", "burst=300:3:0.1", "--periods", "5"], "--periods is for a harmonic drive"),
    (["run", "sec2", "--drive", "chirp=300:600:1e5"], "nearest valid duration"),
    (["run", "sec2", "--drive", "burst=300:3:0.1", "--gap", "zero"], "--gap is for --drive FILE"),
    (["run", "sec2", "--gap", "zero"], "--gap is for --drive FILE"),
    (["curve", "sec2", "--from", "1", "--to", "2", "--points", "2", "--drive", "burst=300:3:0.1"], "--drive")])
def test_invalid_drives_are_refused_with_a_sentence(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    assert sentence in capsys.readouterr().err


def test_finer_knots_and_a_shift_do_not_change_the_motion() -> None:
    """The given knots are among the new ones, so the coarser signals used for error estimates still fit."""
    time = np.linspace(0.0, 0.004, 41)
    given = sampled("velocity", time)
    finer, moved = given.finer(3e-5), given.shifted(2e-7)
    assert len(finer.time) == 4 * 40 + 1 and np.isin(given.time, finer.time).all() and finer.coarser == given.coarser
    at = np.linspace(0.0, 0.004, 333)
    np.testing.assert_allclose(finer.displacement_at(at), given.displacement_at(at), atol=1e-12 * np.abs(given.displacement).max())
    np.testing.assert_allclose(moved.displacement_at(at) - given.displacement_at(at), 2e-7)
    assert all(one.displacement[0] == pytest.approx(2e-7 + before.displacement[0])
               for one, before in zip(moved.coarser, given.coarser, strict=True))
    assert given.finer(1.0) is given
    with pytest.raises(BadInput, match="nearest valid spacing"):
        given.finer(1e-10)


def test_times_of_a_velocity_ascend() -> None:
    with pytest.raises(BadInput, match="times must ascend"):
        Signal.from_velocity([0.0, 0.0], [1.0, 1.0])


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


def test_the_stop_flag_ends_a_long_chain_within_milliseconds() -> None:
    """How often the flag is read depends on the work done, steps times bodies, not on the number of steps."""
    stop = Stop()
    chain = MovedChain(scene("sec2").evolve(N=3000), sine(1e-7, 300.0, 2.0), stop)
    most = 2**19 / chain.scaled.bodies + 1.0
    assert chain.steps(0) > 2.0 * most
    stop.set()
    with pytest.raises(Cancelled):
        chain.run(rest(chain.scaled.scene), 0)
    assert chain.counts.steps <= most


def test_a_record_too_long_for_the_low_pass_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """A record of 5,000 beads has at most 10,000 instants, and 0.1 s of a 1 kHz sensor needs 12,800."""
    signal, sensors = sine(1e-7, 100.0, 10.0), Sensors(bandwidth=1000.0)
    short = _fine_enough(signal, scene("sec2").evolve(N=11), sensors)
    assert np.diff(short.time).max() <= 1.0 / 128_000.0 * (1.0 + 1e-9) and capsys.readouterr().err == ""
    long = _fine_enough(signal, scene("sec2").evolve(N=5000), sensors)
    assert len(long.time) <= 10_000
    assert "needs forces 7.81e-06 s apart" in capsys.readouterr().err
