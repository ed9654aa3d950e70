"""A server that is too busy says so: in the status line, with how often pictures follow."""

from __future__ import annotations

import pytest
from bokeh.document import Document

from app.dashboard.controller import Controller
from app.serve import meters
from app.serve.turns import CpuTime, FairScheduler
from app.session.session import Session
from granchain_core import Stop, settle


def test_the_wait_before_computations_begin_is_averaged_over_ten_seconds() -> None:
    now = [0.0]
    turns = FairScheduler(1, lambda: now[0])
    assert turns.wait == 0.0
    first = turns.begin(CpuTime(), Stop())
    now[0] = 1.0
    turns.end(first)
    turns.begin(CpuTime(), Stop(), begins=False)  # what makes a picture better may wait
    assert turns.wait == 0.0
    turns._waits.append((now[0], 1.5))
    assert turns.wait == 0.75
    now[0] = 10.5
    assert turns.wait == 1.5
    now[0] = 12.0
    assert turns.wait == 0.0


@pytest.mark.parametrize(("late", "wait", "said"), [(0.0, 0.1, False), (0.4, 0.0, True), (0.0, 0.4, True)])
def test_a_busy_server_says_so_with_the_next_picture(late: float, wait: float, said: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meters.METERS, "turn_wait", lambda: wait)
    monkeypatch.setattr(meters.METERS, "_late", [late])
    controller = Controller(Document(), Session())
    try:
        controller.pictures.compute()
        controller.pictures.close()
        controller.pictures._asked -= 1.25  # type: ignore[operator]
        controller.pictures._arrived(settle(controller.session.scene))
        words = controller.views.status_line.state["busy"]
        assert words.startswith("The server is busy: pictures follow every 1.") if said else words == ""
    finally:
        controller.close(None)
