"""How every file is written: its root, its axes, its name.

The root carries schema version, scene, method, accuracy asked and reached, versions, machine and time of writing. A
file is written under a temporary name, sealed with its checksum (hdf5/seal.py), synced and renamed: there is never half
a file under its own name.
"""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numba
import numpy as np

from ..errors import BadInput
from ..hdf5 import VERSIONS, seal
from ..hdf5.border import SCHEMA
from ..kernels.width import machine
from ..quantities import QUANTITIES
from ..scene import Scene
from ..version import __version__

#: File systems take 255 bytes; the temporary name needs some of them.
_LONGEST_NAME = 230
#: Columns of a run and of a curve with the largest forces.
MAXIMA = ("max_input_force", "max_output_force", "max_output_force_elastic")


def or_nan(value: float | None) -> float:
    """A number for a file, in which None is NaN."""
    return np.nan if value is None else value


def or_none(value: float) -> float | None:
    """A number from a file."""
    return None if np.isnan(value) else float(value)


def write_root(file: h5py.File, scene: Scene, method: str, reached: float | None) -> None:
    """Write what every file's root carries; `reached` is the accuracy, None where there is none to state."""
    file.attrs.update({
        "Conventions": "CF-1.10", "granchain_schema": SCHEMA, "granchain_version": __version__,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": json.dumps({"numpy": np.__version__, "numba": numba.__version__, "h5py": h5py.__version__,
                                "python": platform.python_version()}),
        "machine": machine(),
        "scene_name": scene.name, "scene": json.dumps(scene.to_json()), "scene_digest": scene.digest,
        "method": method, "accuracy_asked": scene.accuracy, "accuracy_reached": or_nan(reached),
    })
    for name, value in scene.knobs.items():
        file.attrs[f"knob_{name}"] = value
        file.attrs[f"knob_{name}_unit"] = QUANTITIES[name].unit


def write_axis(group: h5py.Group, name: str, values: np.ndarray, unit: str, meaning: str) -> None:
    """Write an axis."""
    data = group.create_dataset(name, data=values)
    data.make_scale(name)
    data.attrs["units"], data.attrs["long_name"] = unit, meaning


def write_values(group: h5py.Group, name: str, values: Any, dimensions: tuple[str, ...], unit: str,
                 meaning: str) -> None:
    """Write values over axes that are there."""
    data = group.create_dataset(name, data=values)
    for axis, dimension in enumerate(dimensions):
        data.dims[axis].attach_scale(group[dimension])
    data.attrs["units"], data.attrs["long_name"] = unit, meaning


def check_writable(path: str | Path) -> None:
    """Raise `BadInput` if no file can be written at `path`; nothing is left there. Ask before a long computation."""
    temporary = _temporary(Path(path))
    try:
        temporary.touch(exist_ok=False)
    except OSError as problem:
        raise BadInput(f"Cannot write {str(path)[:200]}: {problem.strerror or problem}.") from None
    temporary.unlink()


def _temporary(path: Path) -> Path:
    """The name a file has while it is written, in the folder it will stand in."""
    if len(os.fsencode(path.name)) > _LONGEST_NAME:
        raise BadInput(f"Cannot write {str(path)[:60]}…: the name has more than {_LONGEST_NAME} bytes.")
    if not path.name or path.name == ".." or path.is_dir():
        raise BadInput(f"Cannot write {str(path)[:200]}: it is a folder; give a file in it.")
    return path.with_name(f".{path.name}.{os.getpid()}.tmp")


def write_file(path: str | Path, write: Callable[[h5py.File], None]) -> Path:
    """Write a file by `write` under a temporary name, seal it, and give it its own name; returns the path.

    Raises `BadInput` where it cannot be written.
    """
    path = Path(path)
    temporary = _temporary(path)
    try:
        with h5py.File(temporary, "w", libver=VERSIONS) as file:
            write(file)
        seal(temporary)
        os.replace(temporary, path)
    except OSError as problem:
        temporary.unlink(missing_ok=True)
        raise BadInput(f"Cannot write {str(path)[:200]}: {problem.strerror or problem}.") from None
    return path
