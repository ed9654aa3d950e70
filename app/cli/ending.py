"""Ending a process by Ctrl-C (SIGINT, status 130) or SIGTERM (143): at any time, within three seconds, with a sentence.

Python would raise `KeyboardInterrupt` wherever the main thread happens to be: in an import, in a callback that swallows
it, or only after a compiler has come back. Here a thread waits for the signals instead. While nothing is to be kept it
ends the process at once. Inside `asking` it asks the computation to end and gives it some time to keep what it has.
Processes that were started end with this one by themselves (granchain_core/execution/child_processes.py).

The module is loaded before anything else and imports only what takes no time.
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
#: The word for it by exit status.
_WORDS = {130: "Cancelled", 143: "Terminated"}


class _EndRequest:
    """A request to end this process: the exit status of the first signal, and what to call when it comes.

    `kept` is the folder of what the command has finished so far, if it keeps anything; `written` says in words what is
    in the result's file once that is written.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.status: int | None = None
        self.tell: Callable[[], None] | None = None
        self.kept = ""
        self.written = ""


_REQUEST = _EndRequest()


def begin() -> None:
    """Take over both signals; one that the process was started to ignore stays ignored."""
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
    """Nothing: the number has been written to the pipe before Python calls this."""


def _forget() -> None:
    """A forked process has no such thread: it takes signals as any program does by default."""
    signal.set_wakeup_fd(-1)
    for number in _STATUS:
        if signal.getsignal(number) is _noted:
            signal.signal(number, signal.SIG_DFL)


def _wait(reading: int) -> None:
    """End the process at the first signal, or tell the computation and end at the second or after the grace."""
    while True:
        status = _STATUS.get(os.read(reading, 1)[0])
        if status is None:
            continue
        with _REQUEST.lock:
            _REQUEST.status, stop_computation = status, _REQUEST.tell
            if stop_computation is None:
                _end()
        stop_computation()
        select.select([reading], [], [], _GRACE)
        _end()


def keeps(folder: str) -> None:
    """Name the folder of finished pieces, for the last sentence of a computation that does not end in time."""
    _REQUEST.kept = folder


def wrote(words: str) -> None:
    """Say what the result's file holds now, for a signal that comes while the rest of the command runs."""
    _REQUEST.written = words


def _end() -> NoReturn:
    sentence = _REQUEST.written
    if not sentence and os.path.isdir(_REQUEST.kept):
        sentence = f"what was finished is kept in {_REQUEST.kept}; go on with --resume"
    with suppress(OSError):
        os.write(2, f"{word()}{f': {sentence}' if sentence else ''}.\n".encode())
    os._exit(status())


@contextmanager
def asking(stop_computation: Callable[[], None] = lambda: None) -> Iterator[Callable[[], bool]]:
    """Within this block a signal calls `tell`, in another thread, and the block has some time to end.

    Gives a function that says whether a signal has come. A block inside another one changes nothing.
    """
    with _REQUEST.lock:
        before = _REQUEST.tell
        if before is None:
            _REQUEST.tell = stop_computation
    try:
        yield lambda: _REQUEST.status is not None
    finally:
        with _REQUEST.lock:
            _REQUEST.tell = before


def status() -> int:
    """The exit status of a cancelled command."""
    return _REQUEST.status or _STATUS[signal.SIGINT]


def word() -> str:
    """The outcome of a cancelled command in a word."""
    return _WORDS[status()]


def leave(done: int) -> int:
    """The exit status of a command that has ended; after a signal, end the process here.

    Threads may still wait for a compiler, and Python would wait for them.
    """
    if _REQUEST.status is None:
        for number in _STATUS:  # one that comes now is too late, and Python would go back to the default
            signal.signal(number, signal.SIG_IGN)
        return done
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            stream.flush()
    os._exit(_REQUEST.status)
