"""Branches in HDF5: every orbit, every special point, and the data needed to go on.

/branch          point, component, bead, contact; knob (the knob's unit), arclength, max_input_force, max_output_force,
                 max_output_force_elastic [N], stable, unstable, residual, arm (point); state, multiplier_real,
                 multiplier_imag (point, component); tangent (point, coordinate); closings (point, contact)
/special         kind, knob, knob_low, knob_high, multiplier_real, multiplier_imag, contact, event, arm (special)
/special_before, /special_after   the two orbits around each special point, as in /branch
/turns           turning points of the overlaps on each arm's last orbit, with which the next step is compared
The root's attribute `amplitude` describes A0 over f where it is not the scene's.
Components are the beads' displacements, then their w, scaled by the chain's own A0 and A0·φ (docs/model.md).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..hdf5 import File, opened
from ..hdf5.border import entries, finite, one_of, within
from ..hdf5.plain import Refused
from ..integrate.methods import CERTIFIED
from ..kernels.strobes.periodicity import LONGEST_PERIOD
from ..orbits import Arm, Branch, BranchPoint, KnobAxis, SpecialPoint
from ..quantities import QUANTITIES
from ..scene import Amplitude
from .writing import write_axis, write_file, write_root, write_values

_FORCES = ("max_input_force", "max_output_force", "max_output_force_elastic")
_NONE = -1
#: How an arm can have ended, kinds of special points, and what grazes.
_ENDS = ("", "reached", "returned", "closed", "merged", "lost")
_KINDS = ("fold", "period_doubling", "neimark_sacker", "grazing")
_EVENTS = ("", "touch", "separation")
#: Numbers of one turning point.
_TURN = 4


def save_branch(branch: Branch, path: str | Path) -> Path:
    """Write a branch, finished or not; returns the path. Raises `BadInput` where it cannot be written."""

    def write(file: h5py.File) -> None:
        write_root(file, branch.axis.scene, CERTIFIED, None)
        file.attrs["branch"] = json.dumps({
            "knob": branch.axis.knob, "start": branch.axis.start, "end": branch.axis.end, "period": branch.period,
            "arms": [{"direction": arm.direction, "step": arm.step.hex(), "ended": arm.ended, "reason": arm.reason}
                     for arm in branch.arms]})
        if branch.axis.amplitude is not None:
            file.attrs["amplitude"] = json.dumps(branch.axis.amplitude.to_json())
        numbered = [(place, point) for place, arm in enumerate(branch.arms) for point in arm.points]
        group = _orbits(file, "branch", branch, [point for _, point in numbered])
        write_values(group, "arm", np.array([place for place, _ in numbered]), ("point",), "1",
                     "which way from the seed")
        special = [(place, one) for place, arm in enumerate(branch.arms) for one in arm.special]
        _special(file.create_group("special"), branch, special)
        _orbits(file, "special_before", branch, [one.before for _, one in special])
        _orbits(file, "special_after", branch, [one.after for _, one in special])
        turns = file.create_group("turns")
        for place, arm in enumerate(branch.arms):
            turns.create_dataset(str(place), data=arm.points[-1].turns)

    return write_file(path, write)


def load_branch(path: str | Path) -> Branch:
    """The branch that `save_branch` wrote, ready to be continued. Raises `BadInput` for a file that is not one."""
    with opened(path, "is not a branch written by granchain") as file:
        file.schema()
        return _read(file)


# --- writing ------------------------------------------------------------------------------------------------


def _orbits(file: h5py.File, name: str, branch: Branch, points: list[BranchPoint]) -> h5py.Group:
    """A group with one row for each orbit."""
    group, n = file.create_group(name), branch.axis.scene.N

    def column(attribute: str) -> np.ndarray:
        return np.array([getattr(point, attribute) for point in points], dtype=float)

    def table(attribute: str, width: int, kind: type) -> np.ndarray:
        return np.array([getattr(point, attribute) for point in points], dtype=kind).reshape(len(points), width)

    quantity = QUANTITIES[branch.axis.knob]
    longest = max((len(point.residuals) for point in points), default=1)
    multipliers = table("multipliers", 2 * n, complex)
    for scale, size, meaning in (
            ("point", len(points), "orbit along the branch"), ("component", 2 * n, "displacements, then w"),
            ("contact", n + 1, "contact number; c joins bodies c and c + 1"),
            ("coordinate", 2 * n + 1, "state over √(2N), then the knob's coordinate"),
            ("iteration", longest, "evaluation of Newton's method")):
        write_axis(group, scale, np.arange(size), "1", meaning)
    write_values(group, "knob", column("knob"), ("point",), quantity.unit, quantity.label)
    write_values(group, "arclength", column("arclength"), ("point",), "1", "arclength from the seed")
    for force in _FORCES:
        words = force.replace("_", " ").replace("max", "largest", 1)
        write_values(group, force, column(force), ("point",), "N", f"{words} along the orbit")
    write_values(group, "stable", column("stable").astype(np.int8), ("point",), "1", "1 if no multiplier is outside")
    write_values(group, "unstable", column("unstable").astype(int), ("point",), "1",
                 "multipliers outside the unit circle")
    write_values(group, "liouville", column("liouville"), ("point",), "1", "ln |det| against the integral of the trace")
    residuals = np.full((len(points), longest), np.nan)
    for row, point in zip(residuals, points, strict=True):
        row[: len(point.residuals)] = point.residuals
    write_values(group, "residual", residuals, ("point", "iteration"), "1", "residuals of Newton's method")
    write_values(group, "state", table("x", 2 * n, float), ("point", "component"), "1", "scaled state at phase 0")
    write_values(group, "tangent", table("tangent", 2 * n + 1, float), ("point", "coordinate"), "1", "unit tangent")
    write_values(group, "slope", table("slope", 2 * n, float), ("point", "component"), "1", "change of the map with p")
    write_values(group, "multiplier_real", multipliers.real, ("point", "component"), "1", "multipliers, real part")
    write_values(group, "multiplier_imag", multipliers.imag, ("point", "component"), "1", "multipliers, imaginary part")
    write_values(group, "closings", table("closings", n + 1, int), ("point", "contact"), "1",
              "closings of each contact; 0 always open, -1 always closed")
    return group


def _special(group: h5py.Group, branch: Branch, special: list[tuple[int, SpecialPoint]]) -> None:
    unit, words = QUANTITIES[branch.axis.knob].unit, h5py.string_dtype()
    multipliers = np.array([np.nan if s.multiplier is None else s.multiplier for _, s in special], dtype=complex)
    write_axis(group, "special", np.arange(len(special)), "1", "special point along the branch")

    def variable(name: str, values: Any, its: str, meaning: str) -> None:
        write_values(group, name, values, ("special",), its, meaning)

    variable("kind", np.array([s.kind for _, s in special], dtype=words), "",
             "fold, period_doubling, neimark_sacker or grazing")
    variable("knob", np.array([s.knob for _, s in special]), unit, "knob at the special point")
    variable("knob_low", np.array([s.interval[0] for _, s in special]), unit, "lower end of the interval that holds it")
    variable("knob_high", np.array([s.interval[1] for _, s in special]), unit, "upper end of that interval")
    variable("multiplier_real", multipliers.real, "1", "multiplier that passes the unit circle, real part")
    variable("multiplier_imag", multipliers.imag, "1", "its imaginary part")
    variable("contact", np.array([_NONE if s.contact is None else s.contact for _, s in special], dtype=int), "1",
             "contact that grazes, -1 if none")
    variable("event", np.array([s.event or "" for _, s in special], dtype=words), "", "touch or separation")
    variable("arm", np.array([place for place, _ in special], dtype=int), "1", "which way from the seed")


# --- reading ------------------------------------------------------------------------------------------------


def _read(file: File) -> Branch:
    told, scene = _told(file.json("branch")), file.scene()
    amplitude = Amplitude.from_json(file.json("amplitude")) if file.stated("amplitude") else None
    axis = KnobAxis.of(scene, told["knob"], told["start"], told["end"], amplitude)
    points = _read_orbits(file, "branch", scene.N)
    place = _places(file, "branch/arm", len(points), len(told["arms"]))
    special = _read_special(file, scene.N)
    special_place = _places(file, "special/arm", len(special), len(told["arms"]))
    arms = []
    for number, arm in enumerate(told["arms"]):
        mine = [p for p, where in zip(points, place, strict=True) if where == number]
        if not mine:
            raise Refused(f"arm {number} has no orbits")
        turns = file.numbers(f"turns/{number}", (*file.shape(f"turns/{number}")[:1], _TURN))
        object.__setattr__(mine[-1], "turns", turns)
        arms.append(Arm(arm["direction"], mine,
                        [s for s, where in zip(special, special_place, strict=True) if where == number],
                        arm["step"], arm["ended"], arm["reason"]))
    return Branch(axis, told["period"], tuple(arms))


def _told(found: Any) -> dict[str, Any]:
    """The attribute `branch`, each entry of its kind; one or two arms."""
    arms = found.pop("arms", None) if isinstance(found, dict) else None
    told = entries("branch", found, {"knob": "text", "start": "number", "end": "number", "period": "whole"})
    if not isinstance(arms, list) or not 1 <= len(arms) <= 2:
        raise Refused("its attribute branch does not have one arm or two")
    if not 1 <= told["period"] <= LONGEST_PERIOD:
        raise Refused(f"its period {told['period']} is outside 1 to {LONGEST_PERIOD}")
    told["arms"] = [entries("arm", arm, {"direction": "number", "step": "text", "ended": "text", "reason": "text"})
                    for arm in arms]
    for arm in told["arms"]:
        arm["step"] = finite("step", float.fromhex(arm["step"]))
        if arm["direction"] not in (-1, 1):
            raise Refused(f"direction {arm['direction']} is neither 1 nor -1")
        one_of("ended", arm["ended"], _ENDS)
    return told


def _places(file: File, path: str, count: int, arms: int) -> np.ndarray:
    """The arm of each row."""
    return within(f"/{path}", file.numbers(path, (count,), "i"), 0, arms - 1)


def _read_orbits(file: File, group: str, n: int) -> list[BranchPoint]:
    count, longest = file.shape(f"{group}/residual")
    read = {name: file.numbers(f"{group}/{name}", (count, *width)) for name, width in (
        ("knob", ()), ("state", (2 * n,)), ("tangent", (2 * n + 1,)), ("slope", (2 * n,)), ("arclength", ()),
        ("multiplier_real", (2 * n,)), ("multiplier_imag", (2 * n,)), *((force, ()) for force in _FORCES),
        ("residual", (longest,)), ("liouville", ()))}
    closings = file.numbers(f"{group}/closings", (count, n + 1), "i")
    if count and np.isnan(read["residual"][:, :1]).any():
        raise Refused(f"/{group}/residual has orbits without a residual")
    return [BranchPoint(
        knob=float(read["knob"][i]), x=read["state"][i], tangent=read["tangent"][i], slope=read["slope"][i],
        arclength=float(read["arclength"][i]),
        multipliers=read["multiplier_real"][i] + 1j * read["multiplier_imag"][i],
        **{force: float(read[force][i]) for force in _FORCES}, closings=closings[i],
        residuals=tuple(float(r) for r in read["residual"][i] if not np.isnan(r)),
        liouville=float(read["liouville"][i]), turns=np.zeros((0, _TURN)),
    ) for i in range(count)]


def _read_special(file: File, n: int) -> list[SpecialPoint]:
    before, after = (_read_orbits(file, f"special_{side}", n) for side in ("before", "after"))
    count = len(before)
    read = {name: file.numbers(f"special/{name}", (count,)) for name in (
        "knob", "knob_low", "knob_high", "multiplier_real", "multiplier_imag")}
    contacts = within("/special/contact", file.numbers("special/contact", (count,), "i"), _NONE, n)
    kinds, events = file.words("special/kind", count, _KINDS), file.words("special/event", count, _EVENTS)
    return [SpecialPoint(
        kind=kinds[i], knob=float(read["knob"][i]), interval=(float(read["knob_low"][i]), float(read["knob_high"][i])),
        before=before[i], after=after[i],
        multiplier=(None if np.isnan(read["multiplier_real"][i])
                    else complex(read["multiplier_real"][i], read["multiplier_imag"][i])),
        contact=None if contacts[i] == _NONE else int(contacts[i]), event=events[i] or None) for i in range(count)]
