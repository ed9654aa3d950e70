"""Observations in HDF5, laid out as runs are, so that one reader reads both.

/observation    time (s), bead, contact; displacement, velocity (time, bead); force (time, contact); input_force,
                output_force, output_force_elastic and, where there was one, measured_output_force (time)
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from ..observe import Observation
from .writing import write_axis, write_file, write_root, write_values

_ROWS = {  # name: (dimensions, unit, meaning)
    "displacement": (("time", "bead"), "m", "bead displacement from its rest position"),
    "velocity": (("time", "bead"), "m/s", "bead velocity"),
    "force": (("time", "contact"), "N", "contact force, elastic and damping; contact 0 is the given force"),
    "input_force": (("time",), "N", "the force on bead 1 as it was applied"),
    "output_force": (("time",), "N", "force on the wall, elastic and damping"),
    "output_force_elastic": (("time",), "N", "elastic part of the force on the wall, the paper's F_out"),
}


def save_observation(seen: Observation, path: str | Path) -> Path:
    """Write an observation to `path`; returns the path. Raises `BadInput` where it cannot be written."""

    def write(file: h5py.File) -> None:
        write_root(file, seen.scene, seen.cost.method, seen.error_estimate)
        file.attrs["status"] = seen.status
        file.attrs["integration_error"] = seen.integration_error
        file.attrs["interpolation_error"] = seen.interpolation_error
        file.attrs["input"] = "; ".join((seen.record.understood, *seen.record.notes))
        file.attrs["cost"] = json.dumps(asdict(seen.cost))
        for name in ("residual", "residual_elastic"):
            found = getattr(seen, name)
            if found is not None:
                file.attrs[name] = json.dumps(asdict(found))
        group = file.create_group("observation")
        write_axis(group, "time", seen.time, "s", "time as in the measured force")
        write_axis(group, "bead", np.arange(1, seen.scene.N + 1), "1", "bead number from the driver")
        write_axis(group, "contact", np.arange(seen.scene.N + 1), "1", "contact number; c joins bodies c and c + 1")
        for name, (dimensions, unit, meaning) in _ROWS.items():
            write_values(group, name, getattr(seen, name), dimensions, unit, meaning)
        if seen.record.output is not None:
            write_values(group, "measured_output_force", seen.record.output, ("time",), "N",
                         "the measured output force")

    return write_file(path, write)
