"""A fake dashboard host, which queues callbacks until the test runs them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import waiting

from granchain_core import CurvePoint


class Pending:
    """A queue of callbacks that the test runs in order. Any thread may add to `callbacks`."""

    def __init__(self) -> None:
        self.callbacks: list[Callable[[], None]] = []

    def call_waiting(self) -> None:
        """Run the callbacks queued so far; those that they add stay in the queue."""
        queued, self.callbacks = self.callbacks, []
        for callback in queued:
            callback()

    def run_callbacks_until(self, until: Callable[[], bool], seconds: float = 60.0) -> None:
        """Run callbacks until a condition is true."""
        waiting.until(until, seconds, self._call_all)

    def _call_all(self) -> None:
        while self.callbacks:
            self.callbacks.pop(0)()
        time.sleep(0.002)


class FakeHost(Pending):
    """A `WorkHost` for tasks and debouncing, and part of a `PageHost` (see tests/session/test_host.py)."""

    busy = awaiting_picture = curve_computing = False

    def complete_curve(self) -> list[CurvePoint]:
        return []

    def __init__(self) -> None:
        super().__init__()
        self.failures: list[Exception] = []
        self.faults: list[tuple[Exception, str]] = []
        self.fault_ids: list[str] = []
        #: Errors of computations that could not be finished, with their fault ids.
        self.failed_computations: list[tuple[Exception, str]] = []
        self.closing: list[Callable[[], object]] = []

    def next_tick(self, action: Callable[..., None], *args: Any) -> None:
        """Queue an action, from any thread."""
        self.callbacks.append(lambda: action(*args))

    def call_later(self, seconds: float, action: Callable[..., None], *args: Any) -> None:
        """Queue an action immediately, whatever the delay: it runs when the test runs the callbacks."""
        self.next_tick(action, *args)

    def on_close(self, action: Callable[[], object]) -> None:
        """Keep an action for `leave`."""
        self.closing.append(action)

    def leave(self) -> None:
        """End the session, as when the visitor leaves."""
        for action in self.closing:
            action()

    def show_failure(self, error: Exception) -> None:
        """Record an error that no page can show."""
        self.failures.append(error)

    def report_fault(self, error: Exception, sentence: str, fault: str = "") -> None:
        """Record a fault of granchain itself, with its message and its fault id."""
        self.faults.append((error, sentence))
        self.fault_ids.append(fault)

    def log_failed_computation(self, error: Exception, fault: str) -> None:
        """Record the error of a computation that could not be finished."""
        self.failed_computations.append((error, fault))
