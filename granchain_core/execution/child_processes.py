"""Child processes that end with their parent, however it ends.

A process pool's workers wait for work that never comes when their parent is killed. Those started here watch it. They
ignore Ctrl-C, which a terminal sends to them as well: their parent decides.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import resource_tracker

#: Between two looks at the parent, where there is no pipe that ends with it [s].
_LOOK = 0.1


def end_with_parent(parent: int) -> None:
    """End this process as soon as the process `parent`, which started it, has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_watch, args=(parent,), daemon=True, name="parent").start()


def _watch(parent: int) -> None:
    known = multiprocessing.parent_process()
    if known is not None:
        known.join()  # the parent's end of a pipe closes
    else:
        while os.getppid() == parent:
            time.sleep(_LOOK)
    os._exit(1)


@contextmanager
def starting() -> Iterator[None]:
    """Start processes in this block: they begin with Ctrl-C blocked, before they can ignore it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    _start_tracker()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _start_tracker() -> None:
    """Start Python's process that removes semaphores when all others have ended.

    Started with the first process, it would unblock the signal. It need not complain where a signal has left it some.
    """
    sys.warnoptions.append("ignore:resource_tracker")  # handed on to the processes that are started
    try:
        resource_tracker.ensure_running()
    finally:
        sys.warnoptions.remove("ignore:resource_tracker")


def pool(workers: int) -> ProcessPoolExecutor:
    """A pool of such processes; give it its first work inside `starting`."""
    _start_tracker()
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"), initializer=end_with_parent,
                               initargs=(os.getpid(),))
