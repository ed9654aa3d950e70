"""A dashboard without a browser, for the tests of this folder; the fixture `dashboard` of conftest.py closes it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bokeh.document import Document
from host import FakeHost

from app.dashboard.controller import Controller
from app.session.session import Session


class Dashboard(FakeHost, Controller):
    """A dashboard whose callbacks are called when the test says so, and whose messages to the browser are kept."""

    busy, awaiting_picture, curve_computing = Controller.busy, Controller.awaiting_picture, Controller.curve_computing
    call_later, failed, complete_curve = Controller.call_later, Controller.failed, Controller.complete_curve
    on_close, report_fault = Controller.on_close, Controller.report_fault

    def __init__(self) -> None:
        FakeHost.__init__(self)
        self.told: list[dict[str, Any]] = []
        Controller.__init__(self, Document(), Session())
        self.views.header.send = lambda **message: self.told.append(message)  # type: ignore[method-assign]

    def next_tick(self, action: Callable[..., None], *arguments: Any) -> None:
        """From any thread."""
        self.callbacks.append(lambda: self._calls.guarded(action, *arguments))
