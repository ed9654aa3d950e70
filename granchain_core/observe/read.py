"""A measured force from a file: strict CSV with time and force, or HDF5 as granchain writes it.

CSV columns: time, force and, if there is one, output force; a header may name the units (time_ms, force_mN), else they
are the caller's, or seconds and newtons by default.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import BadInput, unknown_name
from ..experiment import Series, read_data
from ..hdf5 import File, opened
from ..hdf5.plain import Refused
from ..integrate import State
from .record import ForceRecord, checked
from .table import Expected, Table, read_table

#: Units that are understood, in SI.
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6}
FORCE_UNITS = {"N": 1.0, "mN": 1e-3, "kN": 1e3}
#: Largest file accepted [bytes].
MOST_BYTES = 50_000_000
#: Most rows accepted.
MOST_ROWS = 1_000_000
#: Endings of the names of HDF5 files, whose beginning may be damaged.
_HDF5 = (".h5", ".hdf5")
_FORCES = {"force": ("force", "input_force", "f_in"), "output": ("output", "output_force", "f_out")}


def _words(names: tuple[str, ...], units: dict[str, float]) -> set[str]:
    return {*names, *(f"{name}_{unit.lower()}" for name in names for unit in units)}


_EXPECTED = Expected(
    columns={"time": _words(("time", "t"), TIME_UNITS),
             **{meaning: _words(names, FORCE_UNITS) for meaning, names in _FORCES.items()}},
    needed=("time", "force"), naming="time_s, force_N and, if there is one, output_force_N",
    short="time_s, force_N, output_force_N", content="time in s and force in N",
    widths="2 (time, force) or 3 (and output force)", most_bytes=MOST_BYTES, most_rows=MOST_ROWS,
)


def read_force(path: str | Path, time_unit: str | None = None, force_unit: str | None = None) -> ForceRecord:
    """The force in a CSV or HDF5 file; units for a CSV whose header names none. Raises `BadInput` naming the line."""
    path = Path(path)
    for what, unit, known in (("time unit", time_unit, TIME_UNITS), ("force unit", force_unit, FORCE_UNITS)):
        if unit is not None and unit not in known:
            raise unknown_name(what, unit, known)
    try:
        with open(path, "rb") as file:
            content = file.read(MOST_BYTES + 1)
    except OSError as problem:
        raise BadInput(f"Cannot read {str(path)[:200]}: {problem.strerror or problem}.") from None
    if content.startswith(b"\x89HDF") or path.suffix in _HDF5:
        if time_unit is not None or force_unit is not None:
            raise BadInput(f"{path.name} is an HDF5 file, whose units are s and N; they are chosen for CSV only.")
        return checked(_from_hdf5(path))
    try:
        return read_force_csv(content, time_unit, force_unit)
    except BadInput:
        found = None if time_unit or force_unit else _from_series(content, path.name)
        if found is None:
            raise
        return found


def _from_series(content: bytes, name: str) -> ForceRecord | None:
    """The input force of a series that has other columns too, as that of a rig; None where it is not clear."""
    try:
        series = read_data(content, wanted=("series",), source=name)
    except BadInput:
        return None
    if not isinstance(series, Series) or series.input_force is None:
        return None
    record = checked(ForceRecord(series.time, series.input_force, series.output_force))
    return replace(record, understood=series.understood)


def read_force_csv(text: str | bytes, time_unit: str | None = None, force_unit: str | None = None) -> ForceRecord:
    """The force in the text of a CSV file."""
    table = read_table(text, replace(_EXPECTED, units={
        "time": (time_unit or "s", *TIME_UNITS), **dict.fromkeys(_FORCES, (force_unit or "N", *FORCE_UNITS))}))
    seconds, told_time = _unit(table, "time", TIME_UNITS, time_unit, "s")
    newtons, told_force = _unit(table, "force", FORCE_UNITS, force_unit, "N")
    numbers = [number for number, _ in table.rows]
    values = np.array([row for _, row in table.rows])
    at = {meaning: values[:, place] for place, meaning in enumerate(table.order)}
    output = None
    if "output" in at:
        output = at["output"] * _unit(table, "output", FORCE_UNITS, force_unit, "N")[0]
    record = ForceRecord(at["time"] * seconds, at["force"] * newtons, output, lambda i: f"Line {numbers[i]}")
    return _told(checked(record), f"time in {told_time}, force in {told_force}; {table.layout}")


def _unit(table: Table, meaning: str, known: dict[str, float], asked: str | None, usual: str) -> tuple[float, str]:
    """A column's unit in SI and its name: the header's or the one asked for, which must agree, else the usual one."""
    named = None
    if table.header:
        last = table.header[table.order.index(meaning)].rsplit("_", 1)[-1]
        named = next((unit for unit in known if unit.lower() == last), None)
    if named is not None and asked is not None and known[named] != known[asked]:
        raise BadInput(f"Line 1: the header says the {meaning} is in {named}, and {asked} was asked for; "
                       "they must agree.")
    unit = named or asked or usual
    return known[unit], unit


def _told(record: ForceRecord, units: str) -> ForceRecord:
    output = "with" if record.output is not None else "no"
    return replace(record, understood=(
        f"{len(record.time)} samples from {record.time[0]:.6g} to {record.time[-1]:.6g} s, "
        f"{round(1.0 / record.spacing):d} a second, force {record.force.min():.4g} to {record.force.max():.4g} N, "
        f"{output} output force; {units}"))


def _from_hdf5(path: Path) -> ForceRecord:
    """Time, input force and output force of /run or /observation."""
    with opened(path, "is not a run or an observation written by granchain") as file:
        group = _group(file)
        rows = file.shape(f"{group}/time")
        if len(rows) != 1 or rows[0] > MOST_ROWS:
            raise Refused(f"/{group}/time has shape {rows}, expected one row of at most {MOST_ROWS} numbers")
        time, force, output = (
            file.numbers(f"{group}/{name}", rows, "any", unit) if name != "output_force" or file.has(f"{group}/{name}")
            else None for name, unit in (("time", "s"), ("input_force", "N"), ("output_force", "N")))
        assert time is not None and force is not None
    return _told(checked(ForceRecord(time, force, output)), "HDF5 in s and N")


def _group(file: File) -> str:
    """The group that holds a force."""
    for name in ("run", "observation"):
        if file.has(f"{name}/time") and file.has(f"{name}/input_force"):
            return name
    raise Refused("neither /run nor /observation has time and input_force; write it with 'granchain run SCENE --out "
                  "FILE'")


def first_state(path: str | Path, beads: int) -> State:
    """The first displacements and velocities in an HDF5 file of granchain, where an observer may start."""
    with opened(path, "has no state to start from") as file:
        group = _group(file)
        shape = (*file.shape(f"{group}/time"), beads)
        if shape[0] < 1:
            raise Refused("it has no samples")
        u, v = (file.numbers(f"{group}/{name}", shape, "any", unit, rows=1)[0]
                for name, unit in (("displacement", "m"), ("velocity", "m/s")))
    return State(u, v)
