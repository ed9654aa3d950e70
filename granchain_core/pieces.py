"""The pieces of one structure's kernels by name, whatever they are for, and all that the dashboard needs of them."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from .accuracy import compiled as measured
from .observe.compiled import OBSERVER_PIECE, compile_observer
from .orbits.compiled import BRANCH_PIECE, ORBIT_PIECE, compile_branch, compile_orbit
from .scene import Scene, scene, scene_names
from .warm import structure, warm

#: What a visitor needs first, and what the pages behind the tabs need.
MAIN = ("curve", "certified", "live")
PAGES = (ORBIT_PIECE, BRANCH_PIECE, OBSERVER_PIECE, *measured.PIECES)


def compile_piece(shown: Scene, piece: str) -> None:
    """Compile one piece for the scene's structure, or load it from the cache, and note that it is there."""
    if piece in measured.PIECES:
        measured.compile_piece(shown, piece)
    elif piece == ORBIT_PIECE:
        compile_orbit(shown)
    elif piece == BRANCH_PIECE:
        compile_branch(shown)
    elif piece == OBSERVER_PIECE:
        compile_observer(shown)
    else:
        warm(shown, (piece,))


def _compile(job: tuple[Scene, str]) -> str:
    compile_piece(*job)
    return f"{structure(job[0])}, {job[1]}"


def warm_presets(workers: int = 2) -> Iterable[str]:
    """Compile what the dashboard needs for the presets, in `workers` processes; yields what has been finished."""
    seen: dict[str, Scene] = {}
    for name in scene_names():
        seen.setdefault(structure(scene(name)), scene(name))
    jobs = [(one, piece) for piece in MAIN + PAGES for one in seen.values()]
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        yield from pool.map(_compile, jobs)
