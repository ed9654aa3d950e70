"""Observations in HDF5, laid out as runs are, so that one reader reads both.

/observation    time (s), bead, contact; displacement, velocity (time, bead); force (time, contact); input_force,
                output_force, output_force_elastic and, if there was one, measured_output_force (time)
"""

from __future__ import annotations

from pathlib import Path

from ..observers import Observation
from .writing import write_file, write_result


def save_observation(seen: Observation, path: str | Path) -> Path:
    """Write an observation to `path` and return the path. Raises `BadInput` if it cannot be written."""
    return write_file(path, lambda file: write_result(file, seen))
