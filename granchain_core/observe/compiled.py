"""Compiling what a chain with its observer needs, so that a page can have it done beforehand in another process."""

from __future__ import annotations

import numpy as np

from ..orbits.flow import StroboscopicMap
from ..scene import Scene
from ..warm import mark_warm
from .pair import Pair

#: Name of this piece of a structure's kernels, beside those of `granchain_core.warm`.
OBSERVER_PIECE = "observer"


def compile_observer(scene: Scene) -> None:
    """Compile the pair's motion and the observer's tangents for the scene's structure, or load them from the cache."""
    short = scene.evolve(f=max(scene.f, 1000.0))
    Pair(short, 2).engine.record(2)
    StroboscopicMap(short, 1)(np.zeros(2 * short.N), observer=True)
    mark_warm(scene, OBSERVER_PIECE)
