"""Steady states of many starts: in a batch if they can share one and it decides, otherwise one by one."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from ...execution.stop import Stop
from ...integrate import following_setting
from ...integrate.batch import can_share_batch
from ...integrate.methods import DOP853, RK4_SPLIT
from ...scene import Scene
from ..settling.single_chain import settle_or_failure, settled_alone
from ..steady_state import SteadyState
from .job import Start
from .jobs_in_batch import batch_states
from .threads import on_all_cores


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


def settle_on_all_cores(starts: Iterable[Start], stop: Stop | None = None,
                        workers: int | None = None, pause: Callable[[], None] | None = None) -> Iterator[SteadyState]:
    """Yield the steady states from starts of one structure as they are found; closing the generator ends the work."""
    ended = Stop()
    return on_all_cores(lambda shared: settle_starts(shared, ended), starts, ended, stop, workers, pause)
