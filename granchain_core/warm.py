"""Compiling kernels ahead of time, so that nobody waits for a compiler inside a visit.

A *structure* is the set of effects a scene has; moving a slider never changes it, adding a foundation or another
dissipation law does, and the kernels of a new structure are compiled once per machine.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from .integrate import Engine, Setting
from .integrate.batch import Batch, can_share_batch, is_uniform, scaled_state
from .integrate.engine import new_stop, rest
from .kernels.jit import CACHE_FOLDER
from .kernels.rk4.short_chain import WIDTHS
from .lower import lower
from .scene import Scene
from .scene.effects import effects_of
from .steady.lyapunov import exponents, exponents_in_pairs

#: What the pieces of one structure's kernels are for; each can be compiled in its own process. Those with the energy
#: account are for runs that are asked for by themselves, the dashboard does without.
PIECES = ("live", "certified", "curve", "live account", "certified account")


def structure(shown: Scene) -> str:
    """Name of what picks the compiled kernels of a scene: its set of effects and the vectors its bodies fit into."""
    width = next((f"{lanes} lanes" for lanes in WIDTHS if lanes >= shown.N + 2), "long")
    effects = [effect.key(shown) for effect in effects_of(shown)]
    law = [] if shown.has_dissipation else ["none"]
    beads = [] if is_uniform(lower(shown)) else ["unequal beads"]
    return "+".join([*law, *effects, *beads]) + f", {width}"


def is_warm(shown: Scene, pieces: Iterable[str] = ("live", "certified")) -> bool:
    """Whether the kernels of this scene's structure have been compiled on this machine."""
    return all(_marker(structure(shown), piece).exists() for piece in pieces)


def _marker(name: str, piece: str) -> Path:
    return CACHE_FOLDER / f"compiled-{name}-{piece}".replace(" ", "-").replace(",", "")


def mark_warm(shown: Scene, piece: str) -> None:
    """Note that a piece of the kernels of this scene's structure has been compiled."""
    _marker(structure(shown), piece).touch()


def warm(shown: Scene, pieces: Iterable[str] = PIECES) -> None:
    """Compile and cache the kernels of one scene's structure by running them shortly."""
    short = shown.evolve(f=max(shown.f, 1000.0))
    for piece in pieces:
        if piece == "curve":
            _warm_curve(short)
        else:
            method = "rk4-split" if piece.startswith("live") else "dop853"
            engine = Engine(short, Setting(method, tolerance=1e-3), 2, balance=piece.endswith("account"))
            engine.periods(1)
            engine.record(2)
        mark_warm(shown, piece)


def _warm_curve(short: Scene) -> None:
    """The kernels of a curve: the shadow for irregular motions, lanes where the scene can use them, located jumps."""
    if short.forces_jump:
        Engine(short, Setting("rk4-split"), 1).record(1)
    exponents(Engine(short, Setting("rk4-split"), 1), 1, 1)
    if can_share_batch(short):
        block = Batch(short, new_stop())
        lowered = lower(short)
        y = scaled_state(lowered, rest(short))
        block.put(0, lowered, y, 1, look=1)
        block.run()
        exponents_in_pairs([(lowered, y)], 1, 1, new_stop())
