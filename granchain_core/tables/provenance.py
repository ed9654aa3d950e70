"""Provenance of numbers: scene, method, requested and reached accuracy, versions, machine, time."""

from __future__ import annotations

import json
import platform
from datetime import UTC, datetime
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

import numpy as np

from ..kernels.batch_size import machine
from ..scene import Amplitude, Scene
from ..scene.quantities import QUANTITIES
from ..version import __version__

#: Libraries whose versions may change a number or a file; llvmlite is the compiler of the kernels.
_LIBRARIES = ("numpy", "scipy", "numba", "llvmlite", "h5py")
_KERNELS = Path(__file__).parents[1] / "kernels"
#: An attribute of a file or of a dataset.
Attribute = str | int | float


def provenance(scene: Scene, method: str, reached: float | None) -> dict[str, Attribute]:
    """Return the attributes that every result has.

    `reached` is the relative error of a motion's displacements, or the largest relative error of an output force in a
    table of steady states; None if none is stated. `accuracy_asked` is the scene's accuracy; batches of curves and maps
    do not use it.
    """
    entries = {
        **made(), "scene_name": scene.name, "scene": json.dumps(scene.to_json()), "scene_digest": scene.digest,
        "method": method, "accuracy_asked": scene.accuracy, "accuracy_reached": or_nan(reached)}
    for name, value in scene.knobs.items():
        entries[f"knob_{name}"] = value
        entries[f"knob_{name}_unit"] = QUANTITIES[name].unit
    return entries


def amplitude_attribute(amplitude: Amplitude | None) -> dict[str, Attribute]:
    """Return a drive amplitude that depends on the frequency as JSON; nothing if it is the scene's own."""
    return {} if amplitude is None else {"amplitude": json.dumps(amplitude.to_json())}


def made() -> dict[str, Attribute]:
    """Return the attributes that say with which versions, on which machine and when a result was computed."""
    return {"Conventions": "CF-1.10", "granchain_version": __version__,
            "created": datetime.now(UTC).isoformat(timespec="seconds"),
            "versions": json.dumps({**{name: version(name) for name in _LIBRARIES},
                                    "python": platform.python_version()}),
            "kernels_digest": kernels_digest(),
            "machine": machine()}


@cache
def kernels_digest() -> str:
    """Return the hash of the kernels' sources, which distinguishes commits of one version whose numbers may differ.

    It is a hash of the files' bytes. Unlike the hash by which compiled code is found (kernels/compiling/sources.py), it
    needs no compiler and is the same on every machine.
    """
    digest = sha256()
    for path in sorted(_KERNELS.rglob("*.py")):
        digest.update(f"{path.relative_to(_KERNELS).as_posix()} {sha256(path.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()[:12]


def or_nan(value: float | None) -> float:
    """Return a number for a table, with NaN for None."""
    return np.nan if value is None else value
