"""The Analysis page, without a browser: automatic computations, and the scene of question and answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.models import Div
from page_host import PageUnderTest, picture

from app.pages.analysis import page as module
from app.pages.analysis.questions import QUESTIONS
from granchain_core import BadInput

FIRST, *_, LAST = QUESTIONS


@pytest.fixture
def page(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> PageUnderTest:
    """The page, with questions that are answered at once."""
    true = module.planned

    def planned(question: Any, scene: Any, values: object) -> Any:
        def compute(stop: Any, progress: Callable[[float], None]) -> Any:
            progress(0.5)
            return SimpleNamespace(summary=lambda: [f"asked at {scene.f:g} Hz"])

        return replace(true(question, scene, values), compute=compute, draw=lambda found, theme: Div(text="drawn"))

    monkeypatch.setattr(module, "planned", planned)
    return page_of("analysis")


def test_the_first_question_is_answered_for_every_picture_until_the_visitor_asks(page: PageUnderTest) -> None:
    page.set_visible()
    assert [submitted.pool for submitted in page.submitted] == ["long"] and page.state["question"] == FIRST
    page.compute()
    assert page.state["words"] == ["asked at 2000 Hz"] and page.state["status"] == "done" and page.state["done"] == 0.5
    assert page.last("figure") and page.host.addresses == 0, "an automatic question is not in the address"
    page.move_knobs(f=2100.0)
    page.deliver_picture(picture(2100.0))
    page.compute()
    assert page.state["words"] == ["asked at 2100 Hz"]
    page.do("analysis-ask", question=LAST)
    page.deliver_picture()
    assert page.under_way == [] and page.state["question"] == LAST


def test_a_hidden_page_answers_nothing_unasked(page: PageUnderTest) -> None:
    page.set_visible()
    page.set_visible(False)
    page.submitted.clear()
    page.deliver_picture()
    assert page.under_way == []


def test_an_answer_stays_with_its_scene_until_it_is_asked_again(page: PageUnderTest) -> None:
    page.do("analysis-ask", question=LAST)
    page.do("analysis-compute", values={})
    page.compute()
    title = page.state["title"]
    assert "2000" in title and page.host.session.question
    page.move_knobs(f=2100.0)
    page.deliver_picture(picture(2100.0))
    page.run_callbacks()
    assert page.state["title"] == title and page.state["words"] == ["asked at 2000 Hz"] and page.under_way == []
    page.do("analysis-ask", question=FIRST)
    assert page.state["title"] == "" and page.last("clear")


def test_a_moved_knob_stops_the_work_and_renews_the_fields(page: PageUnderTest) -> None:
    page.do("analysis-ask", question="strobes")
    page.do("analysis-compute", values={})
    before = {field["name"]: field["value"] for field in page.state["fields"]}
    page.move_knobs(f=2100.0)
    assert page.under_way == [] and page.state["progress"] == "stopped"
    assert {field["name"]: field["value"] for field in page.state["fields"]}["from"] != before["from"]


def test_values_that_cannot_be_are_refused_and_leave_the_answer(page: PageUnderTest) -> None:
    page.do("analysis-ask", question="strobes")
    page.do("analysis-compute", values={})
    page.compute()
    with pytest.raises(BadInput):
        page.do("analysis-compute", values={"values": "none"})
    assert page.state["words"] == ["asked at 2000 Hz"]


def test_a_link_offers_its_question_and_does_not_compute_it(page: PageUnderTest) -> None:
    page.do("analysis-ask", question=LAST)
    page.do("analysis-compute", values={})
    link = page.host.session.question
    page.do("analysis-ask", question=FIRST)
    page.host.session.question = link
    page.page.address_applied()
    page.set_visible()
    assert page.state["question"] == LAST and page.under_way == []


def test_a_chain_for_which_nothing_is_answered_unasked_says_why(page: PageUnderTest) -> None:
    page.host.session.scene = page.host.session.scene.evolve(N=400)
    page.set_visible()
    assert page.under_way == [] and page.state["status"] == "none" and "300" in page.state["failure"]
