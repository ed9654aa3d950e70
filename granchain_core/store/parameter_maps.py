"""Parameter maps as HDF5: /map with the two knobs as labelled axes.

/map    one dimension scale per knob, named as the knob; max_input_force, max_output_force, max_output_force_elastic,
        their relative errors error_estimate_input, error_estimate (of the output force; docs/result-files.md, "Which
        name is which error"), error_estimate_elastic,
        decay, multiplier, lyapunov, lyapunov_error, lyapunov_periods, regime, period, periods_run (y, x)
The root's attribute `amplitude` describes A0 over f if it is not the scene's.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..hdf5 import File, opened
from ..hdf5.checked_file import one_of, within
from ..hdf5.plain import Refused
from ..parameter_maps import Axis, Grid, ParameterMap
from ..parameter_maps.cells import CELL, CELL_REGIMES, empty_cells
from ..parameter_maps.grid import KNOBS, MOST_CELLS
from ..scene import Amplitude
from ..scene.quantities import QUANTITIES
from .writing import write_file, write_result


def save_parameter_map(parameter_map: ParameterMap, path: str | Path) -> Path:
    """Write a parameter map to `path` and return the path. Raises `BadInput` if it cannot be written."""
    return write_file(path, lambda file: write_result(file, parameter_map))


def load_parameter_map(path: str | Path) -> ParameterMap:
    """Return the parameter map that `save_parameter_map` wrote. Raises `BadInput` for any other file."""
    with opened(path, "is not a map written by granchain") as file:
        file.schema()
        return _read(file)


def _read(file: File) -> ParameterMap:
    names = file.json("map_axes")
    if not isinstance(names, list) or len(names) != 2:
        raise Refused(f"attribute map_axes is {str(names)[:40]!r}, not two knobs")
    y, x = (one_of("map_axes", name, KNOBS) for name in names)
    scene, shape = file.scene(), (*file.shape(f"map/{y}"), *file.shape(f"map/{x}"))
    if len(shape) != 2 or shape[0] * shape[1] > MOST_CELLS:
        raise Refused(f"its axes have shape {shape}; expected two with at most {MOST_CELLS} cells")
    file.expect_units({f"map/{knob}": QUANTITIES[knob].unit for knob in (y, x)})
    axes = (Axis.of(knob, file.numbers(f"map/{knob}", (count,)))
            for knob, count in zip((y, x), shape, strict=True))
    down, across = axes
    amplitude = Amplitude.from_json(file.json("amplitude")) if file.stated("amplitude") else None
    grid = Grid(scene, across, down, amplitude)
    cells = empty_cells(grid)
    file.expect_units(ParameterMap(grid, cells).tables()[0].units)
    kept = [name for name in CELL.names or () if file.has(f"map/{name}")]
    for name in kept:  # earlier versions kept fewer columns
        cells[name] = _column(file, name, shape)
    if "decay" not in kept:  # files from before the two were distinguished
        cells["decay"], cells["multiplier"] = cells["multiplier"].copy(), np.nan
    return ParameterMap(grid, cells, file.number("wall_s"))


def _column(file: File, name: str, shape: tuple[int, ...]) -> np.ndarray:
    """Return one column of all cells; a number that does not fit the table's type is refused."""
    kind, path = CELL[name], f"map/{name}"
    if kind.kind == "f":
        return file.numbers(path, shape).reshape(-1)
    low, high = (-1, len(CELL_REGIMES) - 1) if name == "regime" else (0, np.iinfo(kind).max)
    return within(f"/{path}", file.numbers(path, shape, "i"), low, high).reshape(-1)
