"""Curves in HDF5.

/curve  frequency (Hz); max_output_force, max_output_force_elastic, max_input_force, their relative errors
        error_estimate (of the output force), error_estimate_elastic, error_estimate_input (frequency);
        regime, status, period (frequency); drive_amplitude (frequency, m) where A0 depends on the frequency, which the
        root's attribute `amplitude` describes
"""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np

from ..errors import FAILURES
from ..hdf5 import File, opened
from ..hdf5.border import one_of, within
from ..hdf5.plain import Refused
from ..integrate.batch import can_share_batch
from ..integrate.methods import CERTIFIED, LIVE
from ..regime import NAMES, Regime
from ..result import ForceErrors
from ..scene import Amplitude, Scene
from ..state import rest
from ..steady.curve.order import STARTS
from ..steady.curve.resonance_curve import Curve, CurvePoint
from .writing import MAXIMA, or_none, write_axis, write_file, write_root, write_values

_NUMBERS = ("frequency", *MAXIMA, "error_estimate_input", "error_estimate", "error_estimate_elastic")
#: How the computation of a point can have ended.
_OUTCOMES = ("done", *FAILURES)


def save_curve(curve: Curve, path: str | Path) -> Path:
    """Write a resonance curve to `path`; returns the path. Raises `BadInput` where it cannot be written."""
    single = f"{LIVE} or {CERTIFIED} point by point"
    method = f"rk4 in batches, {single}" if can_share_batch(curve.scene) else single

    def write(file: h5py.File) -> None:
        reached = [p.error_estimate for p in curve.points if p.error_estimate is not None]
        write_root(file, curve.scene, method, max(reached) if reached else None)
        file.attrs["start"], file.attrs["wall_s"] = curve.start, curve.wall_s
        group = file.create_group("curve")
        write_axis(group, "frequency", curve.column("frequency"), "Hz", "drive frequency")
        if curve.amplitude is not None:
            file.attrs["amplitude"] = json.dumps(curve.amplitude.to_json())
            write_values(group, "drive_amplitude", curve.drive_amplitude, ("frequency",), "m", "drive amplitude A0")
        for name in MAXIMA:
            words = name.replace("_", " ").replace("max", "largest", 1)
            write_values(group, name, curve.column(name), ("frequency",), "N", f"{words} in the steady state")
        errors = np.array([p.force_errors.row for p in curve.points])
        for column, (name, force) in enumerate((("error_estimate_input", "input"), ("error_estimate", "output"),
                                                ("error_estimate_elastic", "elastic output"))):
            write_values(group, name, errors[:, column], ("frequency",), "1",
                         f"relative error of largest {force} force")
        periods = np.array([p.regime.period or 0 for p in curve.points])
        write_values(group, "period", periods, ("frequency",), "1", "period in drive periods, 0 where not periodic")
        outcomes = np.array([p.status for p in curve.points], dtype=h5py.string_dtype())
        write_values(group, "status", outcomes, ("frequency",), "", "done, or how the numbers failed")
        names = np.array([p.regime.name for p in curve.points], dtype=h5py.string_dtype())
        write_values(group, "regime", names, ("frequency",), "", "periodic, quasi-periodic, chaotic or unsettled")

    return write_file(path, write)


def load_curve(path: str | Path) -> Curve:
    """The curve in a file: forces, errors, regimes and periods; neither the evidence for a regime nor states are there.

    Raises `BadInput` for a file that is not one.
    """
    with opened(path, "is not a curve written by granchain") as file:
        file.schema()
        return _read(file)


def _read(file: File) -> Curve:
    """The curve in a file."""
    scene, shape = file.scene(), file.shape("curve/frequency")
    if len(shape) != 1:
        raise Refused(f"/curve/frequency has shape {shape}, expected one row of frequencies")
    numbers = np.array([file.numbers(f"curve/{name}", shape) for name in _NUMBERS])
    periods = within("/curve/period", file.numbers("curve/period", shape, "i"), 0, np.iinfo(np.int32).max)
    names = file.words("curve/regime", shape[0], NAMES)
    outcomes = file.words("curve/status", shape[0], _OUTCOMES)
    points = [_point(scene, *one) for one in zip(numbers.T, periods, names, outcomes, strict=True)]
    amplitude = Amplitude.from_json(file.json("amplitude")) if file.stated("amplitude") else None
    return Curve(scene, one_of("start", file.text("start"), STARTS), points, file.number("wall_s"), amplitude)


def _point(scene: Scene, numbers: np.ndarray, period: int, name: str, outcome: str) -> CurvePoint:
    frequency, input_force, output_force, elastic, *errors = map(float, numbers)
    return CurvePoint(frequency, output_force, elastic, input_force, Regime(name, int(period) or None, None, None, 0),
                      ForceErrors(*(or_none(error) for error in errors)), rest(scene), status=outcome)
