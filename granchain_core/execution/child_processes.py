"""Child processes that end with their parent, however it ends.

When its parent is killed, a process pool's worker keeps waiting for work that never comes. Workers started here watch
their parent. They ignore Ctrl-C, which a terminal sends to them as well, because the parent decides when they end.
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

#: Time between two checks of the parent where no pipe closes with it [s].
_LOOK = 0.1


def end_with_parent(parent: int) -> None:
    """End this process as soon as `parent`, the process that started it, has ended."""
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
    """Block Ctrl-C while processes are started, which inherit the block until they ignore Ctrl-C themselves."""
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

    If it were started along with the first process, it would unblock the signal. Its warning about semaphores that a
    signal left behind is suppressed.
    """
    sys.warnoptions.append("ignore:resource_tracker")  # inherited by the tracker process
    try:
        resource_tracker.ensure_running()
    finally:
        sys.warnoptions.remove("ignore:resource_tracker")


def pool(workers: int) -> ProcessPoolExecutor:
    """Return a pool of such processes; submit its first work inside `starting`."""
    _start_tracker()
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"), initializer=end_with_parent,
                               initargs=(os.getpid(),))
