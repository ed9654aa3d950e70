"""A growing curve is drawn at intervals, not with each new point."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from app.curve.computation import Progress
from app.curve.controller import CurveController
from app.curve.curve_bar import CurveBar
from app.curve.reports import CURVE_EVERY
from app.curve.request import CurveRequest
from app.curve.view import CurveFigure
from app.session.session import Session
from granchain_core import CurvePoint, scene
from granchain_core.results.forces import ForceErrors
from granchain_core.results.regime import Regime
from granchain_core.scene.state import rest
from tests.host import FakeHost


class Host(FakeHost):
    """A host that keeps delayed calls."""

    def __init__(self) -> None:
        super().__init__()
        self.session = Session()
        self.later: list[tuple[float, Callable[[], None]]] = []

    def call_later(self, seconds: float, action: Callable[..., None], *args: object) -> None:
        """Keep the action until the test lets the time pass."""
        self.later.append((seconds, lambda: action(*args)))


def point(f: float) -> Progress:
    """Return one more point of a curve from rest."""
    found = CurvePoint(f, 1.0, 1.0, 1.0, Regime("periodic", 1, None, None, 9), ForceErrors(), rest(scene("sec2")))
    return Progress("rest", [found], 0.5)


def test_points_that_come_soon_after_each_other_are_drawn_together(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("app.curve.reports.time.monotonic", lambda: now[0])
    host, figure = Host(), CurveFigure(lambda _: None)
    curves = CurveController(host, figure, CurveBar(lambda _: None), lambda: None)  # type: ignore[arg-type]
    for f in (500.0, 600.0, 700.0):
        curves._reports.add(point(f))
        host.call_waiting()
    assert len(figure.points("rest")) == 1
    (seconds, draw), = host.later
    assert seconds == pytest.approx(CURVE_EVERY)
    now[0] += seconds
    draw()
    assert len(figure.points("rest")) == 3


def test_a_stopped_curve_is_not_under_way_again_when_its_last_points_would_be_drawn(
        monkeypatch: pytest.MonkeyPatch) -> None:
    """A page that covers the curve stops it. Otherwise, a map that waits for the curve to end would wait forever."""
    now = [100.0]
    monkeypatch.setattr("app.curve.reports.time.monotonic", lambda: now[0])
    host = Host()
    curves = CurveController(host, CurveFigure(lambda _: None), CurveBar(lambda _: None), lambda: None)  # type: ignore[arg-type]
    curves._request = CurveRequest.of(scene("sec2"), ["rest"])
    for f in (500.0, 600.0):
        curves._reports.add(point(f))
        host.call_waiting()
    assert curves.computing and len(host.later) == 1  # the second waits to be drawn
    curves.stop()
    now[0] += CURVE_EVERY
    host.later[0][1]()
    assert not curves.computing
