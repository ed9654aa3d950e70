"""The Branches page, without a browser: which orbit is continued when, resuming, and showing an orbit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
from page_host import PageUnderTest, picture

from app.pages.branches import page as module
from app.pages.branches.page import NOT_PERIODIC
from granchain_core import BadInput, branch
from granchain_core.orbits import Branch
from granchain_core.results.regime import Regime


@cache
def found() -> Branch:
    """Return a short, complete branch of the picture's chain."""
    return branch(picture().run.scene, "f", 2000.0, 2020.0)


@pytest.fixture
def page(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> Any:
    """The page, on which branches are complete at once; `began` has the starting scene and axis of each."""
    tested: Any = page_of("branches")
    tested.began = []

    def begin(scene: Any, *axis: Any, both: bool, stop: Any) -> Branch:
        tested.began.append((scene, *axis))
        return found()

    monkeypatch.setattr(module, "begin_branch", begin)
    return tested


def test_the_orbit_on_the_screen_is_followed_when_the_page_is_opened_first(page: Any) -> None:
    page.do("branches-open")
    assert [submitted.pool for submitted in page.submitted] == ["long"] and page.state["status"] == "waiting"
    page.compute()
    ((scene, knob, low, high, period, seed),) = page.began
    assert (scene, knob, period) == (picture().run.scene, "f", 1) and low < scene.f < high and seed is picture().state
    assert page.state["status"] == "done" and page.state["words"].startswith(f"{len(found().points)} orbits, ")
    assert page.state["ended"] and not page.state["unfinished"]
    page.do("branches-open")
    assert page.under_way == [], "it is followed once"


def test_a_page_that_is_opened_early_waits_for_the_final_picture(page: Any) -> None:
    page.host.session.settled = None
    page.do("branches-open")
    assert page.under_way == []
    page.deliver_picture(replace(picture(), final=False))
    assert page.under_way == []
    page.deliver_picture()
    assert len(page.under_way) == 1


def test_a_motion_without_period_is_followed_only_with_a_chosen_one(page: Any) -> None:
    page.host.session.settled = replace(picture(), regime=Regime("chaotic", None, None, None, 620, (0.265, 0.023)))
    page.do("branches-open")
    assert page.state["words"] == NOT_PERIODIC and page.under_way == []
    page.do("branches-start", period=3)
    page.compute()
    assert page.began[0][-2:] == (3, None)


def test_f_marks_the_branch_and_another_knob_makes_it_stale(page: Any) -> None:
    page.do("branches-open")
    page.compute()
    page.move_knobs(f=2010.0)
    assert (page.state["now"], page.state["stale"]) == (2010.0, False)
    page.move_knobs(kappa=0.2)
    assert page.state["stale"]
    page.move_knobs(kappa=picture().run.scene.kappa)
    assert not page.state["stale"]


def test_a_branch_that_was_stopped_goes_on(page: Any) -> None:
    page.do("branches-open")
    page.do("branches-stop")
    assert page.state["progress"] == "stopped; the orbits found so far are kept" and page.under_way == []
    page.do("branches-continue")
    assert page.under_way == [], "nothing has been followed yet"
    page.do("branches-start")
    page.compute()
    page.do("branches-continue")
    page.compute()
    assert len(page.began) == 1 and page.state["status"] == "done"


def test_an_orbit_is_shown_settled_where_it_is_stable(page: Any) -> None:
    page.do("branches-open")
    page.compute()
    page.do("branches-orbit", arm=0, place=0)
    ((scene, state, mode),) = page.host.shown
    assert mode == "settled" and state is not None and 2000.0 <= scene.f <= 2020.0
    with pytest.raises(BadInput, match="no longer on the page"):
        page.do("branches-orbit", arm=0, place=10_000)


def test_the_curve_stands_behind_the_branches_of_its_chain(page: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = {"curve": {"x": [1.0]}}
    monkeypatch.setattr(module.BranchRows, "curve", lambda self, curve: {"rows": rows} if curve else None)
    page.page.curve_ready()
    assert page.sent == [], "the page was not opened"
    page.do("branches-open")
    monkeypatch.setattr(page.host, "complete_curve", lambda: ["points"])
    page.page.curve_ready()
    assert page.last("add")["rows"] == rows
    page.move_knobs(kappa=0.2)
    before = len(page.sent)
    page.page.curve_ready()
    assert len(page.sent) == before, "it is the curve of another chain"
