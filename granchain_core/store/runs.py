"""Runs in HDF5: netCDF-4-style groups with dimension scales, units and provenance.

/run    time (s), bead, contact; displacement, velocity, kinetic_energy (time, bead); force (time, contact);
        drive_displacement, input_force, output_force, output_force_elastic (time)
        jump; jump_time (s), jump_contact, jump_force (N) (jump): closings at which the force jumps from 0
        max_input_force, max_output_force, max_output_force_elastic (N), their errors, regime, period: one of each
In addition to the attributes of every root, a run's root has the largest forces, their errors, cost, regime, status and
start.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import BadInput
from ..hdf5 import File, opened
from ..hdf5.checked_file import entries, finite, one_of, within
from ..hdf5.plain import Refused
from ..results.forces import RUN_ERRORS, ForceErrors
from ..results.recorded_motion import motion_units
from ..results.regime import FOUND_BY, NAMES, Regime
from ..results.run import AT_REST, GIVEN_STATE, RUN_STARTS, Cost, Jumps, Run
from ..tables import MAXIMA
from ..tables.table import units_by_path
from .writing import or_none

#: Values of a run's `status`.
STATUSES = ("done", "accuracy-not-reached", "over-budget")
#: Spelling of `GIVEN_STATE` in older files of a steady state.
_PREVIOUS_STATE = "previous state"
#: Functions of granchain_core.store that read other results, by a table in the file.
_LOADED = {"curve": "load_curve", "branch": "load_branch"}


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
        kind = _other_result(file)
        if not kind:
            return _read(file)
    raise BadInput(f"`load` reads runs, and {str(path)[:200]} holds another result: {kind}.")


def _other_result(file: File) -> str:
    """Describe the tables of a file with another result than a run, and what reads them; empty for a run."""
    if file.has("run/time"):
        return ""
    groups = sorted({name.partition("/")[0] for name in file.names() if "/" in name})
    if not groups or "run" in groups:
        return ""
    own = next((_LOADED[name] for name in groups if name in _LOADED), None)
    how = f"granchain_core.store.{own} reads it" if own else f'xarray.open_dataset(path, group="{groups[0]}") reads one'
    return f"its tables are {', '.join(groups)[:80]}; {how}"


def _read(file: File) -> Run:
    """Return the run in a file."""
    scene, rows = file.scene(), _rows(file)
    file.expect_units({**motion_units("run"), **units_by_path("run", Jumps().columns())})
    arrays = {name: file.numbers(f"run/{name}", (rows, *width)) for name, width in (
        ("time", ()), ("displacement", (scene.N,)), ("velocity", (scene.N,)), ("force", (scene.N + 1,)),
        ("drive_displacement", ()))}
    largest = {name: finite(name, file.number(name)) for name in MAXIMA}
    return Run(
        scene=scene, samples=file.whole("samples_per_period", 1),
        status=one_of("status", file.text("status"), STATUSES),
        start=_start(file),
        regime=_regime(file), cost=_cost(file), jumps=_read_jumps(file, scene.N),
        displacement_error=or_none(file.number("accuracy_reached")),
        energy_residual=or_none(file.number("energy_residual")),
        force_errors=ForceErrors(*(or_none(file.number(name, absent=np.nan)) for name in RUN_ERRORS)),
        **arrays, **largest,  # type: ignore[arg-type]  # the run's fields
    )


def _start(file: File) -> str:
    """Return the start of a run; older files, which lack this entry, are of runs from rest."""
    if not file.stated("start"):
        return AT_REST
    text = file.text("start")
    return GIVEN_STATE if text == _PREVIOUS_STATE else one_of("start", text, RUN_STARTS)


def _rows(file: File) -> int:
    """Return the number of samples of a run, at least one."""
    shape = file.shape("run/time")
    if len(shape) != 1 or shape[0] < 1:
        raise Refused(f"/run/time has shape {shape}, expected one row of samples")
    return shape[0]


def _cost(file: File) -> Cost:
    return Cost(**entries("cost", file.json("cost"), {"wall_s": "number", "steps": "whole", "rhs": "whole",
                                                      "events": "whole", "method": "text"}))


def _regime(file: File) -> Regime:
    regime = file.json("regime")
    if isinstance(regime, dict) and "decay" not in regime:  # files from before decay and |μ| were distinguished
        regime["decay"] = regime.pop("multiplier", None)
    lyapunov, ratios = ((regime.pop(name, None) for name in ("lyapunov", "window_ratios")) if isinstance(regime, dict)
                        else (None, None))
    values = entries("regime", regime, {
        "name": "text", "period": "whole?", "decay": "number?", "distance": "number?", "periods_run": "whole",
        "multiplier": "number?", "followed": "flag?", "approaches": "whole?", "driven": "flag?",
        "lyapunov_periods": "whole?", "return_distance": "number?", "return_limit": "number?", "followed_by": "text?"})
    one_of("regime", values["name"], NAMES)
    if values["followed_by"] is not None:
        one_of("regime.followed_by", values["followed_by"], FOUND_BY[1:])
    if lyapunov is not None:
        values["lyapunov"] = _pair("regime.lyapunov", lyapunov, "mean", "error")
    if ratios is not None:
        values["window_ratios"] = _pair("regime.window_ratios", ratios, "smallest", "largest")
    return Regime.from_json({**values, "followed": bool(values["followed"]), "driven": values["driven"] is not False})


def _pair(place: str, values: object, first: str, second: str) -> tuple[float, ...]:
    """Return two numbers of a regime."""
    if not isinstance(values, list) or len(values) != 2:
        raise Refused(f"{place} is not a pair of numbers")
    return tuple(entries(place, dict(zip((first, second), values, strict=True)),
                         {first: "number", second: "number"}).values())


def _read_jumps(file: File, beads: int) -> Jumps:
    """Return the jumps of a run; files from before they were recorded have none."""
    if not file.has("run/jump_time"):
        return Jumps()
    count = file.shape("run/jump_time")[:1]
    contact = file.numbers("run/jump_contact", count, "i")
    return Jumps(file.numbers("run/jump_time", count), within("/run/jump_contact", contact, 0, beads),
                 file.numbers("run/jump_force", count),
                 *(file.whole(name, 0, "run/jump_time") for name in ("missing", "unresolved")))
