"""Measurements in HDF5 and netCDF-4: names and units of rows, granchain's own files, and files that are asked about or
refused.
"""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray

from granchain_core import BadInput, resonance_curve, run, save, scene
from granchain_core.experiment import Measured, Series, Shaker, Unclear, answers_of, read_experiment
from granchain_core.store import save_curve

F, FORCE = np.array([50.0, 60.0, 70.0]), np.array([1.0, 3.0, 2.0])


def hdf5(path: Path, **rows: tuple[object, str | None]) -> Path:
    """Write a file of rows with their units, using only h5py."""
    with h5py.File(path, "w") as file:
        for name, (values, unit) in rows.items():
            file[name] = values
            if unit is not None:
                file[name].attrs["units"] = unit
        file.attrs["title"] = "rig 2"
    return path


def test_rows_with_units(tmp_path: Path) -> None:
    found = read_experiment(hdf5(tmp_path / "a.h5", f=(F / 1e3, "kHz"), force=(1e3 * FORCE, "mN"), noise=(np.zeros(9), None)))
    assert isinstance(found, Measured) and found.note == "rig 2" and found.units == {"frequency": "kHz", "force": "mN"}
    np.testing.assert_allclose([found.frequency, found.force], [F, FORCE])


@pytest.mark.parametrize("layout", ["earliest", "v108", "latest"])
def test_every_version_of_hdf5s_layout_is_read(layout: str, tmp_path: Path) -> None:
    """Other programs, including netCDF's library, write the superblock that sealed files have, but without a seal."""
    with h5py.File(tmp_path / "a.h5", "w", libver=layout) as file:
        file["f"], file["force"] = F, FORCE
        for name, unit in (("f", "Hz"), ("force", "N")):
            file[name].attrs["units"] = unit
    found = read_experiment(tmp_path / "a.h5")
    assert isinstance(found, Measured) and list(found.force) == list(FORCE)


def test_a_seal_that_does_not_match_is_reported_as_damage(tmp_path: Path) -> None:
    path = save_curve(resonance_curve(scene("sec2").evolve(N=2), [1800.0, 2000.0]), tmp_path / "curve.h5")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    with pytest.raises(BadInput, match="its checksum does not match"):
        read_experiment(path)


def test_netcdf_of_xarray(tmp_path: Path) -> None:
    data = xarray.Dataset({"amplitude": ("frequency", np.float32([7, 8, 6]), {"units": "µm"})},
                          coords={"frequency": ("frequency", F, {"units": "Hz"})})
    data.to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    found = read_experiment(tmp_path / "a.nc")
    assert isinstance(found, Shaker) and found.displacement == pytest.approx([7e-6, 8e-6, 6e-6])


def test_granchains_own_curves_are_read(tmp_path: Path) -> None:
    chain = scene("sec2").evolve(N=2)
    curve = resonance_curve(chain, [1800.0, 2000.0])
    save_curve(curve, tmp_path / "curve.h5")
    found = read_experiment(tmp_path / "curve.h5")
    assert isinstance(found, Measured) and list(found.force) == list(curve.column("max_output_force"))
    motion = run(chain.evolve(f=2000.0), periods=5, record=1, samples=16)
    save(motion, tmp_path / "run.h5")
    series = read_experiment(tmp_path / "run.h5")
    assert isinstance(series, Series) and series.output_force is not None and series.displacement is not None
    np.testing.assert_array_equal(series.output_force, motion.output_force)
    np.testing.assert_array_equal(series.displacement, motion.drive_displacement)


def test_rows_without_meaning_are_asked_about_and_answered(tmp_path: Path) -> None:
    path = hdf5(tmp_path / "a.h5", x=(F, None), y=(FORCE, None))
    with pytest.raises(Unclear, match=r"a\.h5: What 'x' and 'y' hold") as asked:
        read_experiment(path)
    assert asked.value.question.rows[0] == (1, ("50", "1"))
    found = read_experiment(path, answers_of(["f=1:Hz", "F=2:mN"]))
    assert isinstance(found, Measured) and found.force == pytest.approx(1e-3 * FORCE)


def test_labelled_files_without_usable_data_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"a\.h5.*Row 2 of force is not a finite number"):
        read_experiment(hdf5(tmp_path / "a.h5", f=(F, "Hz"), force=([1.0, np.nan, 2.0], "N")))
    with pytest.raises(BadInput, match="no two rows of numbers"):
        read_experiment(hdf5(tmp_path / "b.h5", f=(F[:1], "Hz")))
    with h5py.File(tmp_path / "c.h5", "w") as file:
        file["here"] = h5py.ExternalLink("a.h5", "/f")
        file.create_dataset("f", data=F, compression="gzip")
    with pytest.raises(BadInput, match="compressed"):
        read_experiment(tmp_path / "c.h5")
