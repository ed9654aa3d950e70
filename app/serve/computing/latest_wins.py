"""One computation at a time, replaced by a newer request.

Each session has two `LatestWins`: one for its picture and one for the drafts of its curve.
"""

from __future__ import annotations

import heapq
import logging
import threading
import time
from collections.abc import Callable, Iterator

from granchain_core import Cancelled

from ..monitoring.metrics import METRICS
from .cpu_time import CpuTime
from .priorities import has_lower_priority
from .turns import TurnFlag
from .worker_pools import SESSION_WORK

log = logging.getLogger("granchain")

TurnWork = Callable[[TurnFlag], Iterator[object]]

#: Time for which a first result is computed before a newer request stops it [s].
_FIRST_RESULT_TIME = 1.0


class _Alarms:
    """A thread that calls each action when it is due; a `threading.Timer` would need a thread for each action."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._due: list[tuple[float, int, Callable[..., None], tuple[object, ...]]] = []
        self._count = 0
        self._thread: threading.Thread | None = None

    def __call__(self, seconds: float, action: Callable[..., None], *args: object) -> None:
        """Call `action` after `seconds`."""
        with self._changed:
            self._count += 1
            heapq.heappush(self._due, (time.monotonic() + seconds, self._count, action, args))
            if self._thread is None:
                self._start()
            self._changed.notify()

    def _start(self) -> None:
        """Start the thread. If the system refuses, the next call tries again; until then, no action is called."""
        thread = threading.Thread(target=self._serve, daemon=True, name="alarms")
        try:
            thread.start()
        except RuntimeError:
            log.warning("the thread of alarms could not be started", exc_info=True)
        else:
            self._thread = thread

    def _serve(self) -> None:
        while True:
            with self._changed:
                while not self._due or self._due[0][0] > time.monotonic():
                    self._changed.wait(self._due[0][0] - time.monotonic() if self._due else None)
                _, _, action, args = heapq.heappop(self._due)
            action(*args)
            del action, args


_later = _Alarms()


class LatestWins:
    """Runs at most one computation and keeps at most one waiting request; a newer request replaces the waiting one.

    A computation is an iterator of ever better results. A newer request stops a computation at once if it has had its
    first result. A computation without a result may continue for up to `_FIRST_RESULT_TIME`: if every request stopped
    it, the page would show no new picture during a drag.
    """

    def __init__(self, deliver: Callable[[object], None], fail: Callable[[Exception], None],
                 cpu_time: CpuTime | None = None) -> None:
        self._deliver = deliver
        self._fail = fail
        self.cpu_time = CpuTime() if cpu_time is None else cpu_time
        self._lock = threading.Lock()
        self._waiting: TurnWork | None = None
        self._running = False
        self._refining = False
        self._closed = False
        self._began = 0.0
        self._stop = TurnFlag(self.cpu_time)

    @property
    def busy(self) -> bool:
        """Whether a computation is running or waiting."""
        return self._running

    def submit(self, work: TurnWork) -> None:
        """Compute `work` next; it replaces a request that is still waiting."""
        with self._lock:
            if self._closed:
                return
            self._waiting = work
            left = self._began + _FIRST_RESULT_TIME - time.monotonic()
            if self._refining or (self._running and left <= 0.0):
                self._stop.set()
            elif self._running:
                _later(left, self._give_up, self._stop)
            if self._running:
                return
            self._running = True
            self._began = time.monotonic()
        try:
            SESSION_WORK.submit(self._drain)
        except Exception:  # the caller reports it; the next request must be able to start
            with self._lock:
                self._running, self._waiting = False, None
            raise

    def _give_up(self, stop: TurnFlag) -> None:
        """Stop a computation that has no result after `_FIRST_RESULT_TIME` if newer work is waiting."""
        with self._lock:
            if self._stop is stop and self._waiting is not None:
                stop.set()

    def cancel(self) -> None:
        """Stop the running computation and drop a waiting request; later requests are computed as usual."""
        with self._lock:
            self._waiting = None
            self._stop.set()

    def close(self) -> None:
        """Stop for good: nothing more is computed or delivered."""
        with self._lock:
            self._closed = True
            self._waiting = None
            self._stop.set()

    def _next(self) -> TurnWork | None:
        with self._lock:
            work, self._waiting = self._waiting, None
            self._running = work is not None
            self._refining = False
            self._began = time.monotonic()
            self._stop = TurnFlag(self.cpu_time)
            if self._closed:
                self._stop.set()
            return work

    def _drain(self) -> None:
        while (work := self._next()) is not None:
            self._do(work)
            if has_lower_priority():
                SESSION_WORK.submit(self._drain)
                return

    def _do(self, work: TurnWork) -> None:
        """Deliver the results of a computation. If newer work is waiting, end after the next result."""
        try:
            for result in work(self._stop):
                if self._closed:
                    break
                self._deliver(result)
                with self._lock:
                    self._refining = True
                    if self._waiting is not None or self._closed:
                        break
        except Cancelled:
            METRICS.count("cancelled")
        except Exception as error:
            self._report(error)

    def _report(self, error: Exception) -> None:
        """Report a failure. If reporting fails too, log that, so that the next computation still starts."""
        try:
            if not self._closed:
                self._fail(error)
        except Exception:
            log.exception("a failure could not be reported to its page")
