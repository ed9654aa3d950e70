"""A curve file has the evidence for every point's regime, and older files without it still open."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import h5py
import pytest

from granchain_core import resonance_curve, save, scene
from granchain_core.hdf5 import seal
from granchain_core.results.regime import Regime
from granchain_core.results.regime_columns import EVIDENCE, MORE_EVIDENCE
from granchain_core.store import load_curve

CURVE = resonance_curve(scene("sec2").evolve(N=3), [900.0, 1000.0, 2000.0])


def test_the_evidence_of_a_curve_is_read_back(tmp_path: Path) -> None:
    found = load_curve(save(CURVE, tmp_path / "c.h5"))
    assert {point.regime.name for point in found.points} >= {"periodic"}
    for before, after in zip(CURVE.points, found.points, strict=True):
        assert after.regime == before.regime and after.regime.periods_run > 0


def test_the_evidence_of_every_regime_is_read_back(tmp_path: Path) -> None:
    """The evidence decides between quasi-periodic and unsettled, and tells how the orbit of a slow motion was found."""
    regimes = (
        Regime("quasi-periodic", None, None, None, 900, (1e-4, 2e-3), return_distance=0.01, return_limit=0.15,
               window_ratios=(0.99, 1.01), lyapunov_periods=1200),
        Regime("unsettled", None, None, None, 900, (1e-4, 2e-3), approaches=3, multiplier=0.999),
        Regime("periodic", 2, 0.97, 1e-7, 400, followed=True, followed_by="Newton"))
    points = [replace(point, regime=regime) for point, regime in zip(CURVE.points, regimes, strict=True)]
    found = load_curve(save(replace(CURVE, points=points), tmp_path / "c.h5"))
    assert tuple(point.regime for point in found.points) == regimes


MORE = ("followed", "approaches", *MORE_EVIDENCE)


@pytest.mark.parametrize("missing", [MORE, ("periods_run", *EVIDENCE, *MORE)])
def test_a_file_without_evidence_opens(tmp_path: Path, missing: tuple[str, ...]) -> None:
    path = save(CURVE, tmp_path / "old.h5")
    with h5py.File(path, "r+") as file:
        for name in missing:
            del file["curve"][name]
    seal(path)
    found = load_curve(path)
    assert [point.regime.name for point in found.points] == [point.regime.name for point in CURVE.points]
    told = "periods_run" not in missing
    assert all((point.regime.periods_run > 0) is told and point.regime.distance is None for point in found.points)
    given, read = ([point.max_output_force for point in one.points] for one in (CURVE, found))
    assert read == pytest.approx(given, rel=1e-15)


def test_the_way_an_orbit_was_found_is_read_back_and_unknown_in_older_files(tmp_path: Path) -> None:
    regimes = (Regime("periodic", 1, 0.5, 1e-7, 90), Regime("periodic", 2, 0.97, 1e-7, 400, followed=True, followed_by="extrapolation"),
               Regime("chaotic", None, None, None, 900, (0.2, 1e-3), lyapunov_periods=200))
    points = [replace(point, regime=regime) for point, regime in zip(CURVE.points, regimes, strict=True)]
    path = save(replace(CURVE, points=points), tmp_path / "c.h5")
    assert [point.regime.orbit_found_by for point in load_curve(path).points] == ["settling", "extrapolation", None]
    with h5py.File(path, "r+") as file:
        del file["curve"]["orbit_found_by"]
    seal(path)
    assert [point.regime.orbit_found_by for point in load_curve(path).points] == ["settling", None, None]
