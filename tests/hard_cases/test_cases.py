"""Every hard case, in its quick form, holds: each against the oracle that its row of the table names."""

from __future__ import annotations

import functools
from pathlib import Path

import pytest

from granchain_core.hard_cases import CASES, Check, run_case

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


def test_every_case_has_its_rows_on_the_page() -> None:
    """Each with its oracle, what is hard and what a naive solver does."""
    page = (Path(__file__).parents[2] / "docs" / "hard-cases.md").read_text(encoding="utf-8")
    table = page.partition("| case | what must hold |")[2].partition("\n\n")[0]
    named = [line for line in table.splitlines()[2:] if not line.startswith("| |")]
    assert len(named) == len({case.name for case in CASES}) == len(CASES)
    assert all(case.oracle and case.hard and case.naive for case in CASES)
