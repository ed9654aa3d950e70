"""A dashboard without a browser, and a fixture that closes it after the test, whether or not the test passes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest
from bokeh.document import Document
from host import Pending

from app.dashboard.calls import Calls
from app.dashboard.controller import Controller
from app.session.session import Session


class WaitingCalls(Calls):
    """Calls for the next iteration of an event loop, held until the test runs them."""

    def __init__(self, document: Document, failed: Callable[[Exception], None]) -> None:
        super().__init__(document, failed)
        self.pending = Pending()

    def next_tick(self, action: Callable[..., None], *arguments: object) -> None:
        """Hold the action; may be called from any thread."""
        self.pending.callbacks.append(partial(self.call_and_report, action, *arguments))


class Dashboard(Controller):
    """A dashboard whose callbacks run when the test says so, and whose messages to the browser are recorded."""

    _calls: WaitingCalls

    def __init__(self) -> None:
        super().__init__(Document(), Session(), make_calls=WaitingCalls)
        self.sent: list[dict[str, Any]] = []
        self.views.header.send = lambda **message: self.sent.append(message)  # type: ignore[method-assign]

    @property
    def callbacks(self) -> list[Callable[[], None]]:
        """The callbacks waiting to be run."""
        return self._calls.pending.callbacks

    def run_callbacks_until(self, until: Callable[[], bool], seconds: float = 20.0) -> None:
        """Run waiting callbacks until a condition is true."""
        self._calls.pending.run_callbacks_until(until, seconds)


@pytest.fixture
def dashboard() -> Iterator[Dashboard]:
    """Yield a dashboard for this test alone."""
    opened = Dashboard()
    yield opened
    opened.close()
