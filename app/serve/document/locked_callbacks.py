"""Callbacks with a document locked: all waiting callbacks run together.

Bokeh creates, wraps, stores, announces and removes its callbacks one by one, which takes longer than most actions.
"""

from __future__ import annotations

import asyncio
import threading
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

from bokeh.document import Document
from tornado.ioloop import IOLoop
from tornado.locks import Lock

try:
    from panel.io.state import set_curdoc
except ImportError:  # it is not in Panel's documentation
    set_curdoc = None  # type: ignore[assignment]

from ...library_internals import Internal, internals
from ..monitoring.faults import log_fault, new_fault_id
from .changes import batched_changes

_WITHOUT = "Bokeh calls each action separately, some milliseconds later"
#: The undocumented parts of Bokeh and Panel that are used here.
INTERNALS = internals(
    __name__,
    Internal("bokeh.server.session.ServerSession", ("_lock", "_pending_writes"), _WITHOUT),
    Internal("panel.io.state", ("set_curdoc",), _WITHOUT),
)

#: Bokeh's unfinished writes. This set keeps the tasks alive, as the loop has only weak references.
_FINISHING: set[asyncio.Future[None]] = set()


def can_lock(session: Any) -> bool:
    """Return whether `run_locked` can lock this session."""
    lockable = set_curdoc is not None and isinstance(getattr(session, "_lock", None), Lock)
    return lockable and hasattr(session, "_pending_writes")


def session_of(document: Document) -> Any:
    """Return Bokeh's session of a page; None if there is none that `run_locked` can lock."""
    session = getattr(getattr(document, "session_context", None), "session", None)
    return session if can_lock(session) else None


def run_locked(session: Any, actions: list[Callable[[], None]]) -> None:
    """Run the actions as soon as the session's document can be locked: at once if its lock is free."""
    lock: Any = session._lock.acquire()
    if lock.done():
        _with_lock(session, actions, lock)
    else:
        lock.add_done_callback(partial(_with_lock, session, actions))


def _with_lock(session: Any, actions: list[Callable[[], None]], lock: Any) -> None:
    release = lock.result()
    pending: list[Any] = []
    try:
        if not session.destroyed:
            pending = _act(session, actions)
    finally:
        if pending:
            task = asyncio.ensure_future(_finish(pending, release))
            _FINISHING.add(task)
            task.add_done_callback(_FINISHING.discard)
        else:
            with release:
                pass


def _act(session: Any, actions: list[Callable[[], None]]) -> list[Any]:
    """Run actions with the lock held; return the writes that Bokeh has to finish."""
    session._pending_writes = []
    try:
        with set_curdoc(session.document), batched_changes(session.document):
            for action in actions:
                try:
                    action()
                except Exception as error:
                    log_fault(error, new_fault_id(), "an action failed")
    finally:
        pending, session._pending_writes = session._pending_writes, None
    return list(pending)


async def _finish(pending: list[Any], release: Any) -> None:
    with release:
        for write in pending:
            await write


class LockedCallbacks:
    """Calls actions with a document locked, instead of Bokeh's `add_next_tick_callback` and `add_timeout_callback`.

    Bokeh calls the actions itself if `run_locked` cannot lock the sessions of the installed release.
    """

    def __init__(self, document: Document) -> None:
        self._document = document
        self._loop = IOLoop.current(instance=False)
        self._lock = threading.Lock()
        self._waiting: deque[Callable[[], None]] = deque()
        self._due = self._closed = False
        self._served = session_of(document) is not None
        self._timers: set[asyncio.TimerHandle] = set()

    def close(self) -> None:
        """Call no further action and forget the waiting ones, because the session has ended."""
        with self._lock:
            self._closed = True
            self._waiting.clear()
        for timer in self._timers:
            timer.cancel()
        self._timers.clear()

    def next_tick(self, action: Callable[[], None]) -> None:
        """Call `action` in the next iteration of the event loop; called from any thread."""
        self._note_session()
        if self._closed or self._is_destroyed():
            return
        if self._loop is None or not self._served:
            self._document.add_next_tick_callback(action)
            return
        with self._lock:
            if self._closed:
                return
            self._waiting.append(action)
            due, self._due = self._due, True
        if not due:
            self._loop.asyncio_loop.call_soon_threadsafe(self._run)  # type: ignore[attr-defined]

    def call_later(self, seconds: float, action: Callable[[], None]) -> None:
        """Call `action` after `seconds`; called on the event loop."""
        self._note_session()
        if self._closed or self._is_destroyed():
            return
        if self._loop is None or not self._served:
            self._document.add_timeout_callback(action, round(1e3 * seconds))
            return

        def fire() -> None:
            self._timers.discard(timer)
            self.next_tick(action)

        timer: asyncio.TimerHandle = self._loop.asyncio_loop.call_later(seconds, fire)  # type: ignore[attr-defined]
        self._timers.add(timer)

    def _note_session(self) -> None:
        """Note whether the document has a session; it has none while the page is being made."""
        self._served = self._served or session_of(self._document) is not None

    def _is_destroyed(self) -> bool:
        """Return whether Bokeh has destroyed the document, which it does before it calls `on_session_destroyed`."""
        return self._served and session_of(self._document) is None

    def _run(self) -> None:
        with self._lock:
            actions, self._due = list(self._waiting), False
            self._waiting.clear()
        session = session_of(self._document)
        if session is not None:
            run_locked(session, actions)
