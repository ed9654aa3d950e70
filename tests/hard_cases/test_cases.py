"""Every hard case passes in its quick form, compared with the oracle that its row in the table names."""

from __future__ import annotations

import functools

import pytest

from granchain_core.hard_cases import CASES, Check, run_case
from tools.hard_cases import recorded

#: Rows with timings, which are not a test on a busy machine.
TIMINGS = ("time per bead", "time of an evaluation")


@functools.cache
def rows(name: str) -> list[Check]:
    """Return the rows of one case."""
    return run_case(next(case for case in CASES if case.name == name), quick=True)


@pytest.mark.parametrize("name", [case.name for case in CASES])
def test_the_case_holds(name: str) -> None:
    missed = [f"{r.title}: {r.value:.2e} > {r.limit:.1e} ({r.oracle})" for r in rows(name)
              if not r.passed and not any(words in r.title for words in TIMINGS)]
    assert not missed


@pytest.mark.parametrize("name", [case.name for case in CASES])
def test_the_page_has_the_names_and_limits_of_the_rows(name: str) -> None:
    """The recorded run from which the page's table is written (tools/hard_cases.py) has the rows of the present code.
    """
    assert [(row.name, row.limit) for row in recorded("quick", name)] == [(row.title, row.limit) for row in rows(name)]


def test_every_case_has_its_words() -> None:
    """Each has texts on its oracle, on what is hard, and on what a naive solver does."""
    assert len({case.name for case in CASES}) == len(CASES)
    assert all(case.oracle and case.hard and case.naive for case in CASES)
