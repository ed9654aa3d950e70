"""Runs in HDF5: netCDF-4-style groups with dimension scales, units and provenance.

/run    time (s), bead, contact; displacement, velocity, kinetic_energy (time, bead); force (time, contact);
        drive_displacement, input_force, output_force, output_force_elastic (time)
        jump; jump_time (s), jump_contact, jump_force (N) (jump): closings at which the force jumps from 0
The root carries the largest forces with their errors, cost, regime, status and start, besides what writing.py puts
there.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from ..hdf5 import File, opened
from ..hdf5.border import entries, finite, one_of, within
from ..hdf5.plain import Refused
from ..regime import NAMES, Regime
from ..result import Cost, ForceErrors, Jumps, Run
from ..scene.validity import overlap_warnings
from .writing import MAXIMA, or_nan, or_none, write_axis, write_file, write_root, write_values

#: What a run's `status` and `start` can be.
STATUSES = ("done", "accuracy-not-reached", "over-budget")
STARTS = ("rest", "initial velocity", "given state")
_RUN = {  # name: (dimensions, unit, meaning)
    "displacement": (("time", "bead"), "m", "bead displacement from its rest position"),
    "velocity": (("time", "bead"), "m/s", "bead velocity"),
    "kinetic_energy": (("time", "bead"), "J", "kinetic energy of each bead"),
    "force": (("time", "contact"), "N", "contact force, elastic and damping; contact 0 is the driver's, N the wall's"),
    "drive_displacement": (("time",), "m", "displacement of the driver"),
    "input_force": (("time",), "N", "force of the driver on bead 1"),
    "output_force": (("time",), "N", "force on the wall, elastic and damping"),
    "output_force_elastic": (("time",), "N", "elastic part of the force on the wall, the paper's F_out"),
}
#: Attributes of a run's file with the relative errors of the largest forces.
_ERRORS = ("error_estimate_input", "error_estimate_output", "error_estimate_elastic")


def save(result: Run, path: str | Path) -> Path:
    """Write a run to an HDF5 file with labelled axes and units (README.md, "Files").

    Parameters
    ----------
    result : Run
        What `run` returned.
    path : str or pathlib.Path
        The file; one that is there is replaced when the new one is complete.

    Returns
    -------
    pathlib.Path
        The file.

    Raises
    ------
    BadInput
        It cannot be written.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> from granchain_core import load, run, save, scene
    >>> result = run(scene("sec2").evolve(N=2, f=2000.0), periods=0, record=1, samples=8)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     again = load(save(result, pathlib.Path(folder) / "run.h5"))
    >>> bool((again.displacement == result.displacement).all())
    True
    """

    def write(file: h5py.File) -> None:
        write_root(file, result.scene, result.cost.method, result.error_estimate)
        _save_numbers(file, result)
        group = file.create_group("run")
        write_axis(group, "time", result.time, "s", "time since the start, at drive phase 0")
        write_axis(group, "bead", np.arange(1, result.scene.N + 1), "1", "bead number from the driver")
        write_axis(group, "contact", np.arange(result.scene.N + 1), "1", "contact number; c joins bodies c and c + 1")
        for name, (dimensions, unit, meaning) in _RUN.items():
            write_values(group, name, getattr(result, name), dimensions, unit, meaning)
        _save_jumps(group, result.jumps)

    return write_file(path, write)


def _save_numbers(file: h5py.File, result: Run) -> None:
    """Write what a run has one of as attributes: status, warnings, cost, regime, largest forces and their errors."""
    file.attrs["status"], file.attrs["start"] = result.status, result.start
    file.attrs["warnings"] = json.dumps(overlap_warnings(result.scene, result.overlap.max(axis=0)))
    file.attrs["energy_residual"] = or_nan(result.energy_residual)
    file.attrs["samples_per_period"] = result.samples
    file.attrs["cost"] = json.dumps(asdict(result.cost))
    file.attrs["regime"] = json.dumps(asdict(result.regime))
    for name in MAXIMA:
        file.attrs[name] = getattr(result, name)
    for name, value in zip(_ERRORS, result.force_errors.row, strict=True):
        file.attrs[name] = value


def _save_jumps(group: h5py.Group, jumps: Jumps) -> None:
    write_axis(group, "jump", np.arange(len(jumps.time)), "1", "number of the closing at which a contact force jumps")
    write_values(group, "jump_time", jumps.time, ("jump",), "s", "time at which a contact closes in motion")
    write_values(group, "jump_contact", jumps.contact, ("jump",), "1", "contact that closes")
    write_values(group, "jump_force", jumps.force, ("jump",), "N", "its force just after, where it was 0 before")
    group["jump_time"].attrs["missing"], group["jump_time"].attrs["unresolved"] = jumps.missing, jumps.unresolved


def load(path: str | Path) -> Run:
    """Read the run that `save` wrote.

    Parameters
    ----------
    path : str or pathlib.Path
        The file.

    Returns
    -------
    Run
        The same numbers, bit by bit.

    Raises
    ------
    BadInput
        There is no such file, or it is not a run written by granchain.

    Examples
    --------
    >>> from granchain_core import load
    >>> load("nothing-there.h5")
    Traceback (most recent call last):
    ...
    granchain_core.errors.BadInput: nothing-there.h5 is not a run written by granchain: ...
    """
    with opened(path, "is not a run written by granchain") as file:
        file.schema()
        return _read(file)


def _read(file: File) -> Run:
    """The run in a file."""
    scene, rows = file.scene(), _rows(file)
    arrays = {name: file.numbers(f"run/{name}", (rows, *width), unit=unit) for name, width, unit in (
        ("time", (), "s"), ("displacement", (scene.N,), "m"), ("velocity", (scene.N,), "m/s"),
        ("force", (scene.N + 1,), "N"), ("drive_displacement", (), "m"))}
    largest = {name: finite(name, file.number(name)) for name in MAXIMA}
    return Run(
        scene=scene, samples=file.whole("samples_per_period", 1),
        status=one_of("status", file.text("status"), STATUSES),
        start=one_of("start", file.text("start") if file.stated("start") else STARTS[0], STARTS),
        regime=_regime(file), cost=_cost(file), jumps=_read_jumps(file, scene.N),
        error_estimate=or_none(file.number("accuracy_reached")),
        energy_residual=or_none(file.number("energy_residual")),
        force_errors=ForceErrors(*(or_none(file.number(name, absent=np.nan)) for name in _ERRORS)),
        **arrays, **largest,  # type: ignore[arg-type]  # names of its fields
    )


def _rows(file: File) -> int:
    """How many samples a run has, at least one."""
    shape = file.shape("run/time")
    if len(shape) != 1 or shape[0] < 1:
        raise Refused(f"/run/time has shape {shape}, expected one row of samples")
    return shape[0]


def _cost(file: File) -> Cost:
    return Cost(**entries("cost", file.json("cost"), {"wall_s": "number", "steps": "whole", "rhs": "whole",
                                                      "events": "whole", "method": "text"}))


def _regime(file: File) -> Regime:
    found = file.json("regime")
    if isinstance(found, dict) and "decay" not in found:  # files written before decay and |μ| were told apart
        found["decay"] = found.pop("multiplier", None)
    lyapunov = found.pop("lyapunov", None) if isinstance(found, dict) else None
    told = entries("regime", found, {
        "name": "text", "period": "whole?", "decay": "number?", "distance": "number?", "periods_run": "whole",
        "multiplier": "number?", "followed": "flag?", "approaches": "whole?", "driven": "flag?"})
    one_of("regime", told["name"], NAMES)
    if lyapunov is not None:
        mean, error = lyapunov
        told["lyapunov"] = tuple(entries("regime.lyapunov", {"mean": mean, "error": error},
                                         {"mean": "number", "error": "number"}).values())
    return Regime(**{**told, "followed": bool(told["followed"]), "driven": told["driven"] is not False})


def _read_jumps(file: File, beads: int) -> Jumps:
    """The jumps of a run; files written before they were kept have none."""
    if not file.has("run/jump_time"):
        return Jumps()
    count = file.shape("run/jump_time")[:1]
    contact = file.numbers("run/jump_contact", count, "i")
    return Jumps(file.numbers("run/jump_time", count, unit="s"), within("/run/jump_contact", contact, 0, beads),
                 file.numbers("run/jump_force", count, unit="N"),
                 *(file.whole(name, 0, "run/jump_time") for name in ("missing", "unresolved")))
