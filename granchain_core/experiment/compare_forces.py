"""The difference between the measured and the computed forces of a motion over time, in newtons.

Equation   d(t_i) = F_model(t_i) − F_measured(t_i) at every measured time t_i of the motion,   rms = √⟨d²⟩
           With sensors, F_model is the force that they would record: plus m_tip ü_0, after their low-pass (sensors.py)
Note       Both clocks start at the first sample, so no record is shifted in time. Nothing is subtracted either: a
           sensor's constant offset contributes to rms and largest difference, and shows separately in the mean. Without
           sensors, the model's force is not filtered, so the effect of the real sensors is a part of the difference.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Protocol

import numpy as np

from ..errors import BadInput
from .misfit import Misfit
from .sensors import Sensors
from .series import Series

#: The forces that a series may contain.
FORCES = ("input_force", "output_force")


class Motion(Protocol):
    """A computed motion: times (T,) [s], and the forces of the driver and on the wall (T,) [N]."""

    @property
    def time(self) -> np.ndarray:
        """Times (T,) [s], ascending."""

    @property
    def input_force(self) -> np.ndarray:
        """Force of the driver (T,) [N]."""

    @property
    def output_force(self) -> np.ndarray:
        """Force on the wall (T,) [N]."""


@dataclass(frozen=True)
class ForceDifference(Misfit):
    """Model − measured of one force over the measured times of a motion: a `Misfit` with details of the comparison.

    Attributes
    ----------
    force : str
        "input_force" or "output_force".
    compared, samples : int
        Number of measured times within the motion, and of all measured times.
    at : float
        Time of the largest difference [s].
    word : str
        "measured", or "virtual experiment" where nothing was measured.
    """

    force: str
    compared: int
    samples: int
    at: float
    word: str = "measured"

    @property
    def sentence(self) -> str:
        """Return the difference in words, with its unit."""
        return (f"{self.force.replace('_', ' ')}, model − {self.word} at {self.compared} of {self.samples} samples: "
                f"{self.words(f'{self.at:.5g} s')}")


def compared_forces(measured: Series, motion: Motion, sensors: Sensors | None = None) -> dict[str, ForceDifference]:
    """Compare the forces of a series with those of a motion whose clock starts at the first sample.

    Parameters
    ----------
    measured : Series
        A series with an input force, an output force or both. Its sampling may differ from the motion's, and it may be
        shorter or longer: every sample between the first and the last time of the motion counts.
    motion : Driven or Run
        The computed motion; its forces are interpolated linearly between its times.
    sensors : Sensors, optional
        The sensors with which the forces were measured. Their bandwidth and tip mass are applied to the model's forces;
        noise and rate have no effect. The default is perfect sensors.

    Returns
    -------
    dict
        A `ForceDifference` for each measured force, by name; empty if no force was measured.

    Raises
    ------
    BadInput
        A measured value is not finite, or no sample lies within the motion.
    """
    if not isinstance(measured, Series):
        raise BadInput("Measured forces are a series, which granchain_core.experiment.read_experiment returns for a "
                       f"table of time and force, not a value of type {type(measured).__name__}.")
    sensors = sensors or Sensors()
    time, first, last = measured.time, float(motion.time[0]), float(motion.time[-1])
    within = (time >= first) & (time <= last)
    misfits = {}
    for name in FORCES:
        values = getattr(measured, name)
        if values is None:
            continue
        words = name.replace("_", " ")
        wrong = np.flatnonzero(~(np.isfinite(values) & np.isfinite(time)))
        if len(wrong):
            raise BadInput(f"Sample {wrong[0]} of the measured {words} is not a finite number; leave it out.")
        if not within.any():
            raise BadInput(f"No sample of the measured {words} lies within the motion: the samples are from "
                           f"{time.min():.6g} to {time.max():.6g} s, the motion is from {first:.6g} to {last:.6g} s.")
        measured_within = values[within]
        force = getattr(motion, name)
        if name == "input_force" and sensors.tip_mass > 0.0:
            force = force + sensors.tip_mass * _acceleration(motion)
        misfit = Misfit.of(sensors.passed(motion.time, force, time[within]), measured_within)
        misfits[name] = ForceDifference(**asdict(misfit), force=name, compared=len(measured_within), samples=len(time),
                                        at=float(time[within][misfit.index]), word=measured.word)
    return misfits


def _acceleration(motion: Motion) -> np.ndarray:
    """Return the driver's acceleration (T,) [m/s²] at the times of the motion, which must have a driver."""
    moved = getattr(motion, "drive_displacement", None)
    if moved is None:
        raise BadInput("A tip mass moves with the driver, and this motion has none.")
    return np.asarray(np.gradient(np.gradient(moved, motion.time), motion.time))
