"""The group /measured of a result file: the measurement drawn over the result, with units and source."""

from __future__ import annotations

import h5py
import numpy as np

from ..experiment import Measured, Series
from ..tables import Column, Table, axis
from .writing import write_table

#: Columns of a curve over frequency and of a series over time: field, name, unit, meaning.
_CURVE = (("force", "force", "N", "largest force, the mean of repeats"), ("error", "error", "N", "its stated error"),
          ("low", "force_low", "N", "smallest of the repeats"), ("high", "force_high", "N", "largest of the repeats"),
          ("repeats", "repeats", "1", "how often it was measured"))
_SERIES = (("velocity", "drive_velocity", "m/s", "velocity of the shaker"),
           ("displacement", "drive_displacement", "m", "displacement of the shaker"),
           ("input_force", "input_force", "N", "force of the driver on bead 1"),
           ("output_force", "output_force", "N", "force on the wall"))


def write_measured(file: h5py.File, measured: Measured | Series) -> None:
    """Write the group `measured`; its attributes say whether the data were really measured."""
    write_table(file, measured_table(measured))
    file["measured"].attrs.update({"understood": measured.understood, "source": measured.source, "note": measured.note,
                                   "virtual": int(measured.virtual)})


def measured_table(measured: Measured | Series) -> Table:
    """Return the measured columns, in SI units."""
    kinds: tuple[tuple[str, str, str, str], ...]
    if isinstance(measured, Measured):
        name, along, kinds = "frequency", axis("frequency", measured.frequency, "Hz", "drive frequency"), _CURVE
    else:
        name, along, kinds = "time", axis("time", measured.time, "s", "time since the first sample"), _SERIES
    return Table("measured", along, {
        title: Column(np.asarray(values), (name,), unit, meaning)
        for field, title, unit, meaning in kinds if (values := getattr(measured, field)) is not None})
