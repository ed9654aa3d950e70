"""`granchain check` prints a row for each hard case, and its exit status says whether all passed."""

from __future__ import annotations

import json
import os
import signal

import pytest

from app.cli import main
from granchain_core.hard_cases import CASES, Check, runner


def pretend(figure: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the computation by instant rows; the last case has this value, with a limit of 1."""

    def rows(quick: bool, workers: int | None = None):  # type: ignore[no-untyped-def]
        for case in CASES:
            value = figure if case is CASES[-1] else 0.5
            yield case.name, [Check(case.name, "one", value, 1.0, value <= 1.0, 0.1, case.hard, case.naive, case.oracle)]

    monkeypatch.setattr(runner, "run_cases", rows)


def test_json_has_a_row_for_each_case(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pretend(0.9, monkeypatch)
    assert main(["check", "--quick", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["rows"]
    assert len(rows) == len(CASES)
    assert all(row["passed"] for row in rows)


@pytest.mark.parametrize("figure", [1.1, float("nan")])
def test_a_row_above_its_bar_is_status_3(figure: float, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pretend(figure, monkeypatch)
    assert main(["check", "--json"]) == 3
    told = capsys.readouterr()
    assert [row["passed"] for row in json.loads(told.out)["rows"]].count(False) == 1
    assert CASES[-1].name in told.err


def test_without_json_the_difficulty_of_each_case_is_printed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pretend(0.9, monkeypatch)
    assert main(["check"]) == 0
    shown = capsys.readouterr().out
    assert all(case.hard in shown and case.naive in shown for case in CASES)


def test_a_process_that_was_killed_is_reported(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The kernel does this when memory is short. The command ends with status 3 and a sentence, without a traceback."""
    monkeypatch.setattr(runner, "_run", _end_itself)
    assert main(["check", "--quick", "--json"]) == 3
    told = capsys.readouterr()
    assert json.loads(told.out)["status"] == "worker-failed"
    assert "ended from outside" in told.err and "Traceback" not in told.err


def _end_itself(name: str, quick: bool) -> list[Check]:
    os.kill(os.getpid(), signal.SIGKILL)
    return []
