"""The Accuracy page, without a browser: when it measures, and the chain and accuracy of its rows."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from page_host import PageUnderTest, picture

from app.pages.accuracy import page as module
from app.plots.accuracy import points
from granchain_core.accuracy import Row

ROWS = [Row("rk4", "100 steps", 1e-3, 1e-4, 400, 100.0), Row("dop853", "1e-9", 2e-8, 3e-4, 900, 1e-9)]


@pytest.fixture
def page(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> PageUnderTest:
    """The page, with a measurement that delivers its rows at once."""
    def measure(scene: Any, stop: Any, *, report: Any, pause: Any, progress: Any) -> None:
        pause()
        progress(0.5)
        report(SimpleNamespace(rows=ROWS, lesson=None, agreement=1e-9))

    monkeypatch.setattr(module, "work_precision", measure)
    monkeypatch.setattr(module, "described_reference", lambda found: {"reference": "dop853"})
    return page_of("accuracy")


def test_measuring_begins_when_the_page_is_first_opened_and_continues_hidden(page: PageUnderTest) -> None:
    page.move_knobs(f=2000.0)
    assert page.sent == [], "until it is opened, there is nothing to see"
    page.set_visible()
    assert [submitted.pool for submitted in page.submitted] == ["measurements"] and page.state["status"] == "waiting"
    page.set_visible(False)
    assert len(page.under_way) == 1
    page.compute()
    assert page.state["status"] == "done" and page.state["done"] == 0.5 and page.state["reference"] == "dop853"
    page.set_visible()
    assert page.under_way == [] and page.page.activity == ("accuracy of all methods", "ready", "2 settings measured")


def test_the_cheapest_setting_follows_the_accuracy_that_is_asked_for(page: PageUnderTest) -> None:
    page.set_visible()
    page.compute()
    page.move_knobs(accuracy=1e-2)
    assert page.last("asked")["sentence"].startswith("The cheapest way to 1e-2 is rk4, 100 steps")
    page.move_knobs(accuracy=1e-7)
    assert "is dop853, 1e-9" in page.last("asked")["sentence"] and not page.last("asked")["stale"]
    page.move_knobs(accuracy=1e-9)
    assert page.last("asked")["sentence"] == "Nothing measured here reaches 1e-9; the nearest is dop853, 1e-9."


def test_rows_of_another_chain_are_stale_until_it_is_measured(page: PageUnderTest) -> None:
    page.set_visible()
    page.compute()
    page.move_knobs(f=2100.0)
    assert page.last("asked")["stale"]
    page.do("accuracy-measure")
    assert not page.last("asked")["stale"] and page.state["done"] == 0.0
    page.move_knobs(f=picture().run.scene.f)
    assert page.last("asked")["stale"]


def test_a_stopped_measurement_keeps_its_rows(page: PageUnderTest, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(scene: Any, stop: Any, *, report: Any, **_: Any) -> None:
        report(SimpleNamespace(rows=ROWS[:1], lesson=None, agreement=1e-9))
        page.run_callbacks()
        page.do("accuracy-stop")
        assert stop
        report(SimpleNamespace(rows=ROWS, lesson=None, agreement=1e-9))

    monkeypatch.setattr(module, "work_precision", stopped)
    page.set_visible()
    page.compute()
    assert page.state["progress"] == "stopped; the measurements so far are kept"
    assert page.state["drawn"] == points(ROWS[:1]) and page.activity[2] == "1 settings measured"
    page.set_visible()
    assert page.under_way == [], "a stopped measurement is not repeated automatically"
