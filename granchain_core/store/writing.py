"""Writing of a file from a result's tables and attributes, first under a temporary name.

The root has schema version, scene, method, requested and reached accuracy, versions, machine and time of writing
(tables/provenance.py). A file is written under a temporary name, sealed with its checksum (hdf5/seal.py), synced and
renamed, so that there is never half a file under the final name.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

from ..errors import BadInput
from ..hdf5 import VERSIONS, seal
from ..hdf5.checked_file import SCHEMA
from ..tables import Column, Labelled, Table

#: File systems allow 255 bytes, of which the temporary name needs some.
_LONGEST_NAME = 230


def or_none(value: float) -> float | None:
    """Return a number from a file; None for NaN."""
    return None if np.isnan(value) else float(value)


def write_result(file: h5py.File, result: Labelled) -> None:
    """Write a result's attributes into the root, and each of its tables as a group with dimension scales."""
    file.attrs["granchain_schema"] = SCHEMA
    file.attrs.update(result.attributes())
    for table in result.tables():
        write_table(file, table)


def write_table(file: h5py.File, table: Table) -> None:
    """Write a table as a group with dimension scales."""
    group = file.create_group(table.name)
    for name, axis in table.axes.items():
        _dataset(group, name, axis).make_scale(name)
    for name, column in table.columns.items():
        data = _dataset(group, name, column)
        for place, along in enumerate(column.axes):
            data.dims[place].attach_scale(group[along])


def _dataset(group: h5py.Group, name: str, column: Column) -> h5py.Dataset:
    kind = h5py.string_dtype() if column.holds_words else column.values.dtype
    data = group.create_dataset(name, data=column.values, dtype=kind)
    data.attrs.update(column.attributes)
    return data


def check_writable(path: str | Path) -> None:
    """Raise `BadInput` if no file can be written at `path`; leave nothing there. Call it before long computations."""
    temporary = _temporary(Path(path))
    try:
        temporary.touch(exist_ok=False)
    except OSError as problem:
        raise BadInput(f"Cannot write {str(path)[:200]}: {problem.strerror or problem}.") from None
    temporary.unlink()


def _temporary(path: Path) -> Path:
    """Return the name of a file while it is being written, in its final folder."""
    if len(os.fsencode(path.name)) > _LONGEST_NAME:
        raise BadInput(f"Cannot write {str(path)[:60]}…: the name has more than {_LONGEST_NAME} bytes.")
    if not path.name or path.name == ".." or path.is_dir():
        raise BadInput(f"Cannot write {str(path)[:200]}: it is a folder; give a file in it.")
    return path.with_name(f".{path.name}.{os.getpid()}.tmp")


def write_file(path: str | Path, write: Callable[[h5py.File], None]) -> Path:
    """Write a file with `write` under a temporary name, seal it, rename it, and return the path.

    Raises `BadInput` if it cannot be written.
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
