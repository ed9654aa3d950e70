"""The page "The paper", without a browser: a figure is computed once, when it is chosen."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from page_host import PageUnderTest

from app.pages.paper import page as module
from granchain_core import BadInput
from granchain_core.paper import FIGURES


@pytest.fixture
def page(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> Any:
    """The page, with figures that are computed and drawn at once; `computed` and `drawn` have their numbers."""
    tested: Any = page_of("paper")
    tested.computed, tested.drawn = [], []

    def compute(number: str, stop: Any, progress: Callable[[float], None]) -> str:
        progress(0.5)
        tested.computed.append(number)
        return f"result {number}"

    monkeypatch.setattr(module, "compute", compute)
    monkeypatch.setattr(tested.view, "draw", lambda figure, result: tested.drawn.append((figure.number, result)))
    return tested


def test_the_page_begins_with_a_figure_and_computes_each_once(page: Any) -> None:
    first, other = "2", next(number for number in FIGURES if number != "2")
    page.set_visible()
    assert [submitted.pool for submitted in page.submitted] == ["long"] and page.state["chosen"] == first
    page.compute()
    assert page.drawn == [(first, f"result {first}")] and (page.state["status"], page.state["done"]) == ("done", 0.5)
    page.do("paper-show", figure=other)
    assert page.state["done"] == 0.0
    page.compute()
    page.do("paper-show", figure=first)
    assert page.under_way == [] and page.state["status"] == "done"
    assert page.computed == [first, other] and page.drawn[-1] == (first, f"result {first}")


def test_another_choice_gives_up_the_figure_before_and_looking_again_chooses_none(page: Any) -> None:
    page.set_visible()
    page.do("paper-show", figure="3")
    page.set_visible(False)
    page.set_visible()
    page.compute()
    assert page.computed == ["3"] and [number for number, _ in page.drawn] == ["3"]


def test_a_stopped_figure_is_computed_anew_when_it_is_chosen(page: Any) -> None:
    page.set_visible()
    page.do("paper-stop")
    assert page.state["progress"] == "stopped" and page.under_way == []
    page.do("paper-show", figure="2")
    page.compute()
    assert page.computed == ["2"]


def test_a_moved_knob_changes_no_figure_of_the_paper(page: Any) -> None:
    page.set_visible()
    page.move_knobs(f=2100.0)
    page.compute()
    assert page.computed == ["2"] and page.state["status"] == "done"


def test_a_figure_that_does_not_exist_is_refused(page: Any) -> None:
    with pytest.raises(BadInput):
        page.do("paper-show", figure="99")
