"""Checkpoints of a parameter map (checkpoints.py): finished cells on disk, as tables of 128."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from ..execution.checkpoints import CheckpointFolder
from .cells import CELL, empty_cells
from .grid import Axis, Grid


class Blocks:
    """The folder of blocks of one parameter map, which grows while the map is computed."""

    def __init__(self, grid: Grid, out: str | Path) -> None:
        self.grid = grid
        self.folder: CheckpointFolder[np.ndarray] = CheckpointFolder(out, "map", grid.digest, _described(grid), _packed)

    @classmethod
    def open(cls, grid: Grid, out: str | Path, resume: bool) -> Blocks:
        """Open the blocks for the result `out`; an unfinished map there must be the same one, and must be resumed.

        Raises `BadInput`.
        """
        blocks = cls(grid, out)
        blocks.folder.open(resume)
        return blocks

    def cells(self) -> np.ndarray:
        """The table of all cells, filled from the intact blocks."""
        cells = empty_cells(self.grid)
        for content in self.folder.blocks():
            rows = np.load(io.BytesIO(content), allow_pickle=False)
            if rows.dtype == CELL and ((rows["number"] >= 0) & (rows["number"] < self.grid.size)).all():
                cells[rows["number"]] = rows
        return cells

    def add(self, rows: np.ndarray) -> None:
        """Add finished cells (cells,)."""
        for row in np.atleast_1d(rows):
            self.folder.add(row)


def _packed(rows: list[np.ndarray]) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.array(rows, dtype=CELL), allow_pickle=False)
    return buffer.getvalue()


def _described(grid: Grid) -> str:
    return f"{grid.scene.name} over {_axis(grid.x)} and {_axis(grid.y)}"


def _axis(axis: Axis) -> str:
    return f"{axis.knob} = {axis.values[0]:g} … {axis.values[-1]:g} ({len(axis.values)})"
