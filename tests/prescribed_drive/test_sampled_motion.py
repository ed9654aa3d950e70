"""A driver's motion that is given by samples: its sampling error, gaps in it, other knots."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from sine import CHAIN

from app.cli import main
from granchain_core import BadInput, Run, Signal, drive, run, scene

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
