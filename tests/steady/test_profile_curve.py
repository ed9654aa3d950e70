"""The program that profiles the computation of a curve examines the thread that computes it."""

from __future__ import annotations

import re
import sys

import pytest

from tools import profile_curve


def test_the_profile_states_the_batch_and_the_time_without_profiling(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["profile_curve", "--from", "300", "--to", "340", "--points", "2", "--rows", "40"])
    profile_curve.main()
    said = capsys.readouterr().out
    assert "Ordered by: internal time" in said
    assert re.search(r"batch\.run\.run_batch\}$", said, re.MULTILINE), "the thread that computes is profiled"
    assert re.search(r"^2 points on one thread, without profiling: \d\.\d{3} s$", said, re.MULTILINE)
