"""Checkpoints of a run (checkpoints.py): after a kill it continues from the finished discarded periods.

A run computes its motion several times, each time finer. For each computation, the newest checkpoint among its
discarded periods is kept. The recorded periods are computed again, since writing them would take longer.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..execution.checkpoints import CheckpointFolder, digest_of
from ..execution.stop import Stop
from ..integrate import Engine
from ..integrate.checkpoint import Checkpoint, checkpoint, resumed
from ..scene import Scene


@dataclass(eq=False)
class Reached:
    """The progress of one computation: its engine, the number of finished discarded periods, and the last strobes.

    `strobes` has the shape (P + 1, 2, N).
    """

    engine: Engine
    done: int
    strobes: np.ndarray


class RunCheckpoints:
    """The folder of one run, with its discarded and recorded periods, samples per period, and method or None."""

    def __init__(self, scene: Scene, periods: int, record: int, samples: int, method: str | None,
                 out: str | Path) -> None:
        self._scene = scene
        request = {"scene": scene.digest, "periods": periods, "record": record, "samples": samples, "method": method}
        words = f"{scene.name} with {periods} + {record} periods of {samples} samples"
        self.folder: CheckpointFolder[dict[str, Any]] = CheckpointFolder(
            out, "run", digest_of(request), words, _packed, newest_only=True)
        self._there: dict[str, Any] = {}
        #: Number of the current computation, and how many of its discarded periods are finished.
        self.computation, self.done = 0, 0

    def open(self, resume: bool) -> None:
        """Open the folder and read the progress in it, to `resume` from there. Raises `BadInput`."""
        self.folder.open(resume)
        for content in self.folder.blocks():
            with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
                self._there = dict(arrays)

    def begin(self, computation: int, engine: Engine) -> Reached | None:
        """Begin a computation; return its saved progress if it was made by such an engine, otherwise None."""
        self.computation, self.done = computation, 0
        name = f"{computation} checkpoint"
        if name not in self._there:
            return None
        point = self._there[name]
        if not isinstance(point, Checkpoint):
            point = Checkpoint.from_bytes(point.tobytes())
        setting = engine.setting
        if (point.method, point.refine, point.tolerance) != (setting.method, setting.refine, setting.tolerance):
            return None
        resumed_engine = _with_log(self._scene, point, engine.stop, self._there[f"{computation} log"])
        resumed_engine.counts.array[:] = self._there[f"{computation} counts"]
        self.done = int(self._there[f"{computation} done"])
        return Reached(resumed_engine, self.done, self._there[f"{computation} strobes"])

    def add(self, reached: Reached) -> None:
        """Save the progress of the current computation."""
        self.done, engine = reached.done, reached.engine
        log = np.concatenate([engine.log.peaks, engine.log.last.ravel()])
        values = {"checkpoint": checkpoint(engine), "log": log, "counts": engine.counts.array.copy(),
                  "done": np.array(reached.done), "strobes": reached.strobes}
        self._there = {**self._there, **{f"{self.computation} {name}": value for name, value in values.items()}}
        self.folder.add(self._there)


def _with_log(scene: Scene, point: Checkpoint, stop: Stop, log: np.ndarray) -> Engine:
    """The engine of a checkpoint, with the largest forces that it had recorded."""
    engine = resumed(scene, point, stop)
    peaks = engine.log.peaks.size
    engine.log.peaks[:], engine.log.last[:] = log[:peaks], log[peaks:].reshape(engine.log.last.shape)
    return engine


def _packed(pieces: list[dict[str, Any]]) -> bytes:
    """The newest piece, which contains everything, as bytes."""
    out = io.BytesIO()
    arrays: dict[str, Any] = {name: np.frombuffer(value.to_bytes(), np.uint8) if isinstance(value, Checkpoint)
                              else value for name, value in pieces[-1].items()}
    np.savez(out, **arrays)
    return out.getvalue()
