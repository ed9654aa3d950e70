"""Drives other than the harmonic one: kernel against harmonic runs and closed forms, signals against their formulas."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest
from sine import CHAIN, sine

from app.cli import main
from app.cli.driven import _fine_enough
from granchain_core import Driven, Signal, drive, run, scene
from granchain_core.errors import Cancelled
from granchain_core.execution.stop import Stop
from granchain_core.experiment import Sensors
from granchain_core.prescribed_drive.moved_chain import MovedChain
from granchain_core.prescribed_drive.signal import KNOTS
from granchain_core.scene.state import rest


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


def test_noise_has_its_band_and_its_strength() -> None:
    signal = Signal.noise(1.0, 200.0, 400.0, 1.0, seed=3)
    assert np.array_equal(signal.velocity, Signal.noise(1.0, 200.0, 400.0, 1.0, seed=3).velocity)
    power = np.abs(np.fft.rfft(signal.displacement * np.hanning(len(signal.time)))) ** 2
    frequency = np.fft.rfftfreq(len(signal.time), signal.time[1])
    assert power[(frequency > 195) & (frequency < 405)].sum() > 0.999 * power.sum()
    # a mean of 200 squared sines over 200 periods: to about a tenth
    assert signal.displacement[len(signal.time) // 50:].std() == pytest.approx(np.sqrt(0.5), rel=0.1)


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
