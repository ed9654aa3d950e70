"""The axis of time of a live picture: drive periods before now, or milliseconds where nothing drives the chain."""

from __future__ import annotations

import numpy as np
import pytest

from app.dashboard.layout import Views
from app.dashboard.show import show_live
from app.serve.cpu_time import CpuTime
from app.session.live import LiveRun
from app.session.session import Session
from granchain_core import scene


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
