"""Steady states of many starts: in a batch if they can share one and it decides, otherwise one by one."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from ...errors import BadInput
from ...execution.cores import usable_cores
from ...execution.memory import usable_memory
from ...execution.stop import Stop
from ...integrate import following_setting
from ...integrate.batch import batch_bytes, can_share_batch
from ...integrate.methods import DOP853, RK4_SPLIT
from ...scene import Scene
from ..settling.single_chain import settle_or_failure, settled_alone
from ..steady_state import SteadyState
from .job import Start
from .jobs_in_batch import batch_states
from .threads import on_all_cores

#: [no threshold] Largest part of the memory that the batches of one computation may take.
_MEMORY_OF_BATCHES = 0.8


def settling_methods(scene: Scene, each: str) -> str:
    """The methods behind many steady states of `scene`, in words for provenance; `each` is "point", "cell", …"""
    alone = f"{methods_alone(scene)} {each} by {each}"
    return f"rk4 corrected at contact events, in batches, {alone}" if can_share_batch(scene) else alone


def methods_alone(scene: Scene) -> str:
    """The methods by which a chain alone reaches its steady state and is computed there."""
    return DOP853 if following_setting(scene.cuts_tension).method == DOP853 else f"{RK4_SPLIT} or {DOP853}"


def settle_starts(starts: Iterable[Start], stop: Stop) -> Iterator[SteadyState]:
    """Yield the steady states from starts of one structure and one N, in the order in which they are decided.

    A start that a batch leaves undecided is settled alone. So is a start that fails in the batch, because the failure
    of a chain settled alone tells which bead failed and when. Raises `Cancelled`.
    """
    others = iter(starts)
    first = next(others, None)
    if first is None:
        return
    together = itertools.chain([first], others)
    if can_share_batch(first.scene):
        for result in batch_states(together, stop):
            yield settled_alone(result, stop) if result.undecided or result.failure else result
        return
    for start in together:
        yield replace(settle_or_failure(start.scene, start.state, stop), number=start.number)


def threads_for(example: Scene, workers: int | None = None) -> int:
    """Return the number of threads: `workers`, by default one for each core, but no more than have memory for a batch.

    Results do not depend on it. Raises `BadInput` if the memory is too small for one batch.
    """
    count, memory = workers or usable_cores(), usable_memory()
    if memory is None or not can_share_batch(example):
        return count
    needed = batch_bytes(example.N)
    fitting = int(_MEMORY_OF_BATCHES * memory / needed)
    if fitting == 0:
        most = int(_MEMORY_OF_BATCHES * memory / needed * (example.N + 2)) - 2
        raise BadInput(f"Chains of {example.N} beads are computed in batches of {needed / 1e9:.2g} GB, and "
                       f"{memory / 1e9:.2g} GB of memory are too small for one; the nearest valid value is N = {most}.")
    return min(count, fitting)


def settle_on_all_cores(starts: Iterable[Start], stop: Stop | None = None,
                        workers: int | None = None, pause: Callable[[], None] | None = None) -> Iterator[SteadyState]:
    """Yield the steady states from starts of one structure as they are found; closing the generator ends the work."""
    ended, others = Stop(), iter(starts)
    first = next(others, None)
    if first is None:
        return iter(())
    together, count = itertools.chain([first], others), threads_for(first.scene, workers)
    return on_all_cores(lambda shared: settle_starts(shared, ended), together, ended, stop, count, pause)
