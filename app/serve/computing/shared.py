"""Shared results: request coalescing (*single flight*) with an LRU cache in bounded memory.

A result is computed once for all sessions that wait for it, so a lecture hall in which all pages have the same knobs
costs as much as one session. A computation ends when the last session waiting for it has moved on or ended.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Generator, Hashable, Iterator
from typing import Generic, TypeVar

from granchain_core.execution.stop import Stop

from .cpu_time import CpuTime, SharedCpuTime
from .turns import Flag, TurnFlag
from .worker_pools import WorkerPool

Item = TypeVar("Item")

#: Time between two checks of a waiting session's stop flag [s]; new items wake the session at once.
_STOP_CHECK_INTERVAL = 0.5


class _Computation(Generic[Item]):
    """One computation: its results so far, the sessions that wait for it, and how it ended."""

    def __init__(self) -> None:
        self.changed = threading.Condition()
        self.items: list[Item] = []
        self.done = False
        self.error: Exception | None = None
        self.cpu_time = SharedCpuTime()
        self.stop = TurnFlag(self.cpu_time)


def _copy_of(error: Exception) -> Exception:
    """Return a copy of an error for one session: raising it adds only that session's frames to the traceback."""
    # copy.copy would call __init__, which may take other arguments
    copied = type(error).__new__(type(error), *error.args)
    copied.__dict__.update(error.__dict__)
    copied.__cause__, copied.__suppress_context__ = error.__cause__, error.__suppress_context__
    return copied.with_traceback(error.__traceback__)


class Shared(Generic[Item]):
    """Shared computations, by key.

    `kept` chooses the items of a finished computation that are kept, and `size` returns the memory of an item. All kept
    items together take at most `memory` bytes; the least recently used computation is dropped first. With `turns`, the
    computations take turns (turns.py); without, the threads of the pool are given first come, first served.
    """

    def __init__(self, pool: WorkerPool, memory: int, size: Callable[[Item], int],
                 kept: Callable[[list[Item]], list[Item]] = lambda items: items, turns: bool = True) -> None:
        self._pool, self.memory, self._size, self._kept, self._turns = pool, memory, size, kept, turns
        self._lock = threading.Lock()
        self._under_way: dict[Hashable, _Computation[Item]] = {}
        self._finished: OrderedDict[Hashable, tuple[list[Item], int]] = OrderedDict()
        self.used = 0
        self.hits, self.misses = 0, 0

    def follow(self, key: Hashable, compute: Callable[[TurnFlag], Iterator[Item]], stop: Stop,
               cpu_time: CpuTime | None = None) -> Generator[Item, None, None]:
        """Yield the items of `compute`, or of the computation with the same key that is under way or finished.

        A computation with the key None is not shared. Only computations that take turns are charged to `cpu_time`.
        Raises `Cancelled` when `stop` is set, and errors of `compute`.
        """
        cpu_time = cpu_time or CpuTime()
        with self._lock:
            if key in self._finished:
                self.hits += 1
                self._finished.move_to_end(key)
                ready = self._finished[key][0]
            else:
                ready = None
                computation = self._join(key, compute, cpu_time)
        if ready is not None:
            yield from ready
            return
        try:
            yield from self._awaited(computation, stop)
        finally:
            self._unsubscribe(key, computation, cpu_time)

    def _join(self, key: Hashable, compute: Callable[[TurnFlag], Iterator[Item]],
                cpu_time: CpuTime) -> _Computation[Item]:
        """Return the computation under way, or a new one; called with the lock held."""
        computation = None if key is None else self._under_way.get(key)
        if computation is None:
            computation = _Computation()
            computation.cpu_time.members.append(cpu_time)
            self._pool.submit(self._compute, key, computation, compute)  # first: it may raise
            self.misses += 1
            if key is not None:
                self._under_way[key] = computation
        else:
            self.hits += 1
            computation.cpu_time.members.append(cpu_time)
        return computation

    def _unsubscribe(self, key: Hashable, computation: _Computation[Item], cpu_time: CpuTime) -> None:
        with self._lock:
            computation.cpu_time.members.remove(cpu_time)
            if not computation.cpu_time.members and not computation.done:
                computation.stop.set()
                self._forget(key, computation)

    def _forget(self, key: Hashable, computation: _Computation[Item]) -> None:
        if self._under_way.get(key) is computation:
            del self._under_way[key]

    @staticmethod
    def _awaited(computation: _Computation[Item], stop: Stop) -> Iterator[Item]:
        """Yield each result as soon as it exists, until the computation ends; then raise its error, if any.

        The wait ends at once when a `Flag` is set, and at the next check when another `Stop` is set.
        """
        def wake() -> None:
            with computation.changed:
                computation.changed.notify_all()

        if isinstance(stop, Flag):
            stop.on_set = wake
        given = 0
        while True:
            with computation.changed:
                while not stop and given == len(computation.items) and not computation.done:
                    computation.changed.wait(_STOP_CHECK_INTERVAL)
                new, done = computation.items[given:], computation.done
            stop.check()
            given += len(new)
            yield from new
            if done and given == len(computation.items):
                if computation.error is not None:
                    raise _copy_of(computation.error)
                return

    def _compute(self, key: Hashable, computation: _Computation[Item],
                 compute: Callable[[TurnFlag], Iterator[Item]]) -> None:
        """Compute in a thread of the pool."""
        error: Exception | None = None
        try:
            computation.stop.check()
            results = compute(computation.stop)
            for item in computation.stop.in_turns(results) if self._turns else results:
                with computation.changed:
                    computation.items.append(item)
                    computation.changed.notify_all()
                computation.stop.check()
        except Exception as problem:
            error = problem
        try:
            with self._lock:
                self._forget(key, computation)
                if error is None and key is not None:
                    self._keep(key, self._kept(computation.items))
        finally:
            with computation.changed:  # after an error as well, because sessions are waiting
                computation.done, computation.error = True, error
                computation.changed.notify_all()

    def _keep(self, key: Hashable, items: list[Item]) -> None:
        """Keep these items, and drop the least recently used ones beyond `memory`; called with the lock held."""
        size = sum(map(self._size, items))
        if size > self.memory:
            return
        if key in self._finished:  # computed twice: the last session of the first computation had just ended
            self.used -= self._finished.pop(key)[1]
        self._finished[key] = items, size
        self.used += size
        while self.used > self.memory:
            self.used -= self._finished.popitem(last=False)[1][1]
