"""A measured force from a file: a table that granchain_core/experiment reads, or HDF5 written by granchain.

Here a table needs no header: its columns are then time, force and, if there is a third, output force. A column without
a unit is in seconds or newtons, or in the unit that the caller gives.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ..errors import BadInput
from ..experiment import Answers, Convention, Series, Unclear, read_data
from ..experiment.measured import MOST_BYTES, MOST_ROWS
from ..experiment.reader import content_of
from ..experiment.units import UNITS, unit_named
from ..hdf5 import SIGNATURE, File, opened
from ..hdf5.plain import Refused
from ..inputs.checks import unknown_name
from ..results.recorded_motion import motion_units
from ..scene.state import State
from .record import ForceRecord, checked

#: Suffixes of HDF5 files, which are recognised by them even if their beginning is damaged.
_HDF5 = (".h5", ".hdf5")


def read_force(path: str | Path, time_unit: str | None = None, force_unit: str | None = None,
               answers: Answers | None = None) -> ForceRecord:
    """Read the force from a table or an HDF5 file; the units are for a table whose header gives none.

    `answers` are the user's answers to questions about the table. Raises `Unclear` with a question that has to be
    asked, and `BadInput` naming the line.
    """
    path = Path(path)
    content = content_of(path)
    if content.startswith(SIGNATURE[:4]) or path.suffix in _HDF5:
        if time_unit is not None or force_unit is not None:
            raise BadInput(f"{path.name} is an HDF5 file, whose units are s and N; units can be chosen for CSV only.")
        return checked(_from_hdf5(path))
    try:
        return read_force_csv(content, time_unit, force_unit, answers)
    except Unclear as unclear:
        raise Unclear(replace(unclear.question, reason=f"{path.name}: {unclear.question.reason}")) from None
    except BadInput as problem:
        raise BadInput(f"{path.name}: {problem}") from None


def read_force_csv(text: str | bytes, time_unit: str | None = None, force_unit: str | None = None,
                   answers: Answers | None = None) -> ForceRecord:
    """Read the force from the text of a table. Raises the same exceptions as `read_force`."""
    units = {"time": _unit("time", time_unit), **dict.fromkeys(("input_force", "output_force"),
                                                               _unit("force", force_unit))}
    insisted = (*(("time",) if time_unit else ()), *(("input_force", "output_force") if force_unit else ()))
    convention = Convention(("time", "input_force", "output_force"), units, insisted, {"force": "input_force"})
    content = text if isinstance(text, bytes) else text.encode("utf-8", "replace")
    series = read_data(content, answers, ("series",), most_bytes=MOST_BYTES, most_rows=MOST_ROWS,
                       convention=convention)
    assert isinstance(series, Series)
    if series.input_force is None:
        raise BadInput(f"The file has no input force: {series.understood}.")
    lines, understood = series.lines, series.understood
    if series.output_force is None and series.left_out and not (answers and answers.columns):
        understood = (f"No comparison with a measured output force, as no column is known as one (left out: "
                      f"{', '.join(series.left_out)[:200]}); {understood}")
    record = ForceRecord(series.time + series.began, series.input_force, series.output_force,
                         lambda i: f"Line {lines[i]}")
    return replace(checked(record), understood=understood)


def _unit(dimension: str, unit: str | None) -> str:
    """The symbol of the requested unit, or of the SI unit."""
    known = UNITS[dimension]
    symbol = next(iter(known)) if unit is None else unit_named(unit)
    if symbol not in known:
        raise unknown_name(f"{dimension} unit", str(unit), known)
    return str(symbol)


def _described(record: ForceRecord, units: str) -> ForceRecord:
    """The record with a sentence on how it was read."""
    output = "with" if record.output is not None else "no"
    return replace(record, understood=(
        f"{len(record.time)} samples from {record.time[0]:.6g} to {record.time[-1]:.6g} s, "
        f"{round(1.0 / record.spacing):d} per second, force {record.force.min():.4g} to {record.force.max():.4g} N, "
        f"{output} output force; {units}"))


def _from_hdf5(path: Path) -> ForceRecord:
    """Time, input force and output force of /run or /observation."""
    with opened(path, "is not a run or an observation written by granchain") as file:
        group = _group(file)
        rows = file.shape(f"{group}/time")
        if len(rows) != 1 or rows[0] > MOST_ROWS:
            raise Refused(f"/{group}/time has shape {rows}, expected one row of at most {MOST_ROWS} numbers")
        file.expect_units(motion_units(group))
        time, force, output = (
            file.numbers(f"{group}/{name}", rows, "any") if name != "output_force" or file.has(f"{group}/{name}")
            else None for name in ("time", "input_force", "output_force"))
        assert time is not None and force is not None
    return _described(checked(ForceRecord(time, force, output)), "HDF5 in s and N")


def _group(file: File) -> str:
    """The group that contains a force."""
    for name in ("run", "observation"):
        if file.has(f"{name}/time") and file.has(f"{name}/input_force"):
            return name
    raise Refused("neither /run nor /observation has time and input_force; write it with 'granchain run SCENE --out "
                  "FILE'")


def first_state(path: str | Path, beads: int) -> State:
    """Read the first displacements and velocities from an HDF5 file of granchain, as the start of an observer."""
    with opened(path, "has no state to start from") as file:
        group = _group(file)
        shape = (*file.shape(f"{group}/time"), beads)
        if shape[0] < 1:
            raise Refused("it has no samples")
        file.expect_units(motion_units(group))
        u, v = (file.numbers(f"{group}/{name}", shape, "any", rows=1)[0] for name in ("displacement", "velocity"))
    return State(u, v)
