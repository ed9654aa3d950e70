"""Motions under another drive than the harmonic one in HDF5, laid out as runs are.

/driven    time (s), bead, contact; displacement, velocity (time, bead); force (time, contact); drive_displacement,
           drive_velocity, input_force, output_force, output_force_elastic (time)
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from ..observe import Driven
from .writing import write_axis, write_file, write_root, write_values

_ROWS = {  # name: (dimensions, unit, meaning)
    "displacement": (("time", "bead"), "m", "bead displacement from its rest position"),
    "velocity": (("time", "bead"), "m/s", "bead velocity"),
    "force": (("time", "contact"), "N", "contact force, elastic and damping; contact 0 is the driver's, N the wall's"),
    "input_force": (("time",), "N", "force of the driver on bead 1"),
    "output_force": (("time",), "N", "force on the wall, elastic and damping"),
    "output_force_elastic": (("time",), "N", "elastic part of the force on the wall, the paper's F_out"),
}


def save_driven(found: Driven, path: str | Path) -> Path:
    """Write a motion to `path`; returns the path. Raises `BadInput` where it cannot be written."""

    def write(file: h5py.File) -> None:
        write_root(file, found.scene, found.cost.method, found.error_estimate)
        file.attrs["status"], file.attrs["drive"] = found.status, found.signal.words
        file.attrs["energy_residual"], file.attrs["cost"] = found.energy_residual, json.dumps(asdict(found.cost))
        for name in ("max_input_force", "max_output_force", "max_output_force_elastic"):
            file.attrs[name] = getattr(found, name)
        group = file.create_group("driven")
        write_axis(group, "time", found.time, "s", "time since the signal's own zero")
        write_axis(group, "bead", np.arange(1, found.scene.N + 1), "1", "bead number from the driver")
        write_axis(group, "contact", np.arange(found.scene.N + 1), "1", "contact number; c joins bodies c and c + 1")
        for name, (dimensions, unit, meaning) in _ROWS.items():
            write_values(group, name, getattr(found, name), dimensions, unit, meaning)
        write_values(group, "drive_displacement", found.signal.displacement, ("time",), "m", "driver displacement")
        write_values(group, "drive_velocity", found.signal.velocity, ("time",), "m/s", "driver velocity")

    return write_file(path, write)
