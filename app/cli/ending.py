"""Ending a process by Ctrl-C (SIGINT, status 130) or SIGTERM (143): at any time, within three seconds, with a sentence.

Python would raise `KeyboardInterrupt` wherever the main thread happens to be: in an import, in a callback that swallows
it, or only after the compiler has returned. Here a thread waits for the signals instead. While there is nothing to
keep, it ends the process at once. Inside `asking`, it asks the computation to end and gives it some time to keep its
results. Child processes end automatically with this one (granchain_core/execution/child_processes.py).

This module is loaded before anything else, so it imports only modules that take no time.
"""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
from contextlib import contextmanager, suppress

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType
    from typing import NoReturn

#: Time that a computation has to end and to write its results, before the process ends in any case [s].
_GRACE = 2.5
#: Exit status by signal.
_STATUS: dict[int, int] = {signal.SIGINT: 130, signal.SIGTERM: 143}
#: The word that reports the ending, by exit status.
_WORDS = {130: "Cancelled", 143: "Terminated"}


class _EndRequest:
    """A request to end this process: the exit status of the first signal, and the function to call when it arrives.

    `folder` has the pieces finished so far, if the command writes checkpoints. `written` says what the result's file
    contains, once that file is written.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.status: int | None = None
        self.stop_computation: Callable[[], None] | None = None
        self.folder = ""
        self.written = ""


_REQUEST = _EndRequest()


def begin() -> None:
    """Take over both signals; a signal that the process ignored from its start stays ignored."""
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    threading.Thread(target=_wait, args=(reading,), daemon=True, name="signals").start()
    signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    for number in _STATUS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _noted)
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=_forget)


def _noted(_number: int, _frame: FrameType | None) -> None:
    """Do nothing: the signal's number was written to the pipe before Python calls this."""


def _forget() -> None:
    """Restore the default handling of signals in a forked process, which does not have the waiting thread."""
    signal.set_wakeup_fd(-1)
    for number in _STATUS:
        if signal.getsignal(number) is _noted:
            signal.signal(number, signal.SIG_DFL)


def _wait(reading: int) -> None:
    """End the process at the first signal or, if a computation has to be asked, at the second or after `_GRACE`."""
    while True:
        status = _STATUS.get(os.read(reading, 1)[0])
        if status is None:
            continue
        with _REQUEST.lock:
            _REQUEST.status, stop_computation = status, _REQUEST.stop_computation
            if stop_computation is None:
                _end()
        stop_computation()
        select.select([reading], [], [], _GRACE)
        _end()


def note_checkpoints(folder: str) -> None:
    """Record the folder of finished pieces, for the last sentence of a computation that does not end in time."""
    _REQUEST.folder = folder


def wrote(words: str) -> None:
    """Record what the result's file now contains, for a signal that arrives while the rest of the command runs."""
    _REQUEST.written = words


def _end() -> NoReturn:
    sentence = _REQUEST.written
    if not sentence and os.path.isdir(_REQUEST.folder):
        sentence = f"finished work is kept in {_REQUEST.folder}; continue with --resume"
    with suppress(OSError):
        os.write(2, f"{word()}{f': {sentence}' if sentence else ''}.\n".encode())
    os._exit(status())


@contextmanager
def asking(stop_computation: Callable[[], None] = lambda: None) -> Iterator[Callable[[], bool]]:
    """Let a signal call `stop_computation` in another thread, and give the block some time to end.

    Yield a function that returns whether a signal has arrived. A block inside another one changes nothing.
    """
    with _REQUEST.lock:
        before = _REQUEST.stop_computation
        if before is None:
            _REQUEST.stop_computation = stop_computation
    try:
        yield lambda: _REQUEST.status is not None
    finally:
        with _REQUEST.lock:
            _REQUEST.stop_computation = before


def status() -> int:
    """Return the exit status of a cancelled command."""
    return _REQUEST.status or _STATUS[signal.SIGINT]


def word() -> str:
    """Return the word for the outcome of a cancelled command."""
    return _WORDS[status()]


def leave(done: int) -> int:
    """Return the exit status of a command that has ended; after a signal, end the process here instead.

    Threads may still be waiting for the compiler, and Python would wait for them.
    """
    if _REQUEST.status is None:
        for number in _STATUS:  # a signal that arrives now is too late, and Python would restore the default
            signal.signal(number, signal.SIG_IGN)
        return done
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(_REQUEST.status)
