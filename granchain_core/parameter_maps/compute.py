"""Computing the cells of a parameter map in batches, on all cores, coarse first."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from ..errors import Cancelled
from ..execution.stop import Stop
from ..inputs.checks import axis_in
from ..scene import Amplitude, Scene
from ..steady.batch.starts import settle_on_all_cores
from ..steady.steady_state import SteadyState
from .cells import ParameterMap, cell_of, empty_cells
from .grid import Axis, Grid
from .scheduled import iter_blocks
from .starts import by_kernel, starts_of


def iter_parameter_map(grid: Grid, missing: Sequence[int] | np.ndarray | None = None,
                       stop: Stop | None = None, workers: int | None = None,
                       pause: Callable[[], None] | None = None) -> Iterator[SteadyState]:
    """Yield cells of the parameter map as they are decided, coarse first; only those in `missing`, by default all.

    The `number` of a result is that of its cell. `stop` is checked between cells and ends the computation; running
    cells are then abandoned. `pause` is called before a cell is started and may wait.
    """
    wanted = set(range(grid.size) if missing is None else (int(number) for number in missing))
    groups = by_kernel(grid, [int(number) for number in grid.coarse_first() if int(number) in wanted])
    for group in groups:
        yield from settle_on_all_cores(starts_of(grid, group), stop, workers, pause)
        if stop:
            return


def parameter_map(scene: Scene, x: tuple[str, Iterable[float]], y: tuple[str, Iterable[float]],
                  stop: Stop | None = None, progress: Callable[[ParameterMap, float], None] | None = None,
                  workers: int | None = None, amplitude: Amplitude | None = None,
                  scheduler: Any = None) -> ParameterMap:
    """Compute the parameter map: regime and largest forces over two knobs, every cell from rest, on all cores.

    Cells are computed in batches with fixed steps, whatever the scene's `accuracy`, and report their actual error.

    Parameters
    ----------
    scene : Scene
        The chain.
    x, y : tuple of (str, iterable of float)
        A knob ("f", "A0", "D", "k", "kappa", "F0", "wall", "dimer", …) and its ascending values in SI.
    stop : Stop, optional
        Checked between cells. When set, the computation ends, and cells that are not computed have regime −1.
    progress : callable, optional
        Called with the map so far and the completed fraction, after every cell; with a scheduler, after every block.
    workers : int, optional
        Number of threads; by default one per core.
    amplitude : Amplitude, optional
        The drive amplitude over the frequency, which is then one of the axes; by default the scene's A0.
    scheduler : distributed.Client, optional
        A client of a Dask scheduler (`granchain_core.scheduler.connect`), whose workers compute blocks of cells. A cell
        that fails is marked as failed.

    Returns
    -------
    ParameterMap
        A table of cells, (len(y), len(x)).

    Raises
    ------
    BadInput
        A knob cannot be an axis, its values do not ascend or are out of range, or there are too many cells.
    ComputationError
        A worker of the scheduler could not compute its block.

    Examples
    --------
    >>> from granchain_core import parameter_map, scene
    >>> found = parameter_map(scene("sec2").evolve(N=2), ("f", [1900.0, 2000.0, 2100.0]), ("A0", [4e-7, 5e-7]))
    >>> found.column("period")
    array([[1, 1, 1],
           [1, 1, 1]], dtype=int16)
    >>> bool((found.column("max_output_force")[1] > found.column("max_output_force")[0]).all())
    True
    """
    began = time.perf_counter()
    grid = Grid(scene, Axis.of(*axis_in("x", x)), Axis.of(*axis_in("y", y)), amplitude)
    computed = ParameterMap(grid, empty_cells(grid))
    done = 0
    for rows in _finished(grid, stop, workers, scheduler):
        computed.cells[rows["number"]] = rows
        computed.wall_s = time.perf_counter() - began
        done += len(rows)
        if progress is not None:
            progress(computed, done / grid.size)
    return computed


def _finished(grid: Grid, stop: Stop | None, workers: int | None, scheduler: Any) -> Iterator[np.ndarray]:
    """Yield finished cells, one by one from the cores of this machine or in blocks from a scheduler's workers."""
    if scheduler is not None:
        with contextlib.suppress(Cancelled):  # known cells are kept, as without a scheduler
            yield from iter_blocks(scheduler, grid, [int(number) for number in grid.coarse_first()], stop)
        return
    for result in iter_parameter_map(grid, None, stop, workers):
        yield np.atleast_1d(cell_of(result))
