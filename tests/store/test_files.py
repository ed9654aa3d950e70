"""Files: results come back bit by bit, and other programs find labelled axes with units."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray

from granchain_core import BadInput, resonance_curve, run, scene, settle
from granchain_core.store import load, save, save_curve
from granchain_core.tables.provenance import kernels_digest

#: From `sys.modules`, because the package has a function with the name of this module.
provenance = sys.modules["granchain_core.tables.provenance"]

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def result():  # type: ignore[no-untyped-def]
    return run(scene("sec2").evolve(kappa=0.001), periods=2, record=2, samples=8)


def test_a_run_is_read_back_bit_by_bit(tmp_path: Path, result) -> None:  # type: ignore[no-untyped-def]
    again = load(save(result, tmp_path / "a.h5"))
    for name in ("time", "displacement", "velocity", "force", "drive_displacement", "kinetic_energy", "output_force",
                 "output_force_elastic"):
        assert (getattr(again, name) == getattr(result, name)).all(), name
    for name in ("scene", "regime", "cost", "status", "samples", "displacement_error", "energy_residual",
                 "max_input_force", "max_output_force", "max_output_force_elastic"):
        assert getattr(again, name) == getattr(result, name), name


def test_the_evidence_for_a_regime_is_read_back_and_may_be_missing(tmp_path: Path, result) -> None:  # type: ignore[no-untyped-def]
    """Files written before the return distance and the ratios were saved open too."""
    rich = replace(result.regime, name="quasi-periodic", period=None, lyapunov=(1e-4, 2e-3), lyapunov_periods=1000,
                   return_distance=0.01, return_limit=0.15, window_ratios=(0.99, 1.01))
    kept = replace(result, regime=rich)
    assert load(save(kept, tmp_path / "a.h5")).regime == rich
    old = {name: value for name, value in rich.to_json().items() if not name.startswith(("return", "window", "lyapunov_"))}
    attributes = {**kept.attributes(), "regime": json.dumps(old)}
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(type(kept), "attributes", lambda self: attributes)
        file = save(kept, tmp_path / "old.h5")
    assert load(file).regime == replace(rich, return_distance=None, return_limit=None, window_ratios=None,
                                        lyapunov_periods=None)


def test_xarray_opens_a_run_with_labelled_axes_and_units(tmp_path: Path, result) -> None:  # type: ignore[no-untyped-def]
    file = save(result, tmp_path / "a.h5")
    with xarray.open_dataset(file, engine="h5netcdf", group="run") as data:
        assert data.displacement.dims == ("time", "bead") and data.displacement.attrs["units"] == "m"
        assert data.force.dims == ("time", "contact") and data.force.attrs["units"] == "N"
        assert data.kinetic_energy.attrs["units"] == "J" and data.velocity.attrs["units"] == "m/s"
        assert list(data.bead.values) == list(range(1, 12)) and data.time.attrs["units"] == "s"
        for name in ("drive_displacement", "input_force", "output_force", "output_force_elastic"):
            assert data[name].dims == ("time",)
    with xarray.open_dataset(file, engine="h5netcdf") as root:
        for name in ("granchain_schema", "scene", "method", "accuracy_asked", "accuracy_reached", "cost", "versions",
                     "machine"):
            assert name in root.attrs


def test_a_file_says_by_which_kernels_and_libraries_it_was_made(tmp_path: Path, result,  # type: ignore[no-untyped-def]
                                                                monkeypatch: pytest.MonkeyPatch) -> None:
    """Commits of one version with different kernels can be told apart. llvmlite decides the bits of compiled code."""
    made = result.attributes()
    assert set(json.loads(made["versions"])) == {"python", "numpy", "scipy", "numba", "llvmlite", "h5py"}
    with xarray.open_dataset(save(result, tmp_path / "a.h5"), engine="h5netcdf") as root:
        assert root.attrs["kernels_digest"] == made["kernels_digest"] == kernels_digest()
    monkeypatch.setattr(provenance, "_KERNELS", tmp_path)
    kernel = tmp_path / "a.py"
    digests = []
    for text in ("x = 1\n", "x = 2\n", "x = 1\n"):
        kernel.write_text(text, encoding="utf-8")
        digests.append(kernels_digest.__wrapped__())
    assert digests[0] == digests[2] != digests[1] and len(made["kernels_digest"]) == 12


def test_xarray_opens_a_curve(tmp_path: Path) -> None:
    curve = resonance_curve(scene("sec2"), [300.0, 400.0])
    with xarray.open_dataset(save_curve(curve, tmp_path / "c.h5"), engine="h5netcdf", group="curve") as data:
        assert (data.max_output_force.sel(frequency=300.0) > 0.5) and data.frequency.attrs["units"] == "Hz"
        assert set(data.regime.values) == {"periodic"}


def test_a_file_that_is_none_of_ours_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "b.h5"
    other.write_bytes(b"not HDF5")
    with pytest.raises(BadInput, match=r"not a run written by granchain"):
        load(other)
    with pytest.raises(BadInput, match="No such file"):
        load(tmp_path / "missing.h5")


def test_a_failed_write_leaves_no_file_behind(tmp_path: Path, result) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(BadInput, match="Cannot write"):
        save(result, tmp_path / "no" / "a.h5")
    save(result, tmp_path / "a.h5")
    assert [p.name for p in tmp_path.iterdir()] == ["a.h5"]


def test_overlap_follows_from_what_is_stored(result) -> None:  # type: ignore[no-untyped-def]
    # the elastic wall force is K [δ_N]^{3/2} of the stored overlap: the same numbers, computed in two ways
    elastic = result.scene.contact_stiffness()[-1] * np.maximum(result.overlap[:, -1], 0.0) ** 1.5
    assert elastic == pytest.approx(result.output_force_elastic, rel=1e-12)


def test_a_steady_state_from_a_given_state_is_read_back_with_its_start(tmp_path: Path) -> None:
    """Older files say "previous state" for such a start and load with the same start as new ones."""
    chain = scene("sec2").evolve(N=2, f=2000.0)
    first = settle(chain, samples=8)
    carried = settle(chain, start=first.state, samples=8)
    assert (first.start, first.run.start) == ("rest", "rest")
    assert (carried.start, carried.run.start) == ("previous state", "given state")
    for found in (first, carried):
        back = load(save(found, tmp_path / "s.h5"))
        assert (back.start, back.regime) == (found.run.start, found.regime)
    old = {**carried.attributes(), "start": "previous state"}
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(type(carried), "attributes", lambda self: old)
        file = save(carried, tmp_path / "old.h5")
    assert load(file).start == "given state"


def test_a_steady_state_without_a_drive_says_that_it_began_with_velocities(tmp_path: Path) -> None:
    found = settle(scene("impact").evolve(N=5), samples=8)
    assert found.start == "rest"
    assert load(save(found, tmp_path / "i.h5")).start == "initial velocity"
