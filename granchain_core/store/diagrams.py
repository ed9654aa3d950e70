"""Two-parameter diagrams as HDF5: /map with the two knobs as labelled axes.

/map    one dimension scale per knob, named as the knob; max_input_force, max_output_force, max_output_force_elastic,
        their relative errors error_estimate_input, error_estimate (of the output force), error_estimate_elastic,
        decay, multiplier, lyapunov, lyapunov_error, regime, period, periods_run (y, x)
The root's attribute `amplitude` describes A0 over f where it is not the scene's.
"""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np

from ..diagram import Axis, Diagram, Grid
from ..diagram.cells import CELL, REGIMES, empty_cells
from ..diagram.grid import KNOBS, MOST_CELLS
from ..hdf5 import File, opened
from ..hdf5.border import one_of, within
from ..hdf5.plain import Refused
from ..quantities import QUANTITIES
from ..scene import Amplitude
from .writing import write_axis, write_file, write_root, write_values

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
        write_root(file, grid.scene, "rk4 in lanes", float(known.max()) if len(known) else None)
        file.attrs["map_digest"], file.attrs["wall_s"] = grid.digest, diagram.wall_s
        file.attrs["map_axes"] = json.dumps([grid.y.knob, grid.x.knob])
        if grid.amplitude is not None:
            file.attrs["amplitude"] = json.dumps(grid.amplitude.to_json())
        group = file.create_group("map")
        for axis in (grid.y, grid.x):
            quantity = QUANTITIES[axis.knob]
            write_axis(group, axis.knob, axis.array, quantity.unit, quantity.label)
        for name, (unit, meaning) in _COLUMNS.items():
            write_values(group, name, diagram.column(name), (grid.y.knob, grid.x.knob), unit, meaning)
        codes = np.array([-1, *range(len(REGIMES))], dtype=np.int8)
        group["regime"].attrs["flag_values"] = codes
        group["regime"].attrs["flag_meanings"] = " ".join(["not_computed", *REGIMES])

    return write_file(path, write)


def load_diagram(path: str | Path) -> Diagram:
    """The diagram that `save_diagram` wrote. Raises `BadInput` for a file that is not one."""
    with opened(path, "is not a map written by granchain") as file:
        file.schema()
        return _read(file)


def _read(file: File) -> Diagram:
    names = file.json("map_axes")
    if not isinstance(names, list) or len(names) != 2:
        raise Refused(f"attribute map_axes is {str(names)[:40]!r}, not two knobs")
    y, x = (one_of("map_axes", name, KNOBS) for name in names)
    scene, shape = file.scene(), (*file.shape(f"map/{y}"), *file.shape(f"map/{x}"))
    if len(shape) != 2 or shape[0] * shape[1] > MOST_CELLS:
        raise Refused(f"its axes have shape {shape}; expected two with at most {MOST_CELLS} cells")
    axes = (Axis.of(knob, file.numbers(f"map/{knob}", (count,), unit=QUANTITIES[knob].unit))
            for knob, count in zip((y, x), shape, strict=True))
    down, across = axes
    amplitude = Amplitude.from_json(file.json("amplitude")) if file.stated("amplitude") else None
    grid = Grid(scene, across, down, amplitude)
    cells, kept = empty_cells(grid), [name for name in CELL.names or () if file.has(f"map/{name}")]
    for name in kept:  # earlier versions kept fewer columns
        cells[name] = _column(file, name, shape)
    if "decay" not in kept:  # files written before the two were told apart
        cells["decay"], cells["multiplier"] = cells["multiplier"].copy(), np.nan
    return Diagram(grid, cells, file.number("wall_s"))


def _column(file: File, name: str, shape: tuple[int, ...]) -> np.ndarray:
    """One column of all cells; a number that does not fit into its place in the table is refused."""
    kind, path = CELL[name], f"map/{name}"
    if kind.kind == "f":
        return file.numbers(path, shape, unit=_COLUMNS[name][0]).reshape(-1)
    low, high = (-1, len(REGIMES) - 1) if name == "regime" else (0, np.iinfo(kind).max)
    return within(f"/{path}", file.numbers(path, shape, "i"), low, high).reshape(-1)
