"""Priorities of threads: the event loop and computations that have just begun go before long work.

On Linux every thread has a niceness of its own; elsewhere it belongs to the whole process, and nothing is changed.
Without special rights a thread cannot raise its priority again, so a thread that gives way ends with its work
(queues.py). Threads that it starts give way too, unless `begin` starts them. The main thread, which has the event loop,
never gives way.
"""

from __future__ import annotations

import os
import sys
import threading
from queue import SimpleQueue

#: Niceness added to a thread that gives way: beside a thread that does not, it gets a tenth of a processor.
_PATIENT_NICENESS = 10


class _Starter:
    """A thread that does not give way, and starts others."""

    def __init__(self) -> None:
        self.asked: SimpleQueue[threading.Thread] = SimpleQueue()
        self._lock = threading.Lock()
        self._running = False

    def run(self) -> None:
        """Start it; called by a thread that does not give way yet."""
        with self._lock:
            if not self._running:
                threading.Thread(target=self._serve, daemon=True, name="starter").start()
                self._running = True

    def _serve(self) -> None:
        while True:
            self.asked.get().start()


_STARTER = _Starter()


def give_way() -> None:
    """Lower this thread's priority: from now on threads that do not give way have the processor first."""
    if sys.platform == "linux" and not gives_way() and threading.current_thread() is not threading.main_thread():
        _STARTER.run()
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), min(_usual() + _PATIENT_NICENESS, 19))


def gives_way() -> bool:
    """Whether this thread gives way, or was started by one that does."""
    return sys.platform == "linux" and os.getpriority(os.PRIO_PROCESS, threading.get_native_id()) > _usual()


def _usual() -> int:
    """The niceness of the main thread."""
    return os.getpriority(os.PRIO_PROCESS, os.getpid()) if sys.platform == "linux" else 0


def begin(thread: threading.Thread) -> None:
    """Start a thread that does not give way, whether or not this one does."""
    if gives_way():
        _STARTER.asked.put(thread)
    else:
        thread.start()
