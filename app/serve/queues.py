"""Where computations of the dashboard run: named queues shared by all visitors, and latest-wins jobs, of which each
visitor has one for the picture and one for drafts of the curve.

Kernels release the GIL, so threads are enough. Long work has queues of its own, because a picture must never wait for
it.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from queue import SimpleQueue
from typing import TypeVar

from granchain_core import Cancelled
from granchain_core.stop import Stop

Result = TypeVar("Result")


class Queue:
    """Work of one kind, first come, first served, on at most so many threads.

    The threads are daemons: a branch or a map lasts minutes, and a server that ends does not wait for it.
    """

    def __init__(self, name: str, workers: int) -> None:
        self.name = name
        self._workers = workers
        self._waiting: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._threads: list[threading.Thread] = []
        self._lock = threading.Lock()

    def submit(self, work: Callable[..., Result], *arguments: object) -> Future[Result]:
        """Call `work` as soon as a thread is free; the future has what it returns or raises."""
        future: Future[Result] = Future()

        def do() -> None:
            try:
                future.set_result(work(*arguments))
            except BaseException as error:
                future.set_exception(error)

        self._waiting.put(do)
        with self._lock:
            if len(self._threads) < self._workers:
                thread = threading.Thread(target=self._serve, daemon=True, name=f"{self.name} {len(self._threads)}")
                self._threads.append(thread)
                thread.start()
        return future

    def _serve(self) -> None:
        while True:
            self._waiting.get()()


_CORES = os.cpu_count() or 1

#: More threads than cores: a picture that waits for the compiler keeps its thread, and must not keep other visitors
#: waiting.
PICTURES = Queue("pictures", 4 * max(2, _CORES))
#: Analyses of a picture while the knobs rest: short, and cancelled when a knob moves.
ANALYSES = Queue("analyses", max(2, _CORES))
#: Reading and writing visitors' files: on the event loop, one visitor's file would hold up everybody.
FILES = Queue("files", 2)
#: Resonance curves, and loading kernels before a visitor asks. Maps and branches wait for a curve that is under way,
#: so curves cannot share their queue.
CURVES = Queue("curves", max(1, _CORES // 2))
#: Work that takes minutes: maps, searches for attractors, branches.
LONG = Queue("long", 2)
#: Timings, one at a time for all visitors: two at once would disturb each other.
MEASUREMENTS = Queue("measurements", 1)
#: Waiting for processes that compile.
COMPILATIONS = Queue("compilations", 2)

Work = Callable[[Stop], Iterator[object]]


class LatestWins:
    """One running computation for a session; a newer one replaces whatever waits.

    A computation is an iterator of ever better results. Its first result is always delivered, and only the
    refinement after it is stopped for a newer request: if everything could be cancelled, nothing would be
    repainted during a drag.
    """

    def __init__(self, deliver: Callable[[object], None], fail: Callable[[Exception], None]) -> None:
        self._deliver = deliver
        self._fail = fail
        self._lock = threading.Lock()
        self._waiting: Work | None = None
        self._running = False
        self._refining = False
        self._closed = False
        self._stop = Stop()

    @property
    def busy(self) -> bool:
        """Whether something is being computed or waits to be."""
        return self._running

    def submit(self, work: Work) -> None:
        """Compute `work` next, in place of anything that has not started."""
        with self._lock:
            if self._closed:
                return
            self._waiting = work
            if self._refining:
                self._stop.set()
            if self._running:
                return
            self._running = True
        PICTURES.submit(self._drain)

    def close(self) -> None:
        """Stop: nothing more is computed or delivered."""
        with self._lock:
            self._closed = True
            self._waiting = None
            self._stop.set()

    def _next(self) -> Work | None:
        with self._lock:
            work, self._waiting = self._waiting, None
            self._running = work is not None
            self._refining = False
            self._stop = Stop()
            if self._closed:
                self._stop.set()
            return work

    def _drain(self) -> None:
        while (work := self._next()) is not None:
            try:
                for result in work(self._stop):
                    self._deliver(result)
                    with self._lock:
                        self._refining = True
                        if self._waiting is not None or self._closed:
                            break
            except Cancelled:
                continue
            except Exception as error:
                if not self._closed:
                    self._fail(error)
