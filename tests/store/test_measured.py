"""A measurement saved along with a result: its units, its source, and whether anything was really measured."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray

from granchain_core import Signal, drive, load, resonance_curve, run, save, scene
from granchain_core.experiment import Measured, Series, read_data
from granchain_core.store import load_curve
from granchain_core.virtual_experiment import Sensors, virtual_series_csv

CHAIN = scene("sec2").evolve(N=2, f=2000.0)
CURVE = read_data(b"# my rig\nf [kHz],F [mN],error [mN]\n1.8,3300,100\n2.0,2300,100\n2.0,2340,100\n", source="mine.csv")
SERIES = read_data(virtual_series_csv(CHAIN, 2, Sensors(noise=0.01)).encode(), source="virtual.csv")


@pytest.mark.parametrize("measured", [CURVE, SERIES], ids=["curve", "series"])
def test_measured_data_in_a_file_open_with_units_and_its_result_loads(measured: Measured | Series, tmp_path: Path) -> None:
    motion, curve = run(CHAIN, periods=0, record=1, samples=8), resonance_curve(CHAIN, [1800.0, 2000.0])
    for result, again in ((motion, load), (curve, load_curve)):
        path = save(result, tmp_path / "found.h5", measured)
        assert type(again(path)) is type(result)
        found = xarray.load_dataset(path, engine="h5netcdf", group="measured")
        assert found.attrs["virtual"] == int(measured.virtual) and found.attrs["source"] == measured.source
        if isinstance(measured, Measured):
            np.testing.assert_array_equal(found.force.values, measured.force)
            assert found.force.attrs["units"] == "N" and found.repeats.values.tolist() == [1, 2] and "my rig" in found.attrs["note"]
        else:
            np.testing.assert_array_equal(found.input_force.values, measured.input_force)
            assert found.drive_velocity.attrs["units"] == "m/s" and "displacement" not in found


def test_a_computed_drive_has_no_group_of_measured_values(tmp_path: Path) -> None:
    with h5py.File(save(drive(CHAIN, Signal.burst(CHAIN.A0, 2000.0, 2, 0.002)), tmp_path / "d.h5")) as file:
        assert "measured" not in file
