"""Comparison of measured and computed forces: the samples that count, and differences that must not be hidden."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from granchain_core import BadInput
from granchain_core.experiment import Series, compared_forces


@dataclass(frozen=True)
class Ramp:
    """A motion with linear forces, 2 N/s at the driver and −1 N/s at the wall, and unevenly spaced knots."""

    time: np.ndarray

    @property
    def input_force(self) -> np.ndarray:
        """The input force 2 t."""
        return 2.0 * self.time

    @property
    def output_force(self) -> np.ndarray:
        """The output force −t."""
        return -self.time


RAMP = Ramp(np.array([0.0, 0.3, 0.35, 1.0, 2.0]))


def series(time: np.ndarray, input_force: np.ndarray | None = None, output_force: np.ndarray | None = None, note: str = "") -> Series:
    """Return a series with these forces."""
    return Series(time, None, input_force, output_force, "made", note=note)


def test_other_sampling_and_a_constant_offset() -> None:
    """Straight lines are also met between knots; an offset of 0.5 N is the rms, largest and mean difference."""
    time = np.linspace(0.0, 2.0, 77)
    found = compared_forces(series(time, 2.0 * time - 0.5, -time), RAMP)
    assert list(found) == ["input_force", "output_force"]
    pushed, out = found["input_force"], found["output_force"]
    assert (pushed.rms, pushed.largest, pushed.mean) == pytest.approx((0.5, 0.5, 0.5)) and pushed.compared == 77
    assert max(out.rms, out.largest, abs(out.mean)) < 1e-15
    assert "77 of 77 samples: rms 0.5 N" in pushed.sentence and "mean +0.5 N" in pushed.sentence


def test_numbers_of_a_single_wrong_sample() -> None:
    time = np.linspace(0.0, 2.0, 5)
    measured = -time
    measured[3] -= 2.0
    out = compared_forces(series(time, output_force=measured), RAMP)["output_force"]
    assert (out.rms, out.largest, out.at, out.mean) == pytest.approx((np.sqrt(4.0 / 5.0), 2.0, 1.5, 0.4))
    assert out.relative == pytest.approx(out.rms / np.sqrt(np.mean(measured**2)))


@pytest.mark.parametrize(("time", "count"), [
    (np.linspace(0.0, 1.0, 11), 11), (np.linspace(0.0, 4.0, 9), 5), (np.linspace(-1.0, 1.0, 9), 5),
], ids=["shorter", "longer", "begins earlier"])
def test_only_samples_within_the_motion_count(time: np.ndarray, count: int) -> None:
    out = compared_forces(series(time, output_force=-time), RAMP)["output_force"]
    assert (out.compared, out.samples) == (count, len(time)) and out.largest < 1e-15
    assert f"at {count} of {len(time)} samples" in out.sentence


def test_no_force_is_not_compared_and_a_force_of_zeros_has_no_relative_misfit() -> None:
    time = np.linspace(0.0, 1.0, 8)
    assert compared_forces(series(time), RAMP) == {}
    silent = compared_forces(series(time, np.zeros(8), note="virtual experiment by granchain"), RAMP)["input_force"]
    assert silent.relative is None and "%" not in silent.sentence and "model − virtual experiment" in silent.sentence


@pytest.mark.parametrize(("measured", "words"), [
    (series(np.linspace(0.0, 1.0, 8), np.r_[np.zeros(7), np.nan]), "Sample 7 of the measured input force is not a finite number"),
    (series(np.linspace(5.0, 6.0, 8), np.zeros(8)), "the samples are from 5 to 6 s, the motion is from 0 to 2 s"),
    ("force.csv", "not a value of type str")])
def test_forces_that_cannot_be_compared_are_refused_with_a_sentence(measured: Series, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        compared_forces(measured, RAMP)
