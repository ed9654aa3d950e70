"""Priorities of threads: the event loop and what has just begun go before work that takes long.

On Linux every thread has a niceness of its own; elsewhere it belongs to the whole process, and nothing is changed.
Without special rights a thread cannot take back what it gave up: one that gives way ends with the work that it does
(queues.py), and threads that it begins give way too. The main thread, that of the event loop, never gives way.
"""

from __future__ import annotations

import os
import sys
import threading

#: Niceness of a thread that gives way: beside one that does not it gets a tenth of a processor.
_PATIENT = 10

_here = threading.local()


def give_way() -> None:
    """From now on let threads that do not give way have the processor first."""
    if sys.platform == "linux" and not gives_way() and threading.current_thread() is not threading.main_thread():
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _PATIENT)
        _here.gives_way = True


def gives_way() -> bool:
    """Whether this thread does."""
    return getattr(_here, "gives_way", False)
