"""Compiling what measurements need, so that a page can have it done beforehand in another process."""

from __future__ import annotations

from ..integrate import METHODS, Engine, Setting
from ..scene import Scene
from ..warm import mark_warm
from .effect_cost import CODE, MOTION

#: Names of these pieces of a structure's kernels, beside those of `granchain_core.warm`.
METHODS_PIECE, COST_PIECE, ACCOUNT_PIECE = "accuracy", "cost", "cost account"
PIECES = (METHODS_PIECE, COST_PIECE, ACCOUNT_PIECE)


def compile_piece(scene: Scene, piece: str) -> None:
    """Compile one piece for the scene's structure, or load it from the cache, by running it shortly."""
    short = scene.evolve(f=max(scene.f, 1000.0))
    if piece == METHODS_PIECE:
        for name in METHODS:
            Engine(short, Setting(name, tolerance=1e-3), 2).record(2)
    else:
        for name in (CODE, MOTION):
            Engine(short, Setting(name), 1, balance=piece == ACCOUNT_PIECE).periods(1)
    mark_warm(scene, piece)
