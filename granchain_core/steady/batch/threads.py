"""Independent work on all cores: threads take items from one iterator and yield results.

Kernels run without the GIL, except brief ones, so threads are enough, and results need not be copied.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Generic, TypeVar

from ...errors import Cancelled
from ...execution.cores import usable_cores
from ...execution.stop import Stop

#: Interval at which the threads' results and the stop flag are checked [s]. Waking up for each result would take the
#: GIL from the threads hundreds of times per second.
_INTERVAL = 0.005

Item = TypeVar("Item")
Result = TypeVar("Result")


class _Shared(Generic[Item]):
    """An iterator that several threads may draw from."""

    def __init__(self, items: Iterable[Item], pause: Callable[[], None] | None) -> None:
        self._items, self._pause, self._lock = iter(items), pause, threading.Lock()

    def __iter__(self) -> Iterator[Item]:
        return self

    def __next__(self) -> Item:
        with self._lock:
            if self._pause is not None:
                self._pause()
            return next(self._items)


def on_all_cores(work: Callable[[Iterator[Item]], Iterable[Result]], items: Iterable[Item], ended: Stop,
                 stop: Stop | None = None, workers: int | None = None,
                 pause: Callable[[], None] | None = None) -> Iterator[Result]:
    """Yield the results of `work` on `items`, in one thread per core, in the order of completion.

    `stop` is checked between results and ends the iteration, as closing the generator does; `ended`, which the kernels
    of `work` poll, is then set. `pause` is called before an item is drawn and may wait. An exception that ends a thread
    is raised here, the first one if there are several; so is `Cancelled`, unless `ended` or `stop` is set.
    """
    shared: _Shared[Item] = _Shared(items, pause)
    results: queue.SimpleQueue[Any] = queue.SimpleQueue()
    a_thread_ended = threading.Event()
    count = workers or usable_cores()
    threads = [threading.Thread(target=_share, args=(work, shared, results, a_thread_ended, (ended, stop)),
                                daemon=True, name=f"core-{i}") for i in range(count)]
    for thread in threads:
        thread.start()
    try:
        while count > 0:
            a_thread_ended.wait(_INTERVAL)
            a_thread_ended.clear()
            while not results.empty():
                if stop:
                    return
                item = results.get()
                if isinstance(item, BaseException):
                    raise item
                if item is None:
                    count -= 1
                else:
                    yield item
            if stop:
                return
    finally:
        ended.set()
        for thread in threads:
            thread.join()


def _share(work: Callable[[Iterator[Item]], Iterable[Result]], items: Iterator[Item],
           results: queue.SimpleQueue[Any], a_thread_ended: threading.Event, stops: tuple[Stop | None, ...]) -> None:
    """Put one thread's share into `results`: its results, the exception that ended it, if any, and finally None.

    `Cancelled` is not reported if one of `stops` is set.
    """
    try:
        for result in work(items):
            results.put(result)
    except BaseException as problem:  # raised again by the thread that reads the queue
        if not (isinstance(problem, Cancelled) and any(stops)):
            results.put(problem)
    finally:
        results.put(None)
        a_thread_ended.set()
