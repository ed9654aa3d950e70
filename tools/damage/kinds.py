"""The kinds of files that granchain reads: how to make one, how to read it, and the content read as one plain value."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from app.cli.orbit import _start
from granchain_core import observe, resonance_curve, run, scene
from granchain_core.observers import first_state, read_force
from granchain_core.orbits import Continuation, begin_branch
from granchain_core.parameter_maps import Axis, Grid, parameter_map
from granchain_core.store import load, load_branch, save, save_branch, save_curve, save_observation
from granchain_core.store.curves import load_curve
from granchain_core.store.parameter_maps import load_parameter_map, save_parameter_map

BEADS = 3


@dataclasses.dataclass(frozen=True)
class Kind:
    """A kind of file: `make` writes one to a path, and `read` returns everything that its readers return."""

    name: str
    make: Callable[[Path], Path]
    read: Callable[[Path], Any]


def _chain(f: float = 340.0) -> Any:
    return scene("fig11-founded").evolve(f=f, N=BEADS)


def _run(path: Path) -> Path:
    return save(run(_chain(), periods=2, record=2, samples=500), path)


def _branch(path: Path) -> Path:
    begun = begin_branch(scene("sec2").evolve(f=1550.0), "f", 1400.0, 1650.0, 1, both=True)
    return save_branch(Continuation(begun).run(most_points=4), path)


def _curve(path: Path) -> Path:
    return save_curve(resonance_curve(_chain(), [300.0, 340.0, 380.0]), path)


def _map(path: Path) -> Path:
    grid = Grid(_chain(), Axis.of("f", [300.0, 340.0, 380.0]), Axis.of("A0", [4e-7, 5e-7]))
    return save_parameter_map(parameter_map(grid.scene, ("f", grid.x.values), ("A0", grid.y.values)), path)


def _observation(path: Path) -> Path:
    known = run(_chain(), periods=2, record=2, samples=500)
    return save_observation(observe(_chain(), known.time, known.input_force), path)


def _read_force(path: Path) -> Any:
    return read_force(path), first_state(path, BEADS)


KINDS = {kind.name: kind for kind in (
    Kind("run", _run, load), Kind("start of orbit", _run, lambda path: _start(_chain(), str(path), 0)),
    Kind("force of a run", _run, _read_force), Kind("branch", _branch, load_branch), Kind("curve", _curve, load_curve), Kind("map", _map, load_parameter_map),
    Kind("observation", _observation, _read_force))}


def unsealed(path: Path, out: Path) -> Path:
    """Write the same file as versions before the seal wrote it."""
    with h5py.File(path) as new, h5py.File(out, "w") as old:
        for name in new:
            new.copy(name, old)
        old.attrs.update(new.attrs)
    return out


def told(value: Any) -> Any:
    """Return everything that was read as plain data that can be compared, with numbers bit by bit."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, (float, np.floating)):
        return float(value).hex()
    if dataclasses.is_dataclass(value):
        return [(field.name, told(getattr(value, field.name))) for field in dataclasses.fields(value)
                if not callable(getattr(value, field.name)) or isinstance(getattr(value, field.name), np.ndarray)]
    if isinstance(value, (list, tuple)):
        return [told(one) for one in value]
    return repr(value)


def made(kind: Kind, folder: Path) -> tuple[Path, Path]:
    """Return an undamaged file of a kind, and the same file without its seal."""
    path = folder / f"{kind.name}.h5"
    if not path.exists():
        kind.make(path)
    return path, unsealed(path, folder / f"{kind.name}-old.h5")


def names_of(path: Path) -> list[str]:
    """Return the names of the datasets of a file."""
    found: list[str] = []
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.append(name) if isinstance(item, h5py.Dataset) else None)
    return found
