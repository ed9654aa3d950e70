"""Compiling what orbits and branches need, so that a page can have it done beforehand in another process."""

from __future__ import annotations

import numpy as np

from ..scene import Scene
from ..warm import mark_warm
from .branch.axis import KnobAxis
from .branch.equations import BranchEquations
from .branch.point import record_along
from .flow import StroboscopicMap

#: Names of these pieces of a structure's kernels, beside those of `granchain_core.warm`.
ORBIT_PIECE, BRANCH_PIECE = "orbit", "branch"


def compile_orbit(scene: Scene) -> None:
    """Compile the tangent flow for the scene's structure, or load it from the cache, by running it shortly."""
    short = scene.evolve(f=max(scene.f, 1000.0))
    StroboscopicMap(short, 1)(np.zeros(2 * short.N))
    mark_warm(scene, ORBIT_PIECE)


def compile_branch(scene: Scene) -> None:
    """Compile the kernels of a branch for the scene's structure, or load them from the cache, by a short run."""
    short = scene.evolve(f=max(scene.f, 1000.0))
    equations = BranchEquations(KnobAxis.of(short, "f", short.f, 2.0 * short.f), 1)
    x = np.zeros(equations.size)
    strobe = equations.strobe(short.f)
    strobe.end(x)
    strobe(x)
    record_along(equations, x, short.f)
    mark_warm(scene, BRANCH_PIECE)
