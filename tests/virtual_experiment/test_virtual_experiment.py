"""The virtual experiment: perfect sensors record the model's forces, each imperfection follows its formula, and the
mark stays with the data wherever they go.
"""

from __future__ import annotations

import doctest
import inspect
import json
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from app.plots.measured import measured_columns
from granchain_core import BadInput, Scene, scene, settle
from granchain_core.experiment import Answers, Measured, Series, read_data
from granchain_core.experiment.measured import VIRTUAL
from granchain_core.fitting.trains import Train, moved
from granchain_core.observers.read import read_force
from granchain_core.virtual_experiment import Sensors, virtual_curve_csv, virtual_series_csv

CHAIN = scene("sec2").evolve(N=3, f=1000.0)


def series(chain: Scene, periods: int, sensors: Sensors, seed: int = 0) -> Series:
    found = read_data(virtual_series_csv(chain, periods, sensors, seed).encode())
    assert isinstance(found, Series)
    return found


def test_perfect_sensors_record_the_models_forces() -> None:
    """This holds for any drive phase at the start. There are 256 samples per period, with four model samples each."""
    found, run = series(CHAIN, 4, Sensors(rate=256e3)), settle(CHAIN, samples=1024).run
    trains = {name: Train.of(run, name) for name in ("input_force", "output_force")}
    late = moved(found.time, {"output_force": found.output_force}, {"output_force": trains["output_force"]}, 1e-6, 1024)
    for name, train in trains.items():
        exact = train.mean_over(found.time + late, 1.0 / 1024e3)
        near_jump = np.abs(np.gradient(exact)) > 0.02 * exact.max()
        difference = np.abs(getattr(found, name) - exact)[~near_jump]
        # two samplings of a curve at 1024 samples per period, shifted by less than one sample against each other
        assert difference.max() < 0.01 * exact.max()
    velocity = CHAIN.A0 * 2e3 * np.pi * np.cos(2e3 * np.pi * (found.time + late))
    np.testing.assert_allclose(found.velocity, velocity, atol=1e-3 * np.abs(velocity).max())


def test_a_tip_adds_its_inertia_to_the_input_force_alone() -> None:
    """The same seed gives the same phase. The difference is m_tip ü_0, with ü_0 from the recorded velocity."""
    bare, tipped = (series(CHAIN, 3, Sensors(tip_mass=mass)) for mass in (0.0, 0.01))
    acceleration = np.gradient(bare.velocity, bare.time)
    difference = tipped.input_force - bare.input_force
    # away from the ends, the gradient of a sampled sine is off by (2π/100)²/6
    np.testing.assert_allclose(difference[1:-1], 0.01 * acceleration[1:-1], atol=2e-3 * np.abs(difference).max())
    np.testing.assert_array_equal(tipped.output_force, bare.output_force)


@pytest.mark.parametrize(("rate", "cutoff"), [(1e5, 800.0), (1e5, 3000.0), (2e3, 1e3), (1e5, 6e4)])
def test_a_record_has_the_lines_of_the_analogue_low_pass(rate: float, cutoff: float) -> None:
    """The record equals the spectral lines of the settled force times H(f), summed at the sample times.

    The recorded velocity gives the phase.
    """
    chain = CHAIN.evolve(f=1030.0)  # 2 kHz is not a multiple of it
    run, omega = settle(chain, samples=4096).run, 2.0 * np.pi * chain.f
    assert run.regime.period == 1
    step = 1.0 / (4096.0 * chain.f)
    lines = np.fft.rfft(Train.of(run, "output_force").mean_over(step * np.arange(4096), step)) / 4096.0
    lines[1:] *= 2.0
    part = chain.f * np.arange(1000) / cutoff
    passed = lines[:1000] / (1.0 + np.sqrt(2.0) * 1j * part - part**2)
    found = series(chain, 60, Sensors(bandwidth=cutoff, rate=rate))
    waves = np.stack([np.cos(omega * found.time), -np.sin(omega * found.time)], axis=1)
    phase = np.angle(complex(*np.linalg.lstsq(waves, found.velocity)[0]))
    exact = (passed * np.exp(1j * np.outer(omega * found.time + phase, np.arange(1000)))).real.sum(axis=1)
    # straight lines between the model's samples cost 0.02 % of a spectral line at f_c and 0.03 % of a pulse
    assert np.abs(found.output_force - exact).max() < 0.002 * exact.max()


@pytest.mark.parametrize(("rate", "cutoff"), [(1e5, 800.0), (1e5, 3000.0), (2e3, 1e3), (1e5, 6e4)])
def test_the_low_pass_is_the_analogue_one_at_every_rate(rate: float, cutoff: float) -> None:
    """A sine at as many nodes as `virtual` computes comes out with |H| and its phase, whatever the sensor rate."""
    sensors = Sensors(rate=rate, bandwidth=cutoff)
    for part in (0.5, 1.0, 2.0, 3.0):
        f = part * cutoff
        nodes = np.arange(0.0, 40.0 / cutoff, 1.0 / (256.0 * cutoff))
        at = np.linspace(20.0 / cutoff, 39.0 / cutoff, 500)
        found = sensors.passed(nodes, np.sin(2.0 * np.pi * f * nodes), at)
        lines = np.linalg.lstsq(np.stack([np.sin(2.0 * np.pi * f * at), np.cos(2.0 * np.pi * f * at)], 1), found)[0]
        exact = 1.0 / (1.0 + np.sqrt(2.0) * 1j * part - part**2)
        # straight lines between nodes reduce the sine by (π f/f_s)²/3, at most 5e-4
        assert abs(complex(*lines) - exact) < 6e-4 * abs(exact)
        assert abs(exact) == pytest.approx(1.0 / np.sqrt(1.0 + part**4))


def test_a_periodic_force_with_a_jump_passes_as_its_repetitions_do() -> None:
    """Two nodes at the same time are a jump. The step response has the closed form of a Butterworth filter."""
    sensors, time = Sensors(bandwidth=700.0), np.array([0.0, 1e-3, 1e-3, 2.5e-3])
    force, at = np.array([0.0, 0.0, 1.0, 1.0]), np.linspace(0.0, 2.4e-3, 97)
    rate, since = np.sqrt(2.0) * np.pi * 700.0, np.maximum(at - 1e-3, 0.0)
    exact = np.where(at > 1e-3, 1.0 - np.exp(-rate * since) * (np.cos(rate * since) + np.sin(rate * since)), 0.0)
    np.testing.assert_allclose(sensors.passed(time, force, at), exact, atol=1e-12)
    closed = np.array([0.0, 0.0, 1.0, 0.0])
    many = np.concatenate([time + 2.5e-3 * turn for turn in range(12)])
    np.testing.assert_allclose(sensors.passed(time, closed, at + 1.0, periodic=True),
                               sensors.passed(many, np.tile(closed, 12), at + 11 * 2.5e-3), atol=1e-9)
    np.testing.assert_array_equal(Sensors().passed(time, force, np.array([0.5e-3, 1e-3, 2e-3])), [0.0, 1.0, 1.0])


def test_noise_is_as_strong_as_it_says_and_differs_from_seed_to_seed() -> None:
    quiet, noisy, other = (series(CHAIN, 40, Sensors(noise=noise, velocity_noise=noise / 10.0), seed)
                           for noise, seed in ((0.0, 3), (0.02, 3), (0.02, 4)))
    for name, strength in (("input_force", 0.02), ("output_force", 0.02), ("velocity", 0.002)):
        noise = getattr(noisy, name) - getattr(quiet, name)
        # with 4,000 samples, the standard deviation is known to 1 %
        assert noise.std() == pytest.approx(strength, rel=0.05) and abs(noise.mean()) < 0.1 * strength
        assert not np.array_equal(getattr(noisy, name), getattr(other, name))


def test_a_curve_has_repeats_that_scatter_with_the_drive() -> None:
    """The force scatters by the scatter of A0 times dF/dA0, here from differences. Without scatter, repeats agree."""
    still = read_data(virtual_curve_csv(CHAIN, [1000.0], Sensors(rate=256e3), repeats=2).encode())
    assert isinstance(still, Measured) and still.repeats is not None and still.repeats.tolist() == [2]
    assert still.high[0] - still.low[0] < 0.01 * still.force[0]  # samples fall at different phases of the peak
    assert still.force[0] == pytest.approx(settle(CHAIN).run.max_output_force, rel=0.02)
    scattered = read_data(virtual_curve_csv(CHAIN, [1000.0], Sensors(), repeats=60, scatter=0.02, seed=5).encode())
    up, down = (settle(CHAIN.evolve(A0=CHAIN.A0 * one)).run.max_output_force for one in (1.02, 0.98))
    # with 60 repeats, the standard deviation is known to 9 %
    assert scattered.scatter[0] == pytest.approx(abs(up - down) / 2.0, rel=0.35)


def test_motions_without_a_period_are_recorded_too() -> None:
    chaotic = scene("sec2").evolve(f=1000.0, dissipation="none", N=3)
    found = series(chaotic, 5, Sensors())
    assert len(found.time) == 500 and np.isfinite(found.output_force).all() and found.output_force.max() > 0.0


def test_the_mark_stays_with_the_data() -> None:
    text = virtual_series_csv(CHAIN, 2, Sensors(noise=0.01))
    assert text.startswith(f"# {VIRTUAL} by granchain")
    found = read_data(text.encode(), Answers(note="my rig"))
    assert found.virtual and found.word == VIRTUAL and found.note.endswith("my rig")
    assert found.understood.startswith("virtual experiment, nothing measured")
    real = read_data(b"f [Hz],F [N]\n300,0.1\n310,0.2\n")
    assert not real.virtual and real.word == "measured" and "virtual" not in real.understood
    curve = read_data(virtual_curve_csv(CHAIN, [900.0, 1000.0], Sensors(), repeats=1).encode())
    assert isinstance(curve, Measured) and measured_columns(curve, 1.0)["word"] == [VIRTUAL, VIRTUAL]


@pytest.mark.parametrize(("make", "sentence"), [
    (lambda: Sensors(noise=-1.0), "noise"), (lambda: Sensors(bandwidth=0.0), "bandwidth"),
    (lambda: Sensors(bandwidth=float("nan")), "bandwidth"), (lambda: Sensors(tip_mass=1e9), "tip mass"),
    (lambda: Sensors(rate=0.0), "rate"), (lambda: virtual_series_csv(CHAIN, 0, Sensors()), "periods"),
    (lambda: virtual_series_csv(CHAIN, 10_000, Sensors(rate=1e8)), "samples"),
    (lambda: virtual_series_csv(scene("impact"), 3, Sensors()), "drive"),
    (lambda: virtual_curve_csv(CHAIN, [1000.0], Sensors(), scatter=0.9), "scatter"),
    (lambda: virtual_curve_csv(CHAIN, [], Sensors()), "records"),
    (lambda: virtual_curve_csv(CHAIN, [1000.0], Sensors(), repeats=0), "repeats")])
def test_an_impossible_experiment_is_refused(make, sentence: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInput, match=sentence):
        make()


def test_an_observer_takes_a_virtual_experiment_and_names_it(tmp_path: Path) -> None:
    """A series may have more columns than the observer needs. An unclear table is refused."""
    path = tmp_path / "virtual.csv"
    path.write_text(virtual_series_csv(CHAIN, 3, Sensors(noise=0.001)), "utf-8")
    record, found = read_force(path), read_data(path.read_bytes())
    assert record.understood.startswith("virtual experiment, nothing measured")
    np.testing.assert_array_equal(record.force, found.input_force)
    np.testing.assert_array_equal(record.output, found.output_force)
    for text, sentence in (("time_s,velocity_m_s\n" + "".join(f"{i},1\n" for i in range(12)), "no input force"),
                           ("time_s,input_force_N,velocity\n" + "".join(f"{i},1,1\n" for i in range(12)), "velocity")):
        path.write_text(text, "utf-8")
        with pytest.raises(BadInput, match=sentence):
            read_force(path)


@pytest.mark.parametrize("subject", [Sensors, virtual_series_csv, virtual_curve_csv])
def test_the_examples_run(subject) -> None:  # type: ignore[no-untyped-def]
    found = doctest.DocTestParser().get_doctest(inspect.cleandoc(subject.__doc__), {}, subject.__name__, None, None)
    assert found.examples and doctest.DocTestRunner().run(found).failed == 0


def test_the_command_writes_a_file_that_every_reader_takes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "series.csv"
    words = ["virtual", "sec2", "--set", "N=3", "--set", "f=1000", "--periods", "6", "--noise", "0.005", "--bandwidth", "20000"]
    assert main([*words, "--out", str(out)]) == 0 and "virtual experiment" in capsys.readouterr().out
    assert main(["fit", "sec2", "--set", "N=3", "--set", "f=1000", "--data", str(out), "--error", "0.005", "--free", "D=60:160",
                 "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    # the sensors smooth the jumps of the force, which no D of the model does: χ² is 2.9 per degree of freedom, and D is
    # found to 0.14 %
    assert printed["verdict"] == "cannot" and printed["parameters"][0]["best"] == pytest.approx(100.0, rel=0.01)
    assert main(["virtual", "sec2", "--set", "N=2", "--kind", "curve", "--from", "1800", "--to", "2000", "--points", "2"]) == 0
    assert capsys.readouterr().out.count("\n") == 3 + 1 + 6
    for bad, sentence in ((["--kind", "picture"], "neither series nor curve"), (["--kind", "curve"], "--from and --to"),
                          (["--from", "3"], "are for --kind curve"), (["--out", str(tmp_path / "no" / "f.csv")], "Cannot write")):
        assert main(["virtual", "sec2", "--set", "N=2", *bad]) == 2
        assert sentence in capsys.readouterr().err
