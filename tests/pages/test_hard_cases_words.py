"""The text and messages of the page "Hard cases", without a browser, and the process that measures the cases."""

from __future__ import annotations

import json
import math
import threading

import pytest

from app.pages.hard_cases.view import described_cases, described_results, digits_of, summary, value_beside
from app.pages.hard_cases.work import CaseProcess, Ended, case_of
from granchain_core import Cancelled, ComputationError
from granchain_core.execution.stop import Stop
from granchain_core.hard_cases import CASES, Case, Check, Measurement, run_case


def measured(*found: Measurement) -> list[Check]:
    """Return rows of the case "touch and graze" with these measurements instead of its own."""
    return run_case(Case("touch and graze", "h", "n", "o", lambda _: found), quick=True)


@pytest.mark.parametrize(("value", "bar", "told"), [
    (7.123e-13, 1e-9, "7.1e-13"), (0.0, 0.0, "0"), (3.0, 0.0, "3"), (0.95, 1.2, "0.95"), (2e-7, 1e-6, "2e-7"),
    (1.2001, 1.2, "1.2001"), (1.19999, 1.2, "1.2"), (1.0000001e-9, 1e-9, "1.0000001e-9"),
    (math.nan, 1.0, "no number"), (math.inf, 1.0, "infinite")])
def test_a_figure_is_on_the_true_side_of_its_bar(value: float, bar: float, told: str) -> None:
    assert value_beside(value, bar) == told
    assert digits_of(1e-13, 3) == "1e-13"


def test_a_row_that_fails_keeps_its_figure_and_one_that_is_not_computed_its_sentence() -> None:
    shown = described_results("touch and graze", measured(Measurement("missed", 3.0, 0.0), Measurement("moment", 5e-11, 1e-9)))
    assert [(row["what"], row["value"], row["limit"], row["passed"]) for row in shown["rows"]] == [
        ("missed", "3", "0", False), ("moment", "5e-11", "1e-9", True)]

    def fails(quick: bool) -> list[Measurement]:
        raise ComputationError("It gave up.", "chatter")

    (row,) = described_results("x", run_case(Case("x", "h", "n", "o", fails), quick=True))["rows"]
    assert not row["passed"] and row["value"] == "no number" and row["note"] == "It gave up."
    json.dumps(shown, allow_nan=False)


def test_names_with_a_colon_are_taken_off_as_a_whole() -> None:
    name = "no damping, driven: chaos"
    assert case_of(name) is not None
    rows = run_case(Case(name, "h", "n", "o", lambda _: [Measurement("energy: balance", 0.0, 1.0)]), quick=True)
    assert described_results(name, rows)["rows"][0]["what"] == "energy: balance"


def test_the_summary_names_what_failed() -> None:
    assert summary({}) == ""
    good = measured(Measurement("moment", 5e-11, 1e-9))
    assert summary({"touch and graze": good}) == f"1 of {len(CASES)} cases run: no value of 1 is above its limit."
    bad = measured(Measurement("missed", 3.0, 0.0), Measurement("moment", math.nan, 1e-9))
    assert summary({"touch and graze": bad}) == (
        f"1 of {len(CASES)} cases run: 2 of 2 values FAILED: touch and graze: missed, 3 against 0, and 1 more.")


def test_every_case_has_its_lines_and_none_is_too_long_for_one() -> None:
    shown = described_cases()
    assert [one["name"] for one in shown] == [case.name for case in CASES]
    assert all(0 < len(one[line]) <= 115 for one in shown for line in ("hard", "naive", "oracle"))


def test_the_process_of_cases_can_be_stopped_and_its_death_is_noticed() -> None:
    long = case_of("near a bifurcation")
    assert long is not None
    process, stop = CaseProcess(), Stop()
    stop.set()
    with pytest.raises(Cancelled):
        next(process.measure(long, stop))
    # ended from outside: this is reported, and the next case has a new process
    stop = Stop()
    answers = process.measure(Case("not in the table", "h", "n", "o", lambda _: []), stop)
    with pytest.raises(Ended):
        next(answers)
    threading.Timer(1.0, stop.set).start()
    with pytest.raises(Cancelled):
        list(process.measure(long, stop))
    assert process._process is not None
    process._process.join(60.0)
    assert process._process.exitcode is not None
