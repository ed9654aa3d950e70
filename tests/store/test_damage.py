"""Randomly damaged files: a few dozen of each kind, and planted faults that the judge must notice."""

from __future__ import annotations

import os
import time
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from granchain_core import BadInput
from tools.damage import judge
from tools.damage.__main__ import table
from tools.damage.harms import HARMS
from tools.damage.judge import HANG, OTHER, REFUSED, SAME, TRACEBACK, WRONG, Reader, read, verdicts
from tools.damage.kinds import KINDS, Kind


@pytest.mark.parametrize("kind", KINDS)
def test_no_damaged_file_gives_a_wrong_number_a_traceback_or_a_hang(kind: str) -> None:
    found = list(verdicts(kind, True, 2 * len(HARMS), seed=77))
    print(table(found, "harm"))
    assert [v for v in found if v.outcome in (WRONG, TRACEBACK, HANG)] == []
    assert Counter(v.outcome for v in found)[REFUSED] > len(found) / 3


def test_no_damaged_file_of_an_earlier_version_gives_a_traceback_or_a_hang() -> None:
    """A wrong number is possible, because without a seal nothing reveals it."""
    found = list(verdicts("run", False, len(HARMS), seed=78))
    assert [v for v in found if v.outcome in (TRACEBACK, HANG)] == []
    assert [v for v in found if v.outcome == WRONG and v.harm in judge.LEADING] == []


# --- planted faults ---------------------------------------------------------------------------------------


def reader_that(does: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(KINDS, "run", Kind("run", KINDS["run"].make, does))


@pytest.mark.parametrize(("raised", "outcome"), [
    (RuntimeError("x"), TRACEBACK), (MemoryError(), TRACEBACK), (BadInput("no end"), TRACEBACK),
    (BadInput("It is damaged."), REFUSED)])
def test_an_error_that_is_no_sentence_is_noticed(raised: Exception, outcome: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(path: Path) -> None:
        raise raised

    reader_that(fails, monkeypatch)
    assert read("run", Path("a"), "one bit flipped", "7")[0] == outcome


@pytest.mark.parametrize(("value", "harm", "outcome"), [
    (7, "one bit flipped", SAME), (8, "one bit flipped", WRONG), (8, "external link", WRONG), (8, "attribute", OTHER)])
def test_a_wrong_number_of_a_damaged_file_is_noticed(value: int, harm: str, outcome: str, monkeypatch: pytest.MonkeyPatch) -> None:
    reader_that(lambda path: value, monkeypatch)
    assert read("run", Path("a"), harm, "7")[0] == outcome


def _sleeps(pipe: Any) -> None:
    pipe.recv()
    time.sleep(60)


def _ends(pipe: Any) -> None:
    pipe.recv()
    os._exit(1)


@pytest.mark.parametrize(("work", "outcome"), [(_sleeps, HANG), (_ends, TRACEBACK)])
def test_a_reader_that_hangs_or_ends_is_noticed_and_begun_again(work: Any, outcome: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(judge, "HANGS", 3.0 if outcome == HANG else 60.0)
    reader = Reader()
    with monkeypatch.context() as patch:
        patch.setattr(judge, "_work", work)
        assert reader.read("run", "a.h5", "cut short", None)[0] == outcome
    monkeypatch.setattr(judge, "HANGS", 60.0)
    assert reader.read("run", "a.h5", "cut short", None)[0] == REFUSED
    reader.close()
