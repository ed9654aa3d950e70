"""Saving and restoring an engine, so that an interrupted run continues bit for bit.

A `State` in SI is rounded by the conversion there and back. A checkpoint contains the engine's own numbers: the scaled
state, its slope, the step that error control would try next, and the position within the drive period.
"""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..scene import Scene
from .engine import Engine
from .methods import METHODS, MethodSetting
from .stepper import ErrorControl


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """An engine's numbers: y (M,) and its slope, error control's `control` (3,), grid index, drive periods run.

    `digest`, `method`, `refine`, `tolerance` and `samples` identify the engines that may continue from here.
    """

    digest: str
    method: str
    refine: float
    tolerance: float
    samples: int
    y: np.ndarray
    slope: np.ndarray
    control: np.ndarray
    grid_index: int
    elapsed: float

    def to_bytes(self) -> bytes:
        """Return the checkpoint as an .npz archive."""
        out = io.BytesIO()
        np.savez(out, **self.__dict__)
        return out.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> Checkpoint:
        """Read a checkpoint that `to_bytes` wrote; raise `BadInput` for anything else."""
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as kept:
                fields = {name: kept[name] for name in cls.__dataclass_fields__}
        except (ValueError, KeyError, OSError, EOFError) as problem:
            raise BadInput(f"This is not a checkpoint: {problem}.") from None
        return cls(**{name: value if value.ndim else value.item() for name, value in fields.items()})


def checkpoint(engine: Engine) -> Checkpoint:
    """Return a checkpoint of `engine` in its present state.

    With error control, a run can only be cut at whole drive periods, where its steps end in any case: a cut inside a
    period would shorten a step that an uninterrupted run takes whole. Raises `BadInput` inside one.
    """
    error_control = METHODS[engine.setting.method].error_control
    if error_control and engine.grid_index != 0:
        raise BadInput(f"{engine.setting.method} can be stopped at whole drive periods only; the nearest is "
                       f"{engine.grid - engine.grid_index} of {engine.grid} grid points ahead.")
    setting, control = engine.setting, np.zeros(0)
    if error_control:
        work: ErrorControl = engine.stepper.work
        control = np.array([*work.next_step, *work.scale])
    return Checkpoint(engine.scaled.scene.digest, method=setting.method, refine=float(setting.refine),
                      tolerance=setting.tolerance, samples=engine.samples, y=engine.y.copy(),
                      slope=engine.stepper.slope.copy(), control=control, grid_index=engine.grid_index,
                      elapsed=float(engine.elapsed))


def resumed(scene: Scene, kept: Checkpoint, stop: Stop | None = None) -> Engine:
    """Return a new engine that continues from a checkpoint of the same scene; raise `BadInput` for another scene."""
    if scene.digest != kept.digest:
        raise BadInput(f"This checkpoint belongs to scene {kept.digest}, not to {scene.digest} ({scene.name}); "
                       f"continue with the scene it was taken from.")
    row = scene.N + 2
    engine = Engine(scene, MethodSetting(kept.method, kept.refine, kept.tolerance), kept.samples,
                    account=len(kept.y) > 2 * row, stop=stop)
    engine.y[:], engine.stepper.slope[:] = kept.y, kept.slope
    if len(kept.control):
        work: ErrorControl = engine.stepper.work
        work.next_step[0], work.scale[:] = kept.control[0], kept.control[1:]
    engine.grid_index, engine.elapsed = kept.grid_index, kept.elapsed
    return engine
