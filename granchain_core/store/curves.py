"""Curves in HDF5.

/curve  frequency (Hz); max_output_force, max_output_force_elastic, max_input_force, their relative errors
        error_estimate (of the output force; docs/result-files.md, "Which name is which error"),
        error_estimate_elastic, error_estimate_input (frequency);
        regime, status, period (frequency); the evidence for the regime, which older files lack in part or whole:
        periods_run, decay, multiplier, lyapunov, lyapunov_error, lyapunov_periods, and followed, approaches, distance,
        return_distance, return_limit, smallest_window_ratio, largest_window_ratio (frequency);
        drive_amplitude (frequency, m) if A0 depends on the frequency, as the root's attribute `amplitude` describes
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..errors import FAILURES
from ..hdf5 import File, opened
from ..hdf5.checked_file import one_of, within
from ..hdf5.plain import Refused
from ..results.forces import ForceErrors
from ..results.regime import FOUND_BY, NAMES, Regime
from ..results.regime_columns import EVIDENCE, MORE_EVIDENCE
from ..scene import Amplitude, Scene
from ..scene.state import rest
from ..steady.curve.curve import Curve, CurvePoint
from ..steady.curve.order import CURVE_STARTS
from ..tables import MAXIMA
from ..tables.words import ERRORS
from .writing import or_none, write_file, write_result

_NUMBERS = ("frequency", *MAXIMA, *ERRORS)
#: Values of the `status` of a point.
_OUTCOMES = ("done", *FAILURES)


def save_curve(curve: Curve, path: str | Path) -> Path:
    """Write a resonance curve to `path` and return the path. Raises `BadInput` if it cannot be written."""
    return write_file(path, lambda file: write_result(file, curve))


def load_curve(path: str | Path) -> Curve:
    """Return the curve in a file: forces, errors, and regimes with evidence (missing in old files), without states.

    Raises `BadInput` for any other file.
    """
    with opened(path, "is not a curve written by granchain") as file:
        file.schema()
        return _read(file)


def _read(file: File) -> Curve:
    """Return the curve in a file."""
    scene, shape = file.scene(), file.shape("curve/frequency")
    if len(shape) != 1:
        raise Refused(f"/curve/frequency has shape {shape}, expected one row of frequencies")
    file.expect_units(Curve(scene, "rest").tables()[0].units)
    numbers = np.array([file.numbers(f"curve/{name}", shape) for name in _NUMBERS])
    periods = within("/curve/period", file.numbers("curve/period", shape, "i"), 0, np.iinfo(np.int32).max)
    names = file.words("curve/regime", shape[0], NAMES)
    outcomes = file.words("curve/status", shape[0], _OUTCOMES)
    proven = _evidence(file, shape)
    points = [_point(scene, *one) for one in zip(numbers.T, periods, names, outcomes, proven, strict=True)]
    amplitude = Amplitude.from_json(file.json("amplitude")) if file.stated("amplitude") else None
    return Curve(scene, start=one_of("start", file.text("start"), CURVE_STARTS), points=points,
                 wall_s=file.number("wall_s"), amplitude=amplitude)


def _evidence(file: File, shape: tuple[int, ...]) -> list[dict[str, Any]]:
    """Return regime and evidence of each point; evidence that an older file lacks is unknown."""
    numbers = {name: file.numbers(f"curve/{name}", shape, "any") if file.has(f"curve/{name}")
               else np.full(shape, np.nan) for name in EVIDENCE | MORE_EVIDENCE}
    run, followed, approaches = (_whole(file, name, shape, most) for name, most in (
        ("periods_run", np.iinfo(np.int64).max), ("followed", 1), ("approaches", np.iinfo(np.int32).max)))
    by = file.words("curve/orbit_found_by", shape[0], ("", *FOUND_BY)) if file.has("curve/orbit_found_by") else None
    return [{"periods_run": int(run[i]), "followed": bool(followed[i]),
             "followed_by": by[i] or None if by is not None and followed[i] else None,
             "approaches": int(approaches[i]) or None,
             "lyapunov": _pair(numbers["lyapunov"][i], numbers["lyapunov_error"][i]),
             "lyapunov_periods": _count(numbers["lyapunov_periods"][i]),
             "window_ratios": _pair(numbers["smallest_window_ratio"][i], numbers["largest_window_ratio"][i]),
             **{name: or_none(numbers[name][i])
                for name in ("decay", "multiplier", "distance", "return_distance", "return_limit")}}
            for i in range(shape[0])]


def _whole(file: File, name: str, shape: tuple[int, ...], most: int) -> np.ndarray:
    """Return whole numbers from 0 to `most`; 0 in files without them."""
    path = f"curve/{name}"
    return within(f"/{path}", file.numbers(path, shape, "i"), 0, most) if file.has(path) else np.zeros(shape, np.int64)


def _count(number: float) -> int | None:
    """Return a number of drive periods; None if unknown. Refuses anything else."""
    if np.isnan(number):
        return None
    return int(within("/curve/lyapunov_periods", np.array([number]), 1, np.iinfo(np.int32).max)[0])


def _pair(first: float, second: float) -> tuple[float, float] | None:
    """Return two numbers that are known only together."""
    return None if np.isnan(first) else (float(first), float(second))


def _point(scene: Scene, numbers: np.ndarray, period: int, name: str, outcome: str,
           proven: dict[str, Any]) -> CurvePoint:
    frequency, input_force, output_force, elastic, *errors = map(float, numbers)
    regime = Regime.from_json({"name": name, "period": int(period) or None, **proven})
    return CurvePoint(frequency, max_output_force=output_force, max_output_force_elastic=elastic,
                      max_input_force=input_force, regime=regime,
                      force_errors=ForceErrors(*(or_none(error) for error in errors)), state=rest(scene),
                      status=outcome)
