"""The page "Hard cases", without a browser: the order of the cases, stopping, and a process that ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from page_host import PageUnderTest

from app.pages.hard_cases import page as module
from app.pages.hard_cases.work import Ended
from granchain_core import BadInput
from granchain_core.hard_cases import CASES, Case, Check, Measurement, Picture, Trace, run_case

FIRST, SECOND = CASES[:2]


class Process:
    """A stand-in for the process: every case has one row and a picture at once."""

    closed = 0
    gone = False

    def measure(self, case: Case, stop: Any) -> Iterator[list[Check] | Picture | None]:
        """Yield the rows, then the picture."""
        if Process.gone:
            raise Ended
        yield run_case(Case(case.name, "h", "n", "o", lambda _: [Measurement("moment", 5e-11, 1e-9)]), quick=True)
        line = np.linspace(0.0, 1.0, 3)
        yield Picture(line, "time (s)", "force (N)", (Trace("granchain", line),))

    def close(self) -> None:
        """Count the call."""
        Process.closed += 1


@pytest.fixture
def page(page_of: Callable[[str], PageUnderTest], monkeypatch: pytest.MonkeyPatch) -> PageUnderTest:
    """The page, with cases that take no time."""
    monkeypatch.setattr(module, "CaseProcess", Process)
    monkeypatch.setattr(Process, "closed", 0)
    return page_of("hard-cases")


def status(page: PageUnderTest) -> list[str]:
    """Return the status on each card, in the order of the cases."""
    return [page.state["results"][case.name]["status"] for case in CASES if case.name in page.state["results"]]


def test_cases_run_one_after_the_other(page: PageUnderTest) -> None:
    page.do("hard-cases-run", case=SECOND.name)
    page.do("hard-cases-run", case=FIRST.name)
    page.do("hard-cases-run", case=SECOND.name)
    assert len(page.under_way) == 1 and status(page) == ["waiting", "waiting"] and page.state["done"] == 0.0
    assert page.page.activity == ("hard cases", "computing", SECOND.name)
    page.compute()
    assert status(page) == ["waiting", "done"] and page.state["done"] == 0.5 and Process.closed == 0
    assert page.last("figure")["place"] == SECOND.name
    page.compute()
    assert status(page) == ["done", "done"] and not page.state["running"]
    assert Process.closed == 1, "the process ends with the last case"
    assert page.state["summary"].startswith(f"2 of {len(CASES)} cases run") and page.page.activity[1] == "ready"


def test_stopping_keeps_finished_cases_and_drops_waiting_ones(page: PageUnderTest) -> None:
    page.do("hard-cases-all")
    page.compute()
    page.do("hard-cases-stop")
    assert set(status(page)[1:]) == {"stopped"} and status(page)[0] == "done"
    assert page.under_way == [] and not page.state["running"] and Process.closed == 1
    page.do("hard-cases-run", case=SECOND.name)
    page.compute()
    assert status(page)[:2] == ["done", "done"]


def test_a_process_that_ends_fails_its_case_and_the_next_one_runs(page: PageUnderTest, monkeypatch: pytest.MonkeyPatch) -> None:
    page.do("hard-cases-run", case=FIRST.name)
    page.do("hard-cases-run", case=SECOND.name)
    with monkeypatch.context() as patched:
        patched.setattr(Process, "gone", True)
        page.compute()
    first = page.state["results"][FIRST.name]
    assert first["status"] == "failed" and "ended unexpectedly" in first["failure"]
    page.compute()
    assert status(page) == ["failed", "done"]
    page.do("hard-cases-run", case=FIRST.name)
    assert page.state["results"][FIRST.name]["failure"] == ""


def test_the_process_of_cases_ends_with_the_session(page: PageUnderTest) -> None:
    page.do("hard-cases-run", case=FIRST.name)
    page.host.leave()
    assert Process.closed == 1


def test_a_case_that_does_not_exist_is_refused(page: PageUnderTest) -> None:
    with pytest.raises(BadInput, match="There is no hard case 'none'"):
        page.do("hard-cases-run", case="none")
