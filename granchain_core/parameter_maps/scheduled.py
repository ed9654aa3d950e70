"""Blocks of a map computed by a Dask scheduler, for maps that are too large for one machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..execution.stop import Stop
from ..scene import Amplitude, Scene
from ..scheduler import dealt, results
from ..steady.batch.starts import settle_starts
from .cells import cell_of
from .grid import Axis, Grid
from .starts import by_kernel, starts_of

#: Number of cells in one block: a few seconds of work, so that the cost of sending it is negligible.
CELLS_IN_TASK = 256


def block_cells(grid: Grid, numbers: Sequence[int], stop: Stop | None = None) -> np.ndarray:
    """Compute the cells with these numbers in this thread: one block, as given to a scheduler's worker."""
    stop = Stop() if stop is None else stop
    cells = [cell_of(result) for group in by_kernel(grid, numbers)
             for result in settle_starts(starts_of(grid, group), stop)]
    return np.array(cells)


def work_on(described: dict[str, Any], numbers: Sequence[int]) -> np.ndarray:
    """Compute the cells of one block from plain data that can be sent, as returned by `describe`."""
    grid = Grid(Scene.from_json(described["scene"]), Axis(described["x"][0], tuple(described["x"][1])),
                Axis(described["y"][0], tuple(described["y"][1])),
                None if described["amplitude"] is None else Amplitude.from_json(described["amplitude"]))
    return block_cells(grid, numbers)


def describe(grid: Grid) -> dict[str, Any]:
    """A grid as plain data."""
    return {"scene": grid.scene.to_json(), "x": (grid.x.knob, grid.x.values), "y": (grid.y.knob, grid.y.values),
            "amplitude": None if grid.amplitude is None else grid.amplitude.to_json()}


def iter_blocks(client: Any, grid: Grid, numbers: Sequence[int],
                stop: Stop | None = None) -> Iterator[np.ndarray]:
    """Yield finished blocks (cells,) in the order in which workers return them; unneeded blocks are cancelled."""
    described = describe(grid)
    for _, rows in results(client, work_on, [(described, block) for block in dealt(numbers, CELLS_IN_TASK)], stop):
        yield np.asarray(rows)
