"""Compiling what orbits need, so that a page can have it done beforehand in another process."""

from __future__ import annotations

import numpy as np

from ..scene import Scene
from ..warm import mark_warm
from .flow import StroboscopicMap

#: Name of this piece of a structure's kernels, beside those of `granchain_core.warm`.
ORBIT_PIECE = "orbit"


def compile_orbit(scene: Scene) -> None:
    """Compile the tangent flow for the scene's structure, or load it from the cache, by running it shortly."""
    short = scene.evolve(f=max(scene.f, 1000.0))
    StroboscopicMap(short, 1)(np.zeros(2 * short.N))
    mark_warm(scene, ORBIT_PIECE)
