"""Thread priorities: the event loop and computations that have just begun take precedence over long work.

On Linux, every thread has its own nice value. On other systems, the nice value applies to the whole process, and this
module changes nothing. Without special rights, a thread cannot raise its priority again, so a thread of lower priority
ends with its work (worker_pools.py). Threads inherit the lower priority of the thread that starts them, unless `begin`
starts them. The main thread, which runs the event loop, keeps its priority.
"""

from __future__ import annotations

import os
import sys
import threading
from concurrent.futures import Future
from queue import SimpleQueue

#: Added to the nice value of a thread of lower priority; sharing a processor, it then gets a tenth of it.
ADDED_NICENESS = 10


class _Starter:
    """A thread of usual priority that starts other threads."""

    def __init__(self) -> None:
        self._asked: SimpleQueue[tuple[threading.Thread, Future[None]]] = SimpleQueue()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def run(self) -> bool:
        """Start this thread unless it is running, from a thread of usual priority; return whether it is running."""
        with self._lock:
            if self._thread is None or not self._thread.is_alive():
                thread = threading.Thread(target=self._serve, daemon=True, name="starter")
                try:
                    thread.start()
                except RuntimeError:  # the system allows no more threads now
                    return False
                self._thread = thread
        return True

    def start(self, thread: threading.Thread) -> None:
        """Have the thread started, and wait until it runs. Raises any error of `Thread.start`."""
        started: Future[None] = Future()
        self._asked.put((thread, started))
        started.result()

    def _serve(self) -> None:
        while True:
            thread, started = self._asked.get()
            try:
                thread.start()
            except BaseException as error:
                started.set_exception(error)
            else:
                started.set_result(None)
            del thread, started


_STARTER = _Starter()


def lower_priority() -> None:
    """Lower the priority of this thread, so that threads of usual priority get the processor first.

    The priority is not changed if the thread that starts threads of usual priority cannot be started.
    """
    if sys.platform != "linux" or threading.current_thread() is threading.main_thread():
        return
    if not has_lower_priority() and _STARTER.run():
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), min(_usual() + ADDED_NICENESS, 19))


def has_lower_priority() -> bool:
    """Return whether the priority of this thread was lowered, or inherited from a thread of lower priority."""
    return sys.platform == "linux" and os.getpriority(os.PRIO_PROCESS, threading.get_native_id()) > _usual()


def _usual() -> int:
    """Return the nice value of the main thread."""
    return os.getpriority(os.PRIO_PROCESS, os.getpid()) if sys.platform == "linux" else 0


def begin(thread: threading.Thread) -> None:
    """Start a thread of usual priority, whatever the priority of this thread. Raises any error of `Thread.start`."""
    if has_lower_priority():
        _STARTER.start(thread)
    else:
        thread.start()
