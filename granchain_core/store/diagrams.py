"""Two-parameter diagrams as HDF5: /map with the two knobs as labelled axes.

/map    one dimension scale per knob, named as the knob; max_input_force, max_output_force, max_output_force_elastic,
        their relative errors error_estimate_input, error_estimate (of the output force), error_estimate_elastic,
        decay, multiplier, lyapunov, lyapunov_error, regime, period, periods_run (y, x)
"""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np

from ..diagram import Axis, Diagram, Grid
from ..diagram.cells import CELL, REGIMES, empty_cells
from ..errors import BadInput
from ..quantities import QUANTITIES
from ..scene import Scene
from .files import SCHEMA, _provenance, _scale, _variable, _write

_COLUMNS = {  # name: (unit, meaning)
    "max_input_force": ("N", "largest force of the driver on bead 1 in the steady state"),
    "max_output_force": ("N", "largest force on the wall in the steady state"),
    "max_output_force_elastic": ("N", "largest elastic force on the wall in the steady state, the paper's F_out"),
    "error_estimate_input": ("1", "relative error of the largest input force, NaN where none is claimed"),
    "error_estimate": ("1", "relative error of the largest output force, NaN where none is claimed"),
    "error_estimate_elastic": ("1", "relative error of the largest elastic output force, NaN where none is claimed"),
    "regime": ("", "what the motion is"),
    "period": ("1", "period in drive periods, 0 where not periodic"),
    "periods_run": ("1", "drive periods run until that was decided"),
    "decay": ("1", "factor by which changes shrank per orbit, NaN where not seen"),
    "multiplier": ("1", "modulus of the leading multiplier, NaN where not computed"),
    "lyapunov": ("1", "largest Lyapunov exponent per drive period, NaN where not measured"),
    "lyapunov_error": ("1", "standard error of the Lyapunov exponent"),
}


def save_diagram(diagram: Diagram, path: str | Path) -> Path:
    """Write a diagram to `path`; returns the path. Raises `BadInput` where it cannot be written."""
    grid = diagram.grid

    def write(file: h5py.File) -> None:
        errors = diagram.cells["error_estimate"]
        known = errors[np.isfinite(errors)]
        _provenance(file, grid.scene, "rk4 in lanes", float(known.max()) if len(known) else None)
        file.attrs["map_digest"], file.attrs["wall_s"] = grid.digest, diagram.wall_s
        file.attrs["map_axes"] = json.dumps([grid.y.knob, grid.x.knob])
        group = file.create_group("map")
        for axis in (grid.y, grid.x):
            quantity = QUANTITIES[axis.knob]
            _scale(group, axis.knob, axis.array, quantity.unit, quantity.label)
        for name, (unit, meaning) in _COLUMNS.items():
            _variable(group, name, diagram.column(name), (grid.y.knob, grid.x.knob), unit, meaning)
        codes = np.array([-1, *range(len(REGIMES))], dtype=np.int8)
        group["regime"].attrs["flag_values"] = codes
        group["regime"].attrs["flag_meanings"] = " ".join(["not_computed", *REGIMES])

    return _write(path, write)


def load_diagram(path: str | Path) -> Diagram:
    """The diagram that `save_diagram` wrote. Raises `BadInput` for a file that is not one."""
    try:
        with h5py.File(path, "r") as file:
            if int(file.attrs["granchain_schema"]) != SCHEMA:
                raise BadInput(f"{path}: schema {file.attrs['granchain_schema']}, this version reads {SCHEMA}.")
            y, x = json.loads(file.attrs["map_axes"])
            grid = Grid(Scene.from_json(json.loads(file.attrs["scene"])), Axis.of(x, file["map"][x][()]),
                        Axis.of(y, file["map"][y][()]))
            cells = empty_cells(grid)
            for name in CELL.names or ():
                if name != "number" and name in file["map"]:  # earlier versions kept fewer columns
                    cells[name] = file["map"][name][()].reshape(-1)
            if "decay" not in file["map"]:  # files written before the two were told apart
                cells["decay"], cells["multiplier"] = cells["multiplier"].copy(), np.nan
            return Diagram(grid, cells, float(file.attrs["wall_s"]))
    except BadInput:
        raise
    except (OSError, KeyError, TypeError, ValueError, AttributeError) as problem:
        raise BadInput(f"{path} is not a map written by granchain: {problem}.") from None
