"""Finished blocks of a diagram on disk: a killed map loses only the cells that were not written yet.

A folder beside the result holds `map.json`, which identifies scene and grid, and one file per block of finished cells.
Every file is written under a temporary name, synced and renamed, and carries the SHA-256 of its content: a block that
is not whole is computed again.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import shutil
import time
from pathlib import Path

import numpy as np

from ..errors import BadInput
from .cells import CELL, empty_cells
from .grid import Grid

#: Cells in one block.
BLOCK = 128
#: Time after which a smaller block is written [s].
SECONDS = 2.0
#: File that says which scene and grid the folder belongs to.
_HEAD = "map.json"
#: Ending of a block's file name.
_SUFFIX = ".block"
#: Version of the format.
_VERSION = 1


class Blocks:
    """The folder of blocks of one map, which grows while the map is computed."""

    def __init__(self, grid: Grid, folder: Path) -> None:
        self.grid, self.folder = grid, folder
        self._rows: list[np.ndarray] = []
        self._written, self._last = 0, time.monotonic()

    @classmethod
    def open(cls, grid: Grid, out: str | Path, resume: bool) -> Blocks:
        """The blocks that belong to the result `out`; an unfinished map there must be the same one and be resumed.

        Raises `BadInput`.
        """
        blocks = cls(grid, folder_of(out))
        try:
            if not (blocks.folder / _HEAD).exists():
                blocks.folder.mkdir(exist_ok=True)
                blocks._write(_HEAD, json.dumps(blocks._head()).encode())
                return blocks
            if not resume:
                raise BadInput(f"{blocks.folder} holds an unfinished map; go on with --resume, or delete it.")
            blocks._check()
        except OSError as problem:
            raise BadInput(f"Cannot write {blocks.folder}: {problem.strerror or problem}.") from None
        return blocks

    def _head(self) -> dict[str, object]:
        grid = self.grid
        return {"version": _VERSION, "digest": grid.digest, "scene": grid.scene.name,
                "x": [grid.x.knob, grid.x.values[0], grid.x.values[-1], len(grid.x.values)],
                "y": [grid.y.knob, grid.y.values[0], grid.y.values[-1], len(grid.y.values)]}

    def _check(self) -> None:
        """Refuse to go on with another map."""
        head = self._read(_HEAD)
        found = json.loads(head) if head is not None else {}
        if found.get("version") != _VERSION or found.get("digest") != self.grid.digest:
            raise BadInput(f"{self.folder} holds another map, {_described(found)}, not {_described(self._head())} with "
                           "these knobs; give that one's scene and axes, another --out, or delete the folder.")

    def cells(self) -> np.ndarray:
        """The table of all cells, filled from the blocks that are intact."""
        cells = empty_cells(self.grid)
        for path in sorted(self.folder.glob(f"*{_SUFFIX}")):
            rows = self._rows_of(path.name)
            if rows is not None:
                cells[rows["number"]] = rows
        return cells

    def _rows_of(self, name: str) -> np.ndarray | None:
        content = self._read(name)
        if content is None:
            return None
        rows = np.load(io.BytesIO(content), allow_pickle=False)
        whole = rows.dtype == CELL and ((rows["number"] >= 0) & (rows["number"] < self.grid.size)).all()
        return rows if whole else None

    def add(self, rows: np.ndarray) -> None:
        """Add finished cells (cells,); they are written when a block is full or `SECONDS` have passed."""
        self._rows.append(np.atleast_1d(rows))
        if sum(map(len, self._rows)) >= BLOCK or time.monotonic() - self._last > SECONDS:
            self.write()

    def write(self) -> None:
        """Write the cells added since the last block."""
        if self._rows:
            buffer = io.BytesIO()
            np.save(buffer, np.concatenate(self._rows), allow_pickle=False)
            self._written += 1
            self._write(f"{time.time_ns():x}-{os.getpid()}-{self._written}{_SUFFIX}", buffer.getvalue())
            self._rows.clear()
        self._last = time.monotonic()

    def _write(self, name: str, content: bytes) -> None:
        temporary = self.folder / f".{name}.{os.getpid()}.tmp"
        with temporary.open("wb") as file:
            file.write(hashlib.sha256(content).digest() + content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, self.folder / name)
        folder = os.open(self.folder, os.O_RDONLY)
        os.fsync(folder)  # the new name is stored in the folder, which is synced separately
        os.close(folder)

    def _read(self, name: str) -> bytes | None:
        """The content of a file, None where its checksum does not fit."""
        stored = (self.folder / name).read_bytes()
        digest, content = stored[:32], stored[32:]
        return content if hashlib.sha256(content).digest() == digest else None

    def remove(self) -> None:
        """Remove the folder once the result is written."""
        shutil.rmtree(self.folder)


def folder_of(out: str | Path) -> Path:
    """The folder of blocks that belongs to a result."""
    return Path(f"{out}.blocks")


def _described(head: dict[str, object]) -> str:
    if "scene" not in head:
        return "of another version"
    x, y = head["x"], head["y"]
    assert isinstance(x, list) and isinstance(y, list)
    return f"{head['scene']} over {_axis(x)} and {_axis(y)}"


def _axis(axis: list[object]) -> str:
    return f"{axis[0]} = {axis[1]:g} … {axis[2]:g} ({axis[3]})"
