"""HDF5 in and out: netCDF-4-style groups with dimension scales, units and provenance.

/run    time (s), bead, contact; displacement, velocity, kinetic_energy (time, bead); force (time, contact);
        drive_displacement, input_force, output_force, output_force_elastic (time)
        jump; jump_time (s), jump_contact, jump_force (N) (jump): closings at which the force jumps from 0
/curve  frequency (Hz); max_output_force, max_output_force_elastic, max_input_force, their relative errors
        error_estimate (of the output force), error_estimate_elastic, error_estimate_input (frequency);
        regime, status, period (frequency)
The root carries schema version, scene, method, accuracy asked and reached, cost, versions and time of writing. A file
is written under a temporary name, sealed with its checksum (hdf5/seal.py), synced and renamed: there is never half a
file under its own name.
"""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import h5py
import numba
import numpy as np

from ..errors import BadInput
from ..hdf5 import VERSIONS, File, opened, seal
from ..hdf5.border import SCHEMA, entries, finite, one_of, within
from ..hdf5.plain import Refused
from ..integrate.batch import can_share_batch
from ..integrate.methods import CERTIFIED, LIVE
from ..kernels.width import machine
from ..quantities import QUANTITIES
from ..regime import Regime
from ..result import Cost, ForceErrors, Jumps, Run
from ..scene import Scene
from ..scene.validity import overlap_warnings
from ..steady.curve import Curve
from ..version import __version__

#: What a run's `status` and `start` can be, and the name of its regime.
STATUSES = ("done", "accuracy-not-reached", "over-budget")
STARTS = ("rest", "initial velocity", "given state")
REGIMES = ("periodic", "quasi-periodic", "chaotic", "unsettled")
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
#: File systems take 255 bytes; the temporary name needs some of them.
_LONGEST_NAME = 230
_MAXIMA = ("max_input_force", "max_output_force", "max_output_force_elastic")
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
        _provenance(file, result.scene, result.cost.method, result.error_estimate)
        _save_numbers(file, result)
        group = file.create_group("run")
        _scale(group, "time", result.time, "s", "time since the start, at drive phase 0")
        _scale(group, "bead", np.arange(1, result.scene.N + 1), "1", "bead number from the driver")
        _scale(group, "contact", np.arange(result.scene.N + 1), "1", "contact number; c joins bodies c and c + 1")
        for name, (dimensions, unit, meaning) in _RUN.items():
            _variable(group, name, getattr(result, name), dimensions, unit, meaning)
        _save_jumps(group, result.jumps)

    return _write(path, write)


def _save_numbers(file: h5py.File, result: Run) -> None:
    """Write what a run has one of as attributes: status, warnings, cost, regime, largest forces and their errors."""
    file.attrs["status"], file.attrs["start"] = result.status, result.start
    file.attrs["warnings"] = json.dumps(overlap_warnings(result.scene, result.overlap.max(axis=0)))
    file.attrs["energy_residual"] = _or_nan(result.energy_residual)
    file.attrs["samples_per_period"] = result.samples
    file.attrs["cost"] = json.dumps(asdict(result.cost))
    file.attrs["regime"] = json.dumps(asdict(result.regime))
    for name in _MAXIMA:
        file.attrs[name] = getattr(result, name)
    for name, value in zip(_ERRORS, result.force_errors.row, strict=True):
        file.attrs[name] = value


def _save_jumps(group: h5py.Group, jumps: Jumps) -> None:
    _scale(group, "jump", np.arange(len(jumps.time)), "1", "number of the closing at which a contact force jumps")
    _variable(group, "jump_time", jumps.time, ("jump",), "s", "time at which a contact closes in motion")
    _variable(group, "jump_contact", jumps.contact, ("jump",), "1", "contact that closes")
    _variable(group, "jump_force", jumps.force, ("jump",), "N", "its force just after, where it was 0 before")
    group["jump_time"].attrs["missing"], group["jump_time"].attrs["unresolved"] = jumps.missing, jumps.unresolved


def save_curve(curve: Curve, path: str | Path) -> Path:
    """Write a resonance curve to `path`; returns the path. Raises `BadInput` where it cannot be written."""

    single = f"{LIVE} or {CERTIFIED} point by point"
    method = f"rk4 in batches, {single}" if can_share_batch(curve.scene) else single

    def write(file: h5py.File) -> None:
        reached = [p.error_estimate for p in curve.points if p.error_estimate is not None]
        _provenance(file, curve.scene, method, max(reached) if reached else None)
        file.attrs["start"], file.attrs["wall_s"] = curve.start, curve.wall_s
        group = file.create_group("curve")
        _scale(group, "frequency", curve.column("frequency"), "Hz", "drive frequency")
        for name in _MAXIMA:
            words = name.replace("_", " ").replace("max", "largest", 1)
            _variable(group, name, curve.column(name), ("frequency",), "N", f"{words} in the steady state")
        errors = np.array([p.force_errors.row for p in curve.points])
        for column, (name, force) in enumerate((("error_estimate_input", "input"), ("error_estimate", "output"),
                                                ("error_estimate_elastic", "elastic output"))):
            _variable(group, name, errors[:, column], ("frequency",), "1", f"relative error of largest {force} force")
        periods = np.array([p.regime.period or 0 for p in curve.points])
        _variable(group, "period", periods, ("frequency",), "1", "period in drive periods, 0 where not periodic")
        outcomes = np.array([p.status for p in curve.points], dtype=h5py.string_dtype())
        _variable(group, "status", outcomes, ("frequency",), "", "done, or how the numbers failed")
        names = np.array([p.regime.name for p in curve.points], dtype=h5py.string_dtype())
        _variable(group, "regime", names, ("frequency",), "", "periodic, quasi-periodic, chaotic or unsettled")

    return _write(path, write)


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
    largest = {name: finite(name, file.number(name)) for name in _MAXIMA}
    return Run(
        scene=scene, samples=file.whole("samples_per_period", 1),
        status=one_of("status", file.text("status"), STATUSES),
        start=one_of("start", file.text("start") if file.stated("start") else STARTS[0], STARTS),
        regime=_regime(file), cost=_cost(file), jumps=_read_jumps(file, scene.N),
        error_estimate=_or_none(file.number("accuracy_reached")),
        energy_residual=_or_none(file.number("energy_residual")),
        force_errors=ForceErrors(*(_or_none(file.number(name, absent=np.nan)) for name in _ERRORS)),
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
        "multiplier": "number?", "followed": "flag?", "approaches": "whole?"})
    one_of("regime", told["name"], REGIMES)
    if lyapunov is not None:
        mean, error = lyapunov
        told["lyapunov"] = tuple(entries("regime.lyapunov", {"mean": mean, "error": error},
                                         {"mean": "number", "error": "number"}).values())
    return Regime(**{**told, "followed": bool(told["followed"])})


def _read_jumps(file: File, beads: int) -> Jumps:
    """The jumps of a run; files written before they were kept have none."""
    if not file.has("run/jump_time"):
        return Jumps()
    count = file.shape("run/jump_time")[:1]
    contact = file.numbers("run/jump_contact", count, "i")
    return Jumps(file.numbers("run/jump_time", count, unit="s"), within("/run/jump_contact", contact, 0, beads),
                 file.numbers("run/jump_force", count, unit="N"),
                 *(file.whole(name, 0, "run/jump_time") for name in ("missing", "unresolved")))


def _or_nan(value: float | None) -> float:
    return np.nan if value is None else value


def _or_none(value: float) -> float | None:
    return None if np.isnan(value) else float(value)


def _provenance(file: h5py.File, scene: Scene, method: str, reached: float | None) -> None:
    file.attrs.update({
        "Conventions": "CF-1.10", "granchain_schema": SCHEMA, "granchain_version": __version__,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "versions": json.dumps({"numpy": np.__version__, "numba": numba.__version__, "h5py": h5py.__version__,
                                "python": platform.python_version()}),
        "machine": machine(),
        "scene_name": scene.name, "scene": json.dumps(scene.to_json()), "scene_digest": scene.digest,
        "method": method, "accuracy_asked": scene.accuracy, "accuracy_reached": _or_nan(reached),
    })
    for name, value in scene.knobs.items():
        file.attrs[f"knob_{name}"] = value
        file.attrs[f"knob_{name}_unit"] = QUANTITIES[name].unit


def _scale(group: h5py.Group, name: str, values: np.ndarray, unit: str, meaning: str) -> None:
    data = group.create_dataset(name, data=values)
    data.make_scale(name)
    data.attrs["units"], data.attrs["long_name"] = unit, meaning


def _variable(group: h5py.Group, name: str, values: Any, dimensions: tuple[str, ...], unit: str, meaning: str) -> None:
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


def _write(path: str | Path, write: Callable[[h5py.File], None]) -> Path:
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
