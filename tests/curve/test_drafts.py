"""Drafts of the resonance curve: a late draft is not drawn into a figure that now shows something else."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

import pytest

from app.curve.computation import Progress
from app.curve.controller import CurveController
from app.curve.curve_bar import CurveBar
from app.curve.view import CurveFigure
from app.serve.computing.cpu_time import CpuTime
from app.serve.computing.latest_wins import LatestWins
from app.serve.computing.turns import TurnFlag
from app.session.budget import curve_affordable
from app.session.session import Session
from granchain_core import Cancelled, CurvePoint, Scene, scene
from granchain_core.results.forces import ForceErrors
from granchain_core.results.regime import Regime
from granchain_core.scene.state import rest
from tests.host import FakeHost
from tests.waiting import until


class Host(FakeHost):
    """A host that keeps delayed actions separate from those of the next tick."""

    def __init__(self) -> None:
        super().__init__()
        self.session = Session()
        self.later: list[Callable[[], None]] = []

    def call_later(self, seconds: float, action: Callable[..., None], *args: object) -> None:
        """Keep the action until `rest_knobs`."""
        self.later.append(lambda: action(*args))

    def rest_knobs(self) -> None:
        """Run every delayed action, as if its delay had passed."""
        later, self.later = self.later, []
        for action in later:
            action()


def points(chain: Scene, force: float) -> list[CurvePoint]:
    """Return three points of a curve, all with this force."""
    regime = Regime("periodic", 1, None, None, 9)
    return [CurvePoint(f, force, force, 1.0, regime, ForceErrors(), rest(chain)) for f in (40.0, 60.0, 80.0)]


class Page:
    """A resonance curve and its controller; `drafted` has the drafts that have not been delivered."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.drafted: list[Callable[[TurnFlag], Iterator[object]]] = []
        self.chain = scene("fig12-60")
        monkeypatch.setattr("app.curve.drafts.draft_curve", lambda chain, *_: points(chain, 2.0))
        monkeypatch.setattr(LatestWins, "submit", lambda _, work: self.drafted.append(work))
        monkeypatch.setattr("app.curve.controller.COMPILER.has", lambda *_: True)
        self.host, self.figure = Host(), CurveFigure(lambda _: None)
        self.curves = CurveController(self.host, self.figure, CurveBar(lambda _: None), lambda: None)  # type: ignore[arg-type]
        self.begun: list[object] = []
        monkeypatch.setattr(self.curves._task, "start", self.begun.append)
        self.curves.show_preset(self.chain, "auto")
        self.host.rest_knobs()

    def deliver(self) -> None:
        """Draw the drafts, as if their computation had just ended."""
        for work in self.drafted:
            for drafted in work(TurnFlag(CpuTime())):
                self.curves._drafts._draw(drafted)  # type: ignore[arg-type]

    @property
    def forces(self) -> set[float]:
        """Return the forces of the points drawn: 1 N for a curve, 2 N for a draft."""
        return {point.max_output_force for point in self.figure.points("rest")}


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Page:
    """A page whose knob D was moved and whose draft is being computed."""
    made = Page(monkeypatch)
    made.curves.knob_moved(made.chain.evolve(D=50.0))
    assert len(made.drafted) == 1
    return made


def test_a_draft_is_drawn_while_the_knobs_move(page: Page) -> None:
    page.deliver()
    assert page.forces == {2.0}


def test_no_draft_is_drawn_beside_a_chain_whose_curve_would_take_too_long(page: Page) -> None:
    long = page.chain.evolve(kappa=50.0)
    assert not curve_affordable(long)
    page.curves.knob_moved(long)
    page.host.rest_knobs()
    page.deliver()
    assert page.forces == set()


def test_no_draft_is_drawn_into_the_figure_of_another_preset(page: Page) -> None:
    page.curves.show_preset(scene("sec2"), "auto")
    page.deliver()
    assert page.forces == set()


def test_no_draft_is_drawn_after_stop(page: Page) -> None:
    page.curves.stop()
    page.deliver()
    assert page.forces == set()


def test_no_draft_is_drawn_once_the_figure_is_off_the_screen(page: Page) -> None:
    page.curves.visibility_changed(False)
    page.deliver()
    assert page.forces == set()


def test_no_draft_is_drawn_once_the_curve_is_begun(page: Page) -> None:
    page.host.rest_knobs()
    page.deliver()
    assert page.begun and page.forces == set()


def test_a_curve_that_a_draft_has_replaced_is_computed_again_for_the_same_knobs(page: Page) -> None:
    """A knob is moved and returned before it has come to rest: the draft must not remain as the complete curve."""
    page.curves.knob_moved(page.chain)
    page.host.rest_knobs()
    page.curves._draw([Progress("rest", points(page.chain, 1.0), 1.0, True, True)])
    assert page.curves.complete(page.chain)
    page.drafted.clear()
    page.begun.clear()
    page.curves.knob_moved(page.chain.evolve(D=50.0))
    page.deliver()
    assert page.curves.complete(page.chain) == {}
    page.curves.knob_moved(page.chain)
    page.host.rest_knobs()
    assert len(page.begun) == 1


def test_a_cancelled_computation_ends_and_the_next_one_is_computed() -> None:
    begun, delivered, came = threading.Event(), [], threading.Event()

    def cancelled(stop: TurnFlag) -> Iterator[object]:
        begun.set()
        until(lambda: bool(stop))
        raise Cancelled
        yield

    def deliver(result: object) -> None:
        delivered.append(result)
        came.set()

    jobs = LatestWins(deliver, lambda error: pytest.fail(str(error)))
    jobs.submit(cancelled)
    assert begun.wait(20.0)
    jobs.submit(lambda _: iter(["it waited"]))
    jobs.cancel()
    jobs.submit(lambda _: iter(["next"]))
    assert came.wait(20.0)
    assert delivered == ["next"]
