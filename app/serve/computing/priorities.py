"""Priorities of threads: the event loop and computations that have just begun go before long work.

On Linux every thread has a nice value of its own; elsewhere it belongs to the whole process, and nothing is changed.
Without special rights a thread cannot raise its priority again, so a thread of lower priority ends with its work
(worker_pools.py). Threads that it starts have the lower priority too, unless `begin` starts them. The main thread,
which has the event loop, keeps its priority.
"""

from __future__ import annotations

import os
import sys
import threading
from queue import SimpleQueue

#: Added to the nice value of a thread of lower priority: beside another thread it gets a tenth of a processor.
_ADDED_NICENESS = 10


class _Starter:
    """A thread of usual priority, which starts others."""

    def __init__(self) -> None:
        self.asked: SimpleQueue[threading.Thread] = SimpleQueue()
        self._lock = threading.Lock()
        self._running = False

    def run(self) -> None:
        """Start it; called by a thread of usual priority."""
        with self._lock:
            if not self._running:
                threading.Thread(target=self._serve, daemon=True, name="starter").start()
                self._running = True

    def _serve(self) -> None:
        while True:
            self.asked.get().start()


_STARTER = _Starter()


def lower_priority() -> None:
    """Lower this thread's priority: from now on threads of usual priority have the processor first."""
    if sys.platform != "linux" or threading.current_thread() is threading.main_thread():
        return
    if not has_lower_priority():
        _STARTER.run()
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), min(_usual() + _ADDED_NICENESS, 19))


def has_lower_priority() -> bool:
    """Whether the priority of this thread, or of the one that started it, was lowered."""
    return sys.platform == "linux" and os.getpriority(os.PRIO_PROCESS, threading.get_native_id()) > _usual()


def _usual() -> int:
    """The nice value of the main thread."""
    return os.getpriority(os.PRIO_PROCESS, os.getpid()) if sys.platform == "linux" else 0


def begin(thread: threading.Thread) -> None:
    """Start a thread of usual priority, whatever the priority of this one."""
    if has_lower_priority():
        _STARTER.asked.put(thread)
    else:
        thread.start()
