"""Checkpoints of a curve (checkpoints.py): finished points on disk as JSON, exact to the last bit."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from ...execution.checkpoints import CheckpointFolder
from ...results.forces import ForceErrors
from ...scene.state import State
from ..regime_criteria import Regime
from .curve import CurvePoint
from .request import CurveRequest

_NUMBERS = ("frequency", "max_output_force", "max_output_force_elastic", "max_input_force")


def point_checkpoints(request: CurveRequest, out: str | Path) -> CheckpointFolder[CurvePoint]:
    """The checkpoint folder for the points of the curve that will be written to `out`."""
    frequencies = request.frequencies
    words = (f"{request.scene.name} from {frequencies[0]:g} to {frequencies[-1]:g} Hz ({len(frequencies)}, "
             f"{request.start})")
    return CheckpointFolder(out, "curve", request.digest, words, _packed)


def points_in(folder: CheckpointFolder[CurvePoint]) -> list[CurvePoint]:
    """The points in the complete blocks, in the order in which they were finished."""
    return [_point(record) for content in folder.blocks() for record in json.loads(content)]


def _packed(points: list[CurvePoint]) -> bytes:
    return json.dumps([_as_json(point) for point in points], default=np.generic.item).encode()


def _as_json(point: CurvePoint) -> dict[str, Any]:
    state = point.state
    return {**{name: float(getattr(point, name)) for name in _NUMBERS}, "regime": point.regime.to_json(),
            "force_errors": asdict(point.force_errors), "failure": point.failure, "status": point.status,
            "state": [state.displacement.tolist(), state.velocity.tolist(), state.phase]}


def _point(record: dict[str, Any]) -> CurvePoint:
    regime = dict(record["regime"])
    for name in ("lyapunov", "window_ratios"):  # files of earlier versions lack the second
        regime[name] = tuple(regime[name]) if regime.get(name) else None
    displacement, velocity, phase = record["state"]
    return CurvePoint(**{name: record[name] for name in _NUMBERS}, regime=Regime.from_json(regime),
                      force_errors=ForceErrors(**record["force_errors"]), failure=record["failure"],
                      status=record["status"], state=State(np.array(displacement), np.array(velocity), phase))
