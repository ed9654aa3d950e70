"""Computation on a Dask cluster, for maps, curves, batches and fits that are too large for one machine.

A scheduler is represented by a client of `distributed`, which `connect` returns. Workers need the same version of
granchain. When a worker ends, the scheduler gives its work to another. Results do not depend on which worker computes
them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from .errors import BadInput, Cancelled, ComputationError
from .execution.stop import Stop

#: Time within which a scheduler must answer [s].
_ANSWERS = 4.0
#: Time between two checks whether the work is still wanted [s].
_LOOK = 0.2


def connect(address: str) -> Any:
    """Return a client of the scheduler at `address`. Raises `BadInput` if none answers or `distributed` is missing."""
    try:
        from distributed import Client
    except ImportError:
        raise BadInput("--scheduler needs the package distributed; install it here and on every worker with "
                       "`pip install distributed`, or with `pip install -e '.[scheduler]'` in a clone of "
                       "granchain.") from None
    try:
        return Client(address, timeout=_ANSWERS)
    except (OSError, ValueError, TimeoutError) as problem:
        raise BadInput(f"No Dask scheduler answers at {address[:80]} ({str(problem)[:80]}); start one with "
                       "`dask scheduler` and workers with `dask worker`.") from None


def dealt(items: Sequence[Any], size: int) -> list[list[Any]]:
    """Deal items into blocks of at most `size`, each from the whole range, so that all blocks cost about the same."""
    count = max(1, -(-len(items) // size))
    return [list(items[first::count]) for first in range(count) if len(items)]


def results(client: Any, work: Callable[..., Any], tasks: Sequence[tuple[Any, ...]],
            stop: Stop | None = None) -> Iterator[tuple[int, Any]]:
    """Yield the number and result of each task, `work(*task)`, in the order in which workers return them.

    Tasks that are no longer wanted are cancelled. Raises `Cancelled` when `stop` is set, and `ComputationError` if a
    worker fails in its task.
    """
    number = {client.submit(work, *task, pure=False): i for i, task in enumerate(tasks)}
    waiting = set(number)
    try:
        while waiting:
            if stop:
                raise Cancelled
            done, waiting = _some(waiting)
            for future in done:
                yield number[future], _result(future)
    finally:
        client.cancel(list(waiting))


def _some(waiting: set[Any]) -> tuple[set[Any], set[Any]]:
    from distributed import wait

    try:
        ready = wait(waiting, timeout=_LOOK, return_when="FIRST_COMPLETED")
    except TimeoutError:
        return set(), waiting
    return set(ready.done), set(ready.not_done)


def _result(future: Any) -> Any:
    try:
        return future.result()
    except (BadInput, ComputationError):
        raise
    except Exception as problem:
        raise ComputationError(f"A worker could not do its part: {type(problem).__name__}: {str(problem)[:200]}; "
                               "look at its log, and continue with --resume.", "worker-failed") from None
