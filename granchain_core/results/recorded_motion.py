"""A motion over time with the forces at both ends: the base class of runs, observations and driven motions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..scene import Scene
from ..scene.hertz import EXPONENT
from ..tables import Column, Labelled, axis

#: Largest number of recorded values of one motion: samples times beads.
MOST_RECORDED = 50_000_000
#: Largest number of samples per drive period.
MOST_SAMPLES = 1_000_000

_TIME_UNIT = "s"
_COLUMNS = {  # by name: (axes, unit, meaning)
    "displacement": (("time", "bead"), "m", "bead displacement from its rest position"),
    "velocity": (("time", "bead"), "m/s", "bead velocity"),
    "kinetic_energy": (("time", "bead"), "J", "kinetic energy of each bead"),
    "force": (("time", "contact"), "N", "contact force, elastic and damping; contact 0 is the driver's, N the wall's"),
    "drive_displacement": (("time",), "m", "displacement of the driver"),
    "input_force": (("time",), "N", "force on bead 1"),
    "output_force": (("time",), "N", "force on the wall, elastic and damping"),
    "output_force_elastic": (("time",), "N", "elastic part of the force on the wall, the paper's F_out"),
}


class RecordedMotion(Labelled):
    """A result with the motion of a chain over time, and the forces at its two ends.

    `displacement` (T, N) [m] and `velocity` (T, N) [m/s] of the beads, `force` (T, N + 1) [N] of the contacts.
    """

    if TYPE_CHECKING:
        displacement: np.ndarray
        velocity: np.ndarray
        force: np.ndarray

        @property
        def displacement_error(self) -> float | None: ...

    @property
    def error_estimate(self) -> float | None:
        """`displacement_error` under its name in the command line's JSON.

        In curves, parameter maps and attractors, this name denotes the error of the output force (docs/result-files.md,
        "Which name is which error").
        """
        return self.displacement_error

    @property
    def kinetic_energy(self) -> np.ndarray:
        """Kinetic energy of every bead (T, N) [J]."""
        return 0.5 * self.scene.masses() * self.velocity**2

    @property
    def input_force(self) -> np.ndarray:
        """Force on bead 1 (T,) [N], from the driver or as given."""
        return self.force[:, 0]

    @property
    def output_force(self) -> np.ndarray:
        """Total force on the wall (T,) [N], elastic and damping."""
        return self.force[:, -1]

    @property
    def output_force_elastic(self) -> np.ndarray:
        """Elastic part of the force on the wall (T,) [N], the paper's F_out."""
        return elastic_output(self.scene, self.displacement[:, -1])


def motion_columns(motion: RecordedMotion) -> dict[str, Column]:
    """Return the columns over time of a motion: all for a run, those that need no driver for an observation."""
    return {name: Column(values, axes, unit, meaning) for name, (axes, unit, meaning) in _COLUMNS.items()
            if (values := getattr(motion, name, None)) is not None}


def time_axis(time: np.ndarray, meaning: str) -> dict[str, Column]:
    """Return the time axis [s]; `meaning` says from which instant time counts."""
    return axis("time", time, _TIME_UNIT, meaning)


def motion_units(group: str) -> dict[str, str]:
    """Return the units of a motion's times and columns, by their paths in a group of a file."""
    return {f"{group}/time": _TIME_UNIT, **{f"{group}/{name}": unit for name, (_, unit, _) in _COLUMNS.items()}}


def elastic_output(scene: Scene, last: np.ndarray) -> np.ndarray:
    """Return the elastic force on the wall [N] for displacements of the last bead [m]."""
    overlap = np.maximum(last + scene.static_overlap()[-1], 0.0)
    return np.asarray(scene.contact_stiffness()[-1] * overlap**EXPONENT)
