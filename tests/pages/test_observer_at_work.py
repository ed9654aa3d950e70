"""The Observer page, without a browser: each period shown requests the next one, with the chain's current knobs."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from page_host import PageUnderTest, picture

from app.pages.observer import page as module


class Run:
    """A stand-in for the two chains; `done` records the requests to them."""

    def __init__(self, scene: Any, picture: Any, stop: Any, went_on: Any) -> None:
        self.scene, self.went_on = scene, went_on
        self.orbit: Any = None
        self.predicted: float | None = None
        self.measured: float | None = None
        self.failure, self.since, self.in_step, self.sentence = "", 0, False, "It follows its chain."
        self.pair = SimpleNamespace(engine=SimpleNamespace(stop=stop))
        self.done: list[str] = []

    def predict(self, picture: Any) -> None:
        """Record the orbit and a prediction."""
        self.orbit, self.predicted = picture, 0.5
        self.done.append("predict")

    def nudge(self) -> None:
        """Record the request."""
        self.done.append("nudge")

    def from_rest(self) -> None:
        """Record the request."""
        self.done.append("rest")

    def step(self) -> str:
        """Record a period."""
        self.done.append("step")
        return "step"


@pytest.fixture
def page(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> Any:
    """The page, with drive periods that take no time; `steps` collects the messages sent to the view."""
    monkeypatch.setattr(module, "ObserverRun", Run)
    tested: Any = page_of("observer")
    tested.steps = []
    monkeypatch.setattr(tested.view, "step", lambda *step: tested.steps.append(step))
    return tested


def run(page: Any) -> Run:
    """Return the run of the page."""
    return page.page._run


def test_each_period_is_asked_for_and_none_is_computed_unasked(page: Any) -> None:
    page.set_visible()
    page.deliver_picture()
    assert page.under_way == []
    page.do("observer-more")
    assert [submitted.pool for submitted in page.submitted] == ["pictures"]
    page.compute()
    assert run(page).done == ["predict", "step"] and page.state["sentence"] == "It follows its chain."
    assert page.under_way == []


def test_requests_during_a_period_are_done_in_one_further_period(page: Any) -> None:
    page.do("observer-more")
    page.do("observer-nudge")
    page.do("observer-rest")
    assert len(page.submitted) == 1
    page.compute()
    page.compute()
    assert run(page).done == ["predict", "step", "nudge", "rest", "step"] and page.under_way == []
    assert [step[2] for step in page.steps] == [True, True]


def test_a_turned_knob_goes_on_with_the_states_of_the_chain_before(page: Any) -> None:
    page.do("observer-more")
    page.compute()
    before = run(page)
    page.move_knobs(kappa=0.2)
    assert (page.state["kappa"], page.state["sentence"]) == (0.2, "")
    page.do("observer-more")
    page.compute()
    assert run(page).went_on is before and run(page).done == ["step"], "the old picture's orbit is another chain's"
    page.do("observer-again")
    page.compute()
    assert run(page).went_on is None


def test_chains_in_step_rest_until_something_begins(page: Any) -> None:
    page.do("observer-more")
    page.compute()
    run(page).in_step = True
    page.do("observer-more")
    page.compute()
    assert run(page).done == ["predict", "step"]
    page.do("observer-nudge")
    page.compute()
    assert run(page).done == ["predict", "step", "nudge", "step"]


def test_a_final_picture_that_does_not_repeat_predicts_nothing(page: Any) -> None:
    page.host.session.settled = None
    page.do("observer-more")
    page.compute()
    assert run(page).done == ["step"] and page.state["predicted"] is None
    page.deliver_picture(picture())
    page.do("observer-more")
    page.compute()
    assert run(page).done == ["step", "predict", "step"], "as soon as a picture repeats"
