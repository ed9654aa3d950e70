"""A chain whose curve would take too long has none: the previous chain's curve is removed, and the bar says why."""

from __future__ import annotations

from app.curve.controller import CurveController
from app.curve.curve_bar import CurveBar
from app.curve.view import CurveFigure
from app.session.budget import curve_affordable
from app.session.session import Session
from granchain_core import CurvePoint, Scene, scene
from granchain_core.results.forces import ForceErrors
from granchain_core.results.regime import Regime
from granchain_core.scene.state import rest
from tests.host import FakeHost


class Host(FakeHost):
    """A host with the default session."""

    session = Session()


def complete(figure: CurveFigure, chain: Scene) -> None:
    """Draw a chain's complete curve of three points."""
    regime = Regime("periodic", 1, None, None, 9)
    figure.add("rest", [CurvePoint(f, 1.0, 1.0, 1.0, regime, ForceErrors(), rest(chain)) for f in (40.0, 60.0, 80.0)], True)
    figure.note_complete("rest")


def test_a_curve_does_not_stay_beside_the_picture_of_a_chain_that_has_none() -> None:
    before, after = scene("fig12-60"), scene("fig12-60").evolve(kappa=50.0)
    assert curve_affordable(before) and not curve_affordable(after)
    host, figure, bar, placed = Host(), CurveFigure(lambda _: None), CurveBar(lambda _: None), []
    curves = CurveController(host, figure, bar, lambda: placed.append(figure.rest_complete))  # type: ignore[arg-type]
    curves.show_preset(before, "auto")
    complete(figure, before)
    assert not bar.state["too_long"]
    curves.knob_moved(after)
    host.callbacks.pop()()  # the knobs rest
    assert figure.points("rest") == []
    assert placed == [False]  # the status line no longer refers to a place on it
    assert bar.state["too_long"] and bar.state["driven"]
