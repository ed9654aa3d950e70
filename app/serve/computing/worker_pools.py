"""The thread pools in which the dashboard computes.

All sessions share these pools. Kernels release the GIL, so threads are enough. Threads that compute pictures take turns
(turns.py), and only the latest of a session's requests for pictures counts (latest_wins.py). Long work has separate
pools, because a picture must never wait for long work.
"""

from __future__ import annotations

import logging
import threading
from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial
from itertools import count
from queue import SimpleQueue
from typing import TypeVar

from .priorities import begin, has_lower_priority, lower_priority

log = logging.getLogger("granchain")

Result = TypeVar("Result")


class WorkerPool:
    """At most `workers` threads for one kind of work, first come, first served. A thread is started when it is needed.
    `purpose` says what the work is (docs/dashboard-server.md).

    The threads are daemons: a branch or a map takes minutes, and a server that shuts down does not wait for them.
    Threads of a `low_priority` pool leave the processor to others (priorities.py).

    With a `per_owner_limit`, at most that many pieces of one owner's work run or wait for a thread. Further pieces are
    held back. When an earlier piece of the owner ends, the next is queued behind the work of others.

    A thread counts as busy from the moment it is given work, before the work begins. Otherwise the next piece of work
    would be given to the same thread and wait, although another thread is free.
    """

    def __init__(self, name: str, workers: int, purpose: str = "", low_priority: bool = False,
                 per_owner_limit: int | None = None) -> None:
        self.name = name
        self.purpose = purpose
        self.per_owner_limit = per_owner_limit
        self.workers = workers
        self.low_priority = low_priority
        self._given: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._threads: list[threading.Thread] = []
        self._numbers = count()
        self._free = 0  # number of threads without work
        self.queued = 0  # pieces of work that wait for a thread
        self._lock = threading.Lock()
        self._taken: Counter[object] = Counter()  # by owner: pieces of work that run or wait for a thread
        self._held: dict[object, deque[Callable[[], None]]] = {}  # by owner: work beyond the limit

    @property
    def busy_threads(self) -> int:
        """Number of threads that have work, even if they are waiting in the middle of it, for example for a turn."""
        return len(self._threads) - self._free

    @property
    def held(self) -> int:
        """Number of pieces of work that wait because their owner has reached the limit."""
        with self._lock:
            return sum(map(len, self._held.values()))

    def submit(self, work: Callable[..., Result], *args: object, owner: object = None) -> Future[Result]:
        """Call `work` as soon as a thread is free; the returned future gets its result or error.

        Work without an `owner` has no limit. Raises the error of `Thread.start` if the pool has no thread and the
        system allows none. If the future is cancelled before the work begins, the work is not done, and nothing keeps
        the work or its arguments alive.
        """
        future: Future[Result] = Future()
        limited = self.per_owner_limit is not None and owner is not None
        piece = [partial(work, *args)]
        owners = [owner]  # emptied at the end: a future keeps its callbacks, which would keep the owner alive

        def do() -> None:
            try:
                if future.set_running_or_notify_cancel():
                    future.set_result(piece.pop()())
            except BaseException as error:
                future.set_exception(error)
            finally:
                with self._lock:
                    ended = owners.pop()
                if limited:
                    self._ended(ended)

        def forget(ended: Future[Result]) -> None:
            if ended.cancelled():
                piece.clear()
                if self._let_go(owners, do):
                    owners.clear()

        future.add_done_callback(forget)

        with self._lock:
            if limited and self._taken[owner] == self.per_owner_limit:
                self._held.setdefault(owner, deque()).append(do)
            else:
                self._give(do)
                self._taken.update([owner] if limited else [])
        return future

    def _give(self, do: Callable[[], None]) -> None:
        """Give work to a free or a new thread, or queue it; called with the lock held."""
        if self._free:
            self._free -= 1
        elif len(self._threads) == self.workers or not self._begin():
            self.queued += 1
        self._given.put(do)

    def _let_go(self, owners: list[object], do: Callable[[], None]) -> bool:
        """Drop cancelled work that is held back by its owner's limit; return whether there was any.

        Cancelled work that is already queued stays in the queue and does nothing. `owners` is empty if a thread has
        taken the work since it was cancelled.
        """
        with self._lock:
            waiting = self._held.get(owners[0]) if owners else None
            if waiting is None or do not in waiting:
                return False
            waiting.remove(do)
            if not waiting:
                del self._held[owners[0]]
            return True

    def _ended(self, owner: object) -> None:
        """Queue the next work of this owner, because earlier work of the owner has ended."""
        with self._lock:
            if waiting := self._held.get(owner):
                self._give(waiting.popleft())
                return
            self._held.pop(owner, None)
            self._taken[owner] -= 1
            if not self._taken[owner]:
                del self._taken[owner]

    def _begin(self) -> bool:
        """Start one more thread; called with the lock held.

        If the system allows no more threads, return False: the existing threads then do all work, only later. Raise the
        error if the pool has no threads.
        """
        thread = threading.Thread(target=self._serve, daemon=True, name=f"{self.name} {next(self._numbers)}")
        try:
            begin(thread)
        except Exception:
            if not self._threads:
                raise
            log.warning("the pool %s could not start another thread", self.name, exc_info=True)
            return False
        self._threads.append(thread)
        return True

    def _is_replaced(self) -> bool:
        """Let this thread leave the pool, and start another if work is queued; called with the lock held.

        If no other thread can be started, return False: this thread must stay, despite its lower priority.
        """
        if self.queued:
            if not self._begin():
                return False
            self.queued -= 1
        self._threads.remove(threading.current_thread())
        return True

    def _serve(self) -> None:
        """Do one piece of work after another, in a thread.

        A thread whose priority was lowered by its work ends, because it cannot regain its usual priority.
        """
        if self.low_priority:
            lower_priority()
        while True:
            work = self._given.get()
            work()
            del work  # otherwise a waiting thread would keep objects of the last session alive
            with self._lock:
                if has_lower_priority() and not self.low_priority and self._is_replaced():
                    return
                if self.queued:
                    self.queued -= 1
                else:
                    self._free += 1


#: The number of threads is limited because each takes memory. The limit is below the largest `--max-sessions`, since
#: most pages are idle.
SESSION_WORK = WorkerPool(
    "session_work", 1000,
    "a thread for each session that waits for its main picture; live steps, drafts of the curve, energy accounts")
#: There are more threads than cores, because turns decide which threads compute (turns.py), and a picture that waits
#: for the compiler keeps its thread. If more pictures than this need a thread, first pictures no longer go before
#: refinements.
PICTURES = WorkerPool("pictures", 200, "the main pictures, for all sessions that wait; the Observer page, without a "
                                       "turn")
#: Short work, which is cancelled when a knob moves. The long questions of the page Analysis are work of `LONG`.
ANALYSES = WorkerPool(
    "analyses", 8,
    "while the knobs rest: Stability, pinned motions, the motion of a story's step, the names of peaks, where a "
    "measured series lies over the picture", low_priority=True)
#: On the event loop, this work would hold up everyone. The files of one session are read one by one, so that they
#: cannot take both threads.
FILES = WorkerPool("files", 2, "reading a measurement, writing an export", per_owner_limit=1)
LOADING = WorkerPool("loading", 1, "kernels loaded before a session needs them")
#: A map waits for a curve that is under way. In a single pool, maps could take all threads and wait for curves that
#: have no thread.
CURVES = WorkerPool("curves", 200, "a thread for each session that waits for its resonance curve, or for that of a "
                                   "pinned picture")
#: Each computation uses all cores, which the system divides among them.
CURVE_WORK = WorkerPool(
    "sweeps", 8, "the resonance curves, and frequencies for the names of peaks, for all sessions that wait",
    low_priority=True)
#: One session could start all of this work, and two sessions could fill the pool, so each has a limit.
LONG = WorkerPool(
    "long", 8,
    "parameter maps, searches for attractors, branches, the questions of Analysis, figures of the paper, virtual "
    "experiments",
    low_priority=True, per_owner_limit=2)
#: One at a time for all sessions, because two simultaneous timings disturb each other. Its priority is not lowered,
#: because a timing that others hold up is wrong.
MEASUREMENTS = WorkerPool("measurements", 1, "timings of Accuracy and Effects, and hard cases")
COMPILATIONS = WorkerPool("compilations", 2, "waiting for processes that compile kernels")

#: All pools.
POOLS = (SESSION_WORK, PICTURES, ANALYSES, FILES, LOADING, CURVES, CURVE_WORK, LONG, MEASUREMENTS, COMPILATIONS)
#: Pools whose busy threads compute. A thread of `PICTURES` or `SESSION_WORK` computes only while it has a turn, and a
#: thread of `CURVES` waits for `CURVE_WORK`.
COMPUTING = (ANALYSES, CURVE_WORK, LONG, MEASUREMENTS)
