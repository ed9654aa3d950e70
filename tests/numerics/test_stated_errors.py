"""The errors that `run` and the curve state bound the true ones, on random scenes (stated_errors.py, curve_errors.py).
"""

from __future__ import annotations

import functools

import curve_errors
import numpy as np
import pytest
import sampled_drives
import stated_errors

from granchain_core import Run, run, scene
from granchain_core.integrate.methods import method_for
from granchain_core.integrate.scaling import scale_chain

UNCUT = [s for s in stated_errors.FEW if s[1] == "allowed"]
CUT = [s for s in stated_errors.FEW if s[1] == "cut"]


@functools.cache
def uncut() -> list:
    """Forty random scenes without a tension cut."""
    return [v for v in stated_errors.verdicts(40, 20, UNCUT) if v is not None]


def excess(found: list) -> np.ndarray:
    """True errors over what may be, the stated error and three times how well the truth is known."""
    return np.array([v.error / (v.stated + 3.0 * v.known) for v in found])


@pytest.mark.long
def test_the_stated_error_bounds_the_true_one() -> None:
    """At any accuracy from 1e-3 to 1e-9, in each of these scenes; how rare a larger one is in thousands of scenes is
    measured in docs/accuracy.md. Measured here: 0.22 of what is stated at most.
    """
    ratio = excess(uncut())
    print(f"{len(ratio)} scenes: {np.mean(ratio <= 1.0):.1%} bounded, median {np.median(ratio):.2g}, worst {ratio.max():.2g}")
    assert (ratio <= 1.0).all()


def test_a_run_that_is_done_is_as_accurate_as_asked() -> None:
    """The true error is below what was asked, in each scene. Measured: 0.10 of it at most."""
    assert all(v.error <= v.asked for v in uncut() if v.status == "done")


def test_most_scenes_are_done() -> None:
    """33 of the 40 when this was written; that other rounding may lose two is an allowance. The others were asked for
    5e-8 or less, or amplify errors until nothing can be stated, which is an error of 2.
    """
    assert sum(v.status == "done" for v in uncut()) >= 31
    assert all(v.asked < 5e-8 or v.stated == 2.0 for v in uncut() if v.status != "done")


def test_the_stated_error_bounds_the_true_one_with_a_tension_cut() -> None:
    """As without the cut, in each scene. Measured: 0.11 of what is stated at most."""
    ratio = excess([v for v in stated_errors.verdicts(20, 21, CUT) if v is not None])
    assert (ratio <= 1.0).all()


def same_steps() -> Run:
    """A gentle, pressed motion asked for so coarsely that the largest step alone decides: two computations are one."""
    chain = scene("sec2").evolve(F0=1.0, A0=1e-8, f=3000.0, accuracy=1e-3)
    return run(chain, periods=0, record=3, samples=16, method="dop853")


def test_two_computations_by_the_same_steps_are_no_evidence() -> None:
    """An error of exactly nothing is never true: no double-precision motion is that good."""
    assert same_steps().displacement_error > 0.0


def test_computations_with_the_same_steps_are_not_compared() -> None:
    """A fast drive sampled 16 times: half the step, asked for from so coarse an accuracy, is still one step a sample.
    """
    chain = scene("sec2").evolve(f=5600.0, A0=1.7e-7, D=64.0, N=5, accuracy=7e-4)
    setting, scaled = method_for(chain.accuracy), scale_chain(chain)
    halved, finer = (one.steps_per_period(scaled, stated_errors.SAMPLES)
                     for one in (setting.finer(), setting.finer_than(scaled, stated_errors.SAMPLES)))
    assert finer > halved == setting.steps_per_period(scaled, stated_errors.SAMPLES)
    true = stated_errors.reference(chain, 3e-15)
    result = run(chain, periods=0, record=stated_errors.PERIODS, samples=stated_errors.SAMPLES)
    assert 0.0 < np.abs(result.displacement - true).max() / np.abs(true).max() <= result.displacement_error <= chain.accuracy


@pytest.mark.parametrize("base", curve_errors.BASES)
def test_the_error_stated_by_a_curve_bounds_the_true_one(base: str) -> None:
    """Periodic points of batches at random drive, A₀, D and k against the converged orbit, every one of them."""
    found = list(curve_errors.points(60, 9, base))
    assert len(found) >= 15
    ratio = np.array([p.error / p.stated for p in found])
    print(f"{base}: {len(found)} points, median {np.median(ratio):.2g}, worst {ratio.max():.2g}")
    assert (ratio <= 1.0).all()
    assert np.median([p.stated for p in found]) < 1e-3, "a stated error that is always large says nothing"


def test_what_the_samples_of_a_drive_leave_out_is_stated() -> None:
    """Velocities and displacements with 20 to 400 samples a period; measured over 100 chains: 0.8 of what is stated."""
    assert max(one.worst for one in sampled_drives.sampled(11, 3)) <= 1.0
