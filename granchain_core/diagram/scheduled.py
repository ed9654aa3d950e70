"""Blocks of a diagram handed to a Dask scheduler, for maps that are too large for one machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..errors import BadInput, Cancelled, NumbersFailed
from ..scene import Amplitude, Scene
from ..stop import Stop
from .compute import block_cells
from .grid import Axis, Grid

#: Cells of one block: some seconds of work, so that sending it costs nothing.
CELLS_IN_TASK = 256
#: Time in which a scheduler must answer [s].
_ANSWERS = 4.0
#: Time between two checks whether the map is still wanted [s].
_LOOK = 0.2


def work_on(described: dict[str, Any], numbers: Sequence[int]) -> np.ndarray:
    """The cells of one block, from plain data that can be sent: scene, x and y as `describe` gives them."""
    grid = Grid(Scene.from_json(described["scene"]), Axis(described["x"][0], tuple(described["x"][1])),
                Axis(described["y"][0], tuple(described["y"][1])),
                None if described["amplitude"] is None else Amplitude.from_json(described["amplitude"]))
    return block_cells(grid, numbers)


def describe(grid: Grid) -> dict[str, Any]:
    """A grid as plain data."""
    return {"scene": grid.scene.to_json(), "x": (grid.x.knob, grid.x.values), "y": (grid.y.knob, grid.y.values),
            "amplitude": None if grid.amplitude is None else grid.amplitude.to_json()}


def blocks_of(numbers: Sequence[int], size: int = CELLS_IN_TASK) -> list[list[int]]:
    """Cell numbers in blocks; each takes cells from all over, so that all blocks cost about the same."""
    count = max(1, -(-len(numbers) // size))
    return [list(numbers[first::count]) for first in range(count) if len(numbers)]


def connect(address: str) -> Any:
    """A client of the scheduler at `address`; `BadInput` where there is none or `distributed` is not installed."""
    try:
        from distributed import Client
    except ImportError:
        raise BadInput("--scheduler needs the package distributed; install it with "
                       "`pip install 'granchain[scheduler]'` here and on every worker.") from None
    try:
        return Client(address, timeout=_ANSWERS)
    except (OSError, ValueError, TimeoutError) as problem:
        raise BadInput(f"No Dask scheduler answers at {address[:80]} ({str(problem)[:80]}); start one with "
                       "`dask scheduler` and workers with `dask worker`.") from None


def iter_blocks(client: Any, grid: Grid, numbers: Sequence[int],
                stop: Stop | None = None) -> Iterator[np.ndarray]:
    """Finished blocks (cells,) in the order in which workers return them; blocks no longer wanted are cancelled."""
    described = describe(grid)
    waiting = {client.submit(work_on, described, block, pure=False) for block in blocks_of(numbers)}
    try:
        while waiting:
            if stop:
                raise Cancelled
            done, waiting = _some(waiting)
            for future in done:
                yield _result(future)
    finally:
        client.cancel(list(waiting))


def _some(waiting: set[Any]) -> tuple[set[Any], set[Any]]:
    from distributed import wait

    try:
        found = wait(waiting, timeout=_LOOK, return_when="FIRST_COMPLETED")
    except TimeoutError:
        return set(), waiting
    return set(found.done), set(found.not_done)


def _result(future: Any) -> np.ndarray:
    try:
        return np.asarray(future.result())
    except (BadInput, NumbersFailed):
        raise
    except Exception as problem:
        raise NumbersFailed(f"A worker could not compute its block: {type(problem).__name__}: {str(problem)[:200]}; "
                            "look at its log, and go on with --resume.", "worker-failed") from None
