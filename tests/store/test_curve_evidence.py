"""A curve's file has the evidence for every point's regime, and one from before it was kept still opens."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import pytest

from granchain_core import resonance_curve, save, scene
from granchain_core.hdf5 import seal
from granchain_core.store import load_curve
from granchain_core.tables.words import EVIDENCE

CURVE = resonance_curve(scene("sec2").evolve(N=3), [900.0, 1000.0, 2000.0])


def test_the_evidence_comes_back(tmp_path: Path) -> None:
    found = load_curve(save(CURVE, tmp_path / "c.h5"))
    assert {point.regime.name for point in found.points} >= {"periodic"}
    for before, after in zip(CURVE.points, found.points, strict=True):
        kept = replace(after.regime, **{name: getattr(before.regime, name) for name in (
            "distance", "followed", "approaches", "return_distance", "return_limit", "window_ratios")})
        assert kept == before.regime and after.regime.periods_run > 0


def test_a_file_without_it_opens(tmp_path: Path) -> None:
    path = save(CURVE, tmp_path / "old.h5")
    with h5py.File(path, "r+") as file:
        for name in ("periods_run", *EVIDENCE):
            del file["curve"][name]
    seal(path)
    found = load_curve(path)
    assert [point.regime.name for point in found.points] == [point.regime.name for point in CURVE.points]
    assert all(point.regime.decay is None and point.regime.periods_run == 0 for point in found.points)
    assert [point.max_output_force for point in found.points] == pytest.approx([point.max_output_force for point in CURVE.points], rel=1e-15)
