"""Reading the curves that `save_curve` wrote."""

from __future__ import annotations

import json
from pathlib import Path

import h5py
import numpy as np

from ..errors import BadInput
from ..result import ForceErrors
from ..scene import Scene
from ..state import rest
from ..steady.curve import Curve, CurvePoint
from ..steady.regime import Regime
from .files import _MAXIMA, SCHEMA, _or_none

_COLUMNS = ("frequency", *_MAXIMA, "error_estimate_input", "error_estimate", "error_estimate_elastic", "period")


def load_curve(path: str | Path) -> Curve:
    """The curve in a file: forces, errors, regimes and periods; neither the evidence for a regime nor states are there.

    Raises `BadInput` for a file that is not one.
    """
    try:
        with h5py.File(path, "r") as file:
            if int(file.attrs["granchain_schema"]) != SCHEMA:
                raise BadInput(f"{path}: schema {file.attrs['granchain_schema']}, this version reads {SCHEMA}.")
            scene = Scene.from_json(json.loads(file.attrs["scene"]))
            columns = np.array([file["curve"][name][()] for name in _COLUMNS], dtype=float)
            names, outcomes = (file["curve"][name].asstr()[()] for name in ("regime", "status"))
            points = [_point(scene, *one) for one in zip(columns.T, names, outcomes, strict=True)]
            return Curve(scene, str(file.attrs["start"]), points, float(file.attrs["wall_s"]))
    except BadInput:
        raise
    except (OSError, KeyError, TypeError, ValueError, AttributeError) as problem:
        raise BadInput(f"{path} is not a curve written by granchain: {problem}.") from None


def _point(scene: Scene, numbers: np.ndarray, name: str, outcome: str) -> CurvePoint:
    frequency, entered, arrived, elastic, *errors = map(float, numbers[:-1])
    return CurvePoint(frequency, arrived, elastic, entered, Regime(name, int(numbers[-1]) or None, None, None, 0),
                      ForceErrors(*(_or_none(error) for error in errors)), rest(scene), status=outcome)
