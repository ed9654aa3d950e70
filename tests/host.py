"""A dashboard's host in tests: what it is asked to call is called when the test says so."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import waiting

from granchain_core import CurvePoint


class Pending:
    """What is to be called, in order: it waits until the test says so. Any thread may add to `callbacks`."""

    def __init__(self) -> None:
        self.callbacks: list[Callable[[], None]] = []

    def call_waiting(self) -> None:
        """Call what waits now; what that asks for waits."""
        waiting, self.callbacks = self.callbacks, []
        for callback in waiting:
            callback()

    def run_callbacks_until(self, until: Callable[[], bool], seconds: float = 20.0) -> None:
        """Call what waits until something holds."""
        waiting.until(until, seconds, self._call_all)

    def _call_all(self) -> None:
        while self.callbacks:
            self.callbacks.pop(0)()
        time.sleep(0.002)


class FakeHost(Pending):
    """A `WorkHost` for tasks and debouncing, and a part of `PageHost` (tests/session/test_host.py)."""

    busy = awaiting_picture = curve_computing = False

    def complete_curve(self) -> list[CurvePoint]:
        return []

    def __init__(self) -> None:
        super().__init__()
        self.failures: list[Exception] = []
        self.faults: list[tuple[Exception, str]] = []
        self.fault_ids: list[str] = []
        #: Computations that could not be finished, with the ids of their sentences.
        self.failed_computations: list[tuple[Exception, str]] = []
        self.closing: list[Callable[[], object]] = []

    def next_tick(self, action: Callable[..., None], *args: Any) -> None:
        """From any thread."""
        self.callbacks.append(lambda: action(*args))

    def call_later(self, seconds: float, action: Callable[..., None], *args: Any) -> None:
        """The time passes when the callbacks are worked off."""
        self.next_tick(action, *args)

    def on_close(self, action: Callable[[], object]) -> None:
        """What is called when the visitor leaves."""
        self.closing.append(action)

    def leave(self) -> None:
        """The visitor leaves."""
        for action in self.closing:
            action()

    def show_failure(self, error: Exception) -> None:
        """What has no place on a page."""
        self.failures.append(error)

    def report_fault(self, error: Exception, sentence: str, fault: str = "") -> None:
        """An error of granchain itself, what is said of it beside the page, and its id."""
        self.faults.append((error, sentence))
        self.fault_ids.append(fault)

    def log_failed_computation(self, error: Exception, fault: str) -> None:
        """Keep a computation that could not be finished."""
        self.failed_computations.append((error, fault))
