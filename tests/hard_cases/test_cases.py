"""Every hard case, in its quick form, holds: each against the oracle that its row of the table names."""

from __future__ import annotations

import functools

import pytest

from granchain_core.hard_cases import CASES, Check, run_case
from tools.hard_cases import recorded

#: Rows that are timings; on a machine that does other things they are not a test.
TIMINGS = ("time per bead", "time of an evaluation")


@functools.cache
def rows(name: str) -> list[Check]:
    """The rows of one case."""
    return run_case(next(case for case in CASES if case.name == name), quick=True)


@pytest.mark.parametrize("name", [case.name for case in CASES])
def test_the_case_holds(name: str) -> None:
    missed = [f"{r.title}: {r.value:.2e} > {r.limit:.1e} ({r.oracle})" for r in rows(name)
              if not r.passed and not any(words in r.title for words in TIMINGS)]
    assert not missed


@pytest.mark.parametrize("name", [case.name for case in CASES])
def test_the_page_has_the_names_and_limits_of_the_rows(name: str) -> None:
    """The recorded run from which the page's table is written (tools/hard_cases.py) has the rows of today's code."""
    assert [(row.name, row.limit) for row in recorded("quick", name)] == [(row.title, row.limit) for row in rows(name)]


def test_every_case_has_its_words() -> None:
    """Its oracle, what is hard and what a naive solver does."""
    assert len({case.name for case in CASES}) == len(CASES)
    assert all(case.oracle and case.hard and case.naive for case in CASES)
