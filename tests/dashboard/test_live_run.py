"""Live runs: the thread that creates them, and the time axis of their pictures."""

from __future__ import annotations

import threading
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from headless_dashboard import Dashboard

from app.dashboard.layout import Views
from app.dashboard.show import show_live
from app.serve.computing.cpu_time import CpuTime
from app.session import live as live_module
from app.session.live import LiveRun
from app.session.session import Session
from granchain_core import scene
from granchain_core.scene.state import rest


@pytest.mark.parametrize(("name", "title", "earliest"), [("sec2", "time before now (drive periods)", -4.0),
                                                         ("impact", "time before now (ms)", -16.0)])
def test_the_time_of_a_live_picture(name: str, title: str, earliest: float) -> None:
    views = Views(Session(scene(name)), lambda _: None, lambda _: None)
    live = LiveRun(scene(name).evolve(N=2), CpuTime())
    show_live(views, 1, live.advance(2 * live.samples), running=True)
    assert views.trains.left.yaxis[0].axis_label == title
    assert (views.time.start, views.time.end) == (0.0, pytest.approx(earliest))
    drawn = np.asarray(views.trains._source.data["time"])
    assert drawn[-1] == 0.0 and drawn[0] >= earliest


def test_a_live_run_is_made_in_a_thread(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """Creating a chain calls kernels, whose compilation on the event loop would delay everybody."""
    threads: list[str] = []

    def noting(*words: Any, _is: Any, **named: Any) -> Any:
        threads.append(threading.current_thread().name.split()[0])
        return _is(*words, **named)

    for name in ("LiveChain", "at_phase_0"):
        monkeypatch.setattr(live_module, name, partial(noting, _is=getattr(live_module, name)))
    session, pictures = dashboard.session, dashboard.pictures
    session.set_mode("live")
    session.playing = False
    pictures.begin_live(replace(rest(session.scene), phase=0.5))
    assert threads == []
    pictures.advance(7)
    dashboard.run_callbacks_until(lambda: pictures.shown_run() is not None)
    assert threads == ["session_work", "session_work"]


def test_two_pictures_are_in_transit_from_the_first_step_on(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """After a knob is moved, there are as many as before: the next one starts when one has been painted."""
    sent: list[int] = []
    monkeypatch.setattr(dashboard.views.chain, "send", lambda **message: sent.append(message["number"]))

    def quiet() -> bool:
        return not (dashboard.pictures.busy or dashboard.callbacks)

    def in_transit(painted: int) -> int:
        dashboard.run_callbacks_until(lambda: quiet() and len(sent) > painted)
        return len(sent) - painted

    dashboard.receive({"do": "mode", "value": "live"})
    assert in_transit(0) == 2
    for painted in range(1, 4):
        dashboard.receive({"do": "painted", "number": painted})
        assert in_transit(painted) == 2
    dashboard.receive({"do": "set", "name": "f", "value": 400.0})
    assert in_transit(3) == 2
    dashboard.receive({"do": "painted", "number": 4})
    assert in_transit(4) == 2
