"""Checkpoints of a branch (checkpoints.py): finished orbits on disk as JSON, exact to the last bit.

A piece contains what a half-branch has gained: its new orbits and special points, the index of the first of each, and
the step with which it continues or the reason why it ended.
"""

from __future__ import annotations

import json
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from ...execution.checkpoints import CheckpointFolder, digest_of
from ...former_names import EVENTS
from .axis import STATIC_OVERLAP, KnobAxis
from .branch import Branch
from .half_branch import HalfBranch
from .normal_forms import EARLIER_REASONS, NormalForm
from .point import BranchPoint
from .special import SpecialPoint

#: Entries of a point that are arrays.
_ARRAYS = ("x", "tangent", "multipliers", "closings", "slope", "overlap_extrema")
#: Entries of a point that keep their former names in checkpoint files.
_FORMER = {"liouville_error": "liouville", "overlap_extrema": "turns"}


def asked_digest(axis: KnobAxis, both: bool) -> str:
    """Hash of all arguments that determine a branch, except its period, which may be that of the settled motion."""
    driven = {} if axis.amplitude is None else {"amplitude": axis.amplitude.to_json()}
    coordinate = {"coordinate": STATIC_OVERLAP} if axis.by_overlap else {}
    return digest_of({"scene": axis.scene.digest, "knob": axis.knob, "from": axis.start, "to": axis.end, "both": both,
                      **driven, **coordinate})


class OrbitCheckpoints:
    """The folder of one branch, which grows with the branch; each half-branch may have its own thread."""

    def __init__(self, axis: KnobAxis, both: bool, out: str | Path) -> None:
        self._axis, self._directions = axis, 1 + both
        words = f"{axis.scene.name} over {axis.knob} = {axis.start:g} … {axis.end:g}{', both ways' if both else ''}"
        self.folder: CheckpointFolder[dict[str, Any]] = CheckpointFolder(
            out, "branch", asked_digest(axis, both), words, _packed)
        self._written: dict[int, tuple[int, int]] = {}

    def asks_for(self, branch: Branch) -> bool:
        """Whether a branch is the one in this folder; a closed one may have only one of its two half-branches left."""
        both = self._directions > 1 if branch.half_branches[0].ended == "closed" else len(branch.half_branches) > 1
        return asked_digest(branch.axis, both) == asked_digest(self._axis, self._directions > 1)

    def add(self, period: int, half: HalfBranch) -> None:
        """Add the orbits and special points that a half-branch has gained since the last call."""
        points, special = self._written.get(half.direction, (0, 0))
        self._written[half.direction] = len(half.points), len(half.special)
        self.folder.add({"period": period, "direction": half.direction, "first": [points, special],
                         "points": [_as_json(point) for point in half.points[points:]],
                         "special": [special_as_json(point) for point in half.special[special:]],
                         "step": half.step.hex(), "ended": half.ended, "reason": half.reason})

    def begin(self, branch: Branch) -> None:
        """Add a branch in its state before it is continued."""
        for half in branch.half_branches:
            if self._written.get(half.direction) != (len(half.points), len(half.special)):
                self.add(branch.period, half)

    def branch(self) -> Branch | None:
        """The branch in the blocks, each half-branch up to its first missing orbit; None if a start is missing."""
        halves: dict[int, HalfBranch] = {}
        period = 0
        for content in self.folder.blocks():
            for record in json.loads(content):
                half = halves.setdefault(record["direction"], HalfBranch(record["direction"], []))
                if record["first"] == [len(half.points), len(half.special)]:
                    half.points += [_point(entry) for entry in record["points"]]
                    half.special += [special_from_json(entry) for entry in record["special"]]
                    half.step = float.fromhex(record["step"])
                    half.ended, half.reason = record["ended"], record["reason"]
                    period = record["period"]
        halves = {direction: half for direction, half in halves.items() if half.points}
        if len(halves) < self._directions:
            return None
        self._written = {direction: (len(half.points), len(half.special)) for direction, half in halves.items()}
        return Branch(self._axis, period, tuple(halves[direction] for direction in sorted(halves, reverse=True)))


def _packed(pieces: list[dict[str, Any]]) -> bytes:
    return json.dumps(pieces, default=np.generic.item).encode()


def _as_json(point: BranchPoint) -> dict[str, Any]:
    record = {entry.name: getattr(point, entry.name) for entry in fields(BranchPoint)}
    for name in _ARRAYS:
        record[name] = np.asarray(record[name])
    record["multipliers"] = np.stack([record["multipliers"].real, record["multipliers"].imag])
    return {_FORMER.get(name, name): value.tolist() if isinstance(value, np.ndarray) else value
            for name, value in record.items()}


def _point(entries: dict[str, Any]) -> BranchPoint:
    record = {entry.name: entries[_FORMER.get(entry.name, entry.name)] for entry in fields(BranchPoint)}
    arrays: dict[str, Any] = {name: np.array(record[name], dtype=int if name == "closings" else float)
                              for name in _ARRAYS if name != "multipliers"}
    real, imaginary = np.array(record["multipliers"])
    multipliers = np.empty(len(real), dtype=complex)
    multipliers.real, multipliers.imag = real, imaginary
    arrays["overlap_extrema"] = arrays["overlap_extrema"].reshape(-1, 4)
    return BranchPoint(**{**record, **arrays, "multipliers": multipliers, "residuals": tuple(record["residuals"])})


def special_as_json(point: SpecialPoint) -> dict[str, Any]:
    """A special point as a JSON record; `special_from_json` restores it to the last bit."""
    multiplier = None if point.multiplier is None else [complex(point.multiplier).real, complex(point.multiplier).imag]
    return {"kind": point.kind, "knob": point.knob, "interval": list(point.interval), "before": _as_json(point.before),
            "after": _as_json(point.after), "multiplier": multiplier, "contact": point.contact,
            "event": point.gained and EVENTS[point.gained],
            "normal_form": None if point.normal_form is None else asdict(point.normal_form)}


def special_from_json(record: dict[str, Any]) -> SpecialPoint:
    """The special point in a record from `special_as_json`."""
    multiplier = None if record["multiplier"] is None else complex(*record["multiplier"])
    form = record.get("normal_form")  # earlier versions had none
    if form:
        form = {**form, "reason": EARLIER_REASONS.get(form["reason"], form["reason"])}
    gained = {event: gained for gained, event in EVENTS.items()}.get(record["event"])
    known = {name: value for name, value in record.items() if name != "event"}
    return SpecialPoint(**{**known, "gained": gained, "interval": tuple(record["interval"]),
                           "before": _point(record["before"]), "after": _point(record["after"]),
                           "multiplier": multiplier,
                           "normal_form": NormalForm(**form) if form else None})
