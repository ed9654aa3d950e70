"""The table of pieces that can be compiled ahead of time.

The kernels of a new *structure* (docs/design.md, "A structure selects the kernels") are compiled once per machine, in
pieces, each of which can be compiled in its own process.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import as_completed
from contextlib import ExitStack
from itertools import cycle
from pathlib import Path

import numpy as np

from ..accuracy.effect_cost import CODE, MOTION
from ..accuracy.work_precision import compile_methods
from ..execution.child_processes import pool, starting
from ..execution.stop import Stop
from ..integrate import Engine, MethodSetting, dop853_setting, fixed_step_setting, following_setting
from ..integrate.batch import Batch, can_share_batch, is_uniform
from ..integrate.fixed import chain_width
from ..integrate.scaling import scale_chain
from ..kernels.compiling.cache_folder import CACHE_FOLDER, MARK
from ..observers.pair import Pair
from ..orbits.branch.axis import KnobAxis
from ..orbits.branch.equations import BranchEquations
from ..orbits.branch.point import record_along
from ..orbits.branch.quick import quick_steps
from ..orbits.stroboscopic_map import StroboscopicMap
from ..scene import Scene, scene
from ..scene.effects import effects_of
from ..scene.state import rest
from ..steady.lyapunov import growth_along
from ..steady.regime_criteria import SLOW_RECORD, converging, find_period, return_distance
from .pieces import (
    ACCURACY_KERNELS,
    BRANCH_KERNELS,
    CHECK_KERNELS,
    COST_ACCOUNT_KERNELS,
    COST_KERNELS,
    CURVE_KERNELS,
    DOP853_KERNELS,
    FIXED_STEP_KERNELS,
    MOTION_KERNELS,
    OBSERVER_KERNELS,
    ORBIT_KERNELS,
    REGIME_KERNELS,
    RUN_DOP853_KERNELS,
    RUN_KERNELS,
)


def structure(shown: Scene) -> str:
    """Return the name of a scene's structure."""
    scaled = scale_chain(shown)
    width = chain_width(scaled)
    length = f"vector of {width}" if width else "long"
    effects = [effect.key(shown) for effect in effects_of(shown)]
    law = [] if shown.has_dissipation else ["none"]
    beads = [] if is_uniform(scaled) else ["unequal beads"]
    return "+".join([*law, *effects, *beads]) + f", {length}"


def _compile_engine(short: Scene, setting: MethodSetting, account: bool = False) -> None:
    """Compile whole periods and samples with one method."""
    engine = Engine(short, setting, 2, account=account)
    engine.periods(1)
    engine.record(2)


def _regime(short: Scene) -> None:
    """Compile the detection of the period in a record of strobes, and a state in SI units."""
    find_period(np.zeros((2, 2, short.N)))
    scale_chain(short).to_si(np.zeros(2 * (short.N + 2)))


def _checks(short: Scene) -> None:
    """Compile the checks of a batch, and of the records that it leaves undecided."""
    record = np.zeros((SLOW_RECORD, 2, short.N))
    if can_share_batch(short):
        Batch(short, Stop()).checks_address()
    converging(record)
    return_distance(record)


def _curve(short: Scene) -> None:
    """Compile a curve: located jumps, the neighbour of irregular motions, and the batch if the scene can use it."""
    if short.forces_jump:
        Engine(short, fixed_step_setting(), 1).record(1)
    growth_along(Engine(short, following_setting(short.cuts_tension), 1), 1)
    if can_share_batch(short):
        block = Batch(short, Stop())
        scaled = scale_chain(short)
        y = scaled.from_si(rest(short))
        block.put(0, scaled, y, 1, return_at=1)
        block.run()


def _orbit(short: Scene) -> None:
    """Compile the tangent flow."""
    StroboscopicMap(short, 1)(np.zeros(2 * short.N))


def _branch(short: Scene) -> None:
    """Compile the continuation of orbits over a knob."""
    equations = BranchEquations(KnobAxis.of(short, "f", short.f, 2.0 * short.f), 1)
    x = np.zeros(equations.size)
    stroboscopic_map = equations.stroboscopic_map(short.f)
    stroboscopic_map.end(x)
    stroboscopic_map(x)
    equations.quick_end(x, short.f, quick_steps(scale_chain(short)))
    record_along(equations, x, short.f)


def _observer(short: Scene) -> None:
    """Compile the motion of a chain with its observer, and the observer's tangents."""
    Pair(short, 2).engine.record(2)
    if not short.cuts_tension:  # such a scene has no multipliers to compute (orbits/stroboscopic_map.py)
        StroboscopicMap(short, 1)(np.zeros(2 * short.N), observer=True)


def _cost(account: bool) -> Callable[[Scene], None]:
    """Return a piece that compiles the kernels timed for an effect's cost, with or without the energy account."""

    def compile_cost(short: Scene) -> None:
        for name in (CODE, MOTION):
            Engine(short, MethodSetting(name), 1, account=account).periods(1)

    return compile_cost


#: Every piece, with the function that compiles it by a short run, in the order in which a visitor needs them.
PIECES: dict[str, Callable[[Scene], None]] = {
    REGIME_KERNELS: _regime, CHECK_KERNELS: _checks, CURVE_KERNELS: _curve,
    DOP853_KERNELS: lambda short: _compile_engine(short, dop853_setting(1e-3)),
    FIXED_STEP_KERNELS: lambda short: _compile_engine(short, fixed_step_setting()),
    RUN_KERNELS: lambda short: _compile_engine(short, following_setting(short.cuts_tension), account=True),
    ORBIT_KERNELS: _orbit, BRANCH_KERNELS: _branch, OBSERVER_KERNELS: _observer,
    ACCURACY_KERNELS: compile_methods, COST_KERNELS: _cost(account=False), COST_ACCOUNT_KERNELS: _cost(account=True),
}
#: Pieces that few computations need: compiled when one does, and not by `granchain warm`.
PIECES_ON_DEMAND: dict[str, Callable[[Scene], None]] = {
    RUN_DOP853_KERNELS: lambda short: _compile_engine(short, dop853_setting(1e-3), account=True),
}


def compile_piece(shown: Scene, piece: str) -> None:
    """Compile one piece for the scene's structure, or load it from the cache, and mark it as compiled."""
    short = shown.evolve(f=max(shown.f, 1000.0), drive="harmonic")  # short periods, and a drive that has orbits
    {**PIECES, **PIECES_ON_DEMAND}[piece](short)
    if CACHE_FOLDER is not None:
        with contextlib.suppress(OSError):  # kernels are not cached either, as kernels/compiling/cache.py has reported
            _marker(CACHE_FOLDER, structure(shown), piece).touch()


def is_warm(shown: Scene, pieces: Iterable[str] = MOTION_KERNELS) -> bool:
    """Return whether these pieces of the scene's structure have been compiled on this machine."""
    if CACHE_FOLDER is None:
        return False
    return all(_marker(CACHE_FOLDER, structure(shown), piece).exists() for piece in pieces)


def compiled_lines(names: Iterable[str]) -> Iterator[str]:
    """Yield which pieces of these scenes' structures are compiled on this machine, and the total size of the cache."""
    chains = {structure(scene(name)): scene(name) for name in names}
    for name, chain in chains.items():
        compiled = [piece for piece in PIECES if is_warm(chain, [piece])]
        lacking = [piece for piece in PIECES if piece not in compiled]
        yield (f"{name}: {', '.join(compiled) or 'nothing'} compiled"
               + (f"; {', '.join(lacking)} not compiled" if lacking else ""))
    if CACHE_FOLDER is None:
        yield "no folder for compiled kernels: they are compiled again in every process"
        return
    files = list(CACHE_FOLDER.rglob("*.nbc"))
    size = sum(file.stat().st_size for file in files)
    yield f"{len(files)} specializations of kernels, {size / 1e6:.0f} MB, in {CACHE_FOLDER}"


def _marker(folder: Path, name: str, piece: str) -> Path:
    return folder / f"{MARK}{sys.implementation.cache_tag}-{name}-{piece}".replace(" ", "-").replace(",", "")


def _compile(job: tuple[Scene, str]) -> str:
    compile_piece(*job)
    return f"{structure(job[0])}, {job[1]}"


#: Scenes compiled by default: the paper's chains, with and without a foundation.
USUAL = ("sec2", "rig")


def warm_scenes(names: Iterable[str] = USUAL, workers: int = 2) -> Iterable[str]:
    """Compile all pieces of these scenes' structures in `workers` processes, yielding each as it is finished.

    A structure's pieces are compiled in one process, because they share parts that are compiled once per process. Every
    second process starts with the last piece, so that none waits for the kernels that all structures share.
    """
    chains: dict[str, Scene] = {}
    for name in names:
        chains.setdefault(structure(scene(name)), scene(name))
    orders = list(PIECES), list(reversed(PIECES))
    with ExitStack() as stack:
        pools = [stack.enter_context(pool(1)) for _ in range(workers)]
        with starting():
            jobs = [worker.submit(_compile, (chain, piece))
                    for chain, worker, pieces in zip(chains.values(), cycle(pools), cycle(orders), strict=False)
                    for piece in pieces]
        for job in as_completed(jobs):
            yield job.result()
