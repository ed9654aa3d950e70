"""Where computations of the dashboard run: worker threads for the process, one latest-wins job a session.

Kernels release the GIL, so threads are enough. Pictures and curves have pools of their own because a curve
lasts seconds and a picture must never wait for one.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from granchain_core import Cancelled

_CORES = os.cpu_count() or 1

PICTURES = ThreadPoolExecutor(max_workers=4 * max(2, _CORES), thread_name_prefix="picture")
"""More than cores: a job that waits for the compiler keeps its thread, and must not keep other visitors waiting."""
BACKGROUND = ThreadPoolExecutor(max_workers=max(1, _CORES // 2), thread_name_prefix="background")
ANALYSES = ThreadPoolExecutor(max_workers=max(2, _CORES), thread_name_prefix="analysis")
"""What follows a picture while the knobs rest: short, and given up when a knob moves."""

MEASUREMENTS = ThreadPoolExecutor(max_workers=1, thread_name_prefix="measurement")
"""What measures times, one after the other for all visitors: two at once would measure each other."""

_MAPS = threading.BoundedSemaphore(2)


def in_thread(work: Callable[..., None], *arguments: object) -> None:
    """Do something that lasts, such as a diagram or a search, two at a time; the process does not wait for its end."""

    def run() -> None:
        with _MAPS:
            work(*arguments)

    threading.Thread(target=run, daemon=True, name="map").start()


Stop = np.ndarray
"""A flag of one byte that running kernels look at."""

Work = Callable[[Stop], Iterator[object]]


class LatestWins:
    """One running computation for a session; a newer one replaces whatever waits.

    A computation is an iterator of ever better results. Its first result is always delivered, and only the
    refinement after it is stopped for a newer request: if everything could be cancelled, nothing would be
    repainted during a drag.
    """

    def __init__(self, deliver: Callable[[object], None], fail: Callable[[Exception], None],
                 pool: ThreadPoolExecutor = PICTURES) -> None:
        self._deliver = deliver
        self._fail = fail
        self._pool = pool
        self._lock = threading.Lock()
        self._waiting: Work | None = None
        self._running = False
        self._refining = False
        self._closed = False
        self._stop = np.zeros(1, dtype=np.uint8)

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
                self._stop[0] = 1
            if self._running:
                return
            self._running = True
        self._pool.submit(self._drain)

    def close(self) -> None:
        """Give up: nothing more is computed or delivered."""
        with self._lock:
            self._closed = True
            self._waiting = None
            self._stop[0] = 1

    def _next(self) -> Work | None:
        with self._lock:
            work, self._waiting = self._waiting, None
            self._running = work is not None
            self._refining = False
            self._stop = np.array([self._closed], dtype=np.uint8)
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
