"""`granchain run --drive FILE --tip-mass` takes the mass in front of the sensor into account in its comparison."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from app.cli import main

CHAIN = ["sec2", "--set", "N=2", "--set", "f=2000"]


def test_a_record_with_a_tip_is_replayed_only_with_its_mass(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = str(tmp_path / "tip.csv")
    assert main(["virtual", *CHAIN, "--tip-mass", "0.05", "--periods", "6", "--start", "rest", "--out", file]) == 0
    capsys.readouterr()
    found = []
    for options in ([], ["--tip-mass", "0.05"]):
        assert main(["run", *CHAIN, "--drive", file, *options, "--json"]) == 0
        found.append(json.loads(capsys.readouterr().out))
    assert [one["tip_mass"] for one in found] == [0.0, 0.05]
    without, given = (one["residual_input"]["relative"] for one in found)
    assert given < 0.02 < 0.1 < without


def test_a_tip_mass_is_refused_without_a_record(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", *CHAIN, "--tip-mass", "0.05"]) != 0
    assert "--tip-mass is for --drive FILE" in capsys.readouterr().err
