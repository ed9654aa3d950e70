"""Calls with the document of one session locked, until the session ends."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from bokeh.document import Document

from ..serve.document.changes import batched_changes
from ..serve.document.document_lock import run_when_locked
from ..serve.document.locked_callbacks import LockedCallbacks
from ..serve.document.part_messages import call_with
from ..serve.monitoring.faults import log_fault, new_fault_id


class Calls:
    """Calls actions with the document locked. The changes of an action leave as one message; errors go to `failed`."""

    def __init__(self, document: Document, failed: Callable[[Exception], None]) -> None:
        self._document = document
        self._failed = failed
        self._callbacks = LockedCallbacks(document)
        call_with(document, self.call_and_report)
        self._closing: list[Callable[[], object]] = []
        self._closed = False

    def run_when_locked(self, action: Callable[..., None], *args: object) -> None:
        """Call `action` now if Bokeh holds the document's lock, otherwise as soon as it does; called on the event loop.

        A call before the page is ready waits for that (`run_when_locked`).
        """
        run_when_locked(self._document, partial(self.call_and_report, action, *args))

    def next_tick(self, action: Callable[..., None], *args: object) -> None:
        """Call `action` in the next iteration of the event loop; called from any thread."""
        if not self._closed:
            self._callbacks.next_tick(partial(self.call_and_report, action, *args))

    def call_later(self, seconds: float, action: Callable[..., None], *args: object) -> None:
        """Call `action` after `seconds`; called on the event loop."""
        if not self._closed:
            self._callbacks.call_later(seconds, partial(self.call_and_report, action, *args))

    def call_and_report(self, action: Callable[..., None], *args: object) -> None:
        """Call `action` now, with the document locked by the caller, and pass its error to `failed`."""
        if self._closed:
            return
        with batched_changes(self._document):  # does nothing inside `run_locked`, which already gathers changes
            try:
                action(*args)
            except Exception as error:
                self._failed(error)

    def on_close(self, action: Callable[[], object]) -> None:
        """Call `action` when the session ends."""
        self._closing.append(action)

    def close(self) -> None:
        """Call the actions of `on_close` and none afterwards, because the session has ended.

        A failing action does not prevent the next from being called.
        """
        if self._closed:
            return
        self._closed = True
        self._callbacks.close()
        for action in self._closing:
            try:
                action()
            except Exception as error:
                log_fault(error, new_fault_id(), "cleanup of a closed session failed")
        self._closing.clear()
