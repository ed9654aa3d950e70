"""Branches in HDF5: every orbit, every special point, and the data needed to continue.

/branch          point, component, bead, contact; knob (the knob's unit), arclength, max_input_force, max_output_force,
                 max_output_force_elastic [N], stable, unstable, residual, arm (point); state, multiplier_real,
                 multiplier_imag (point, component); tangent (point, coordinate); closings (point, contact)
/special         kind, knob, knob_low, knob_high, multiplier_real, multiplier_imag, contact, event, arm (special); and
                 criticality, coefficient, coefficient_error, undecided (special), which older files lack
/special_before, /special_after   the two orbits around each special point, as in /branch
/turns           extrema of the overlaps on each half-branch's last orbit, with which the next step is compared
The root's attribute `amplitude` describes A0 over f if it is not the scene's. `coordinate` says that ζ is linear in the
static overlap. Older files over F0 lack it: there, ζ is linear in F0, and their branches continue that way.
Components are the beads' displacements, then their w, scaled by the chain's own A0 and A0·φ (docs/model.md).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..former_names import EVENTS
from ..hdf5 import File, opened
from ..hdf5.checked_file import entries, finite, one_of, within
from ..hdf5.plain import Refused
from ..orbits import Branch, BranchPoint, HalfBranch, KnobAxis, SpecialPoint
from ..orbits.branch.normal_forms import CRITICALITIES, EARLIER_REASONS, NOT_DECIDED, REASONS, NormalForm
from ..orbits.branch.special import SPECIAL_KINDS
from ..orbits.branch.tables import NO_CONTACT, branch_tables
from ..scene import Amplitude
from ..steady.regime_criteria import LONGEST_LOCKED_PERIOD
from ..tables import MAXIMA
from .writing import write_file, write_result

#: Ends of half-branches.
_ENDS = ("", "reached", "returned", "closed", "merged", "lost")
#: The interval that a contact gains, by its name in files.
_GAINED = {event: gained for gained, event in EVENTS.items()}
#: Numbers of one extremum of an overlap.
_EXTREMUM = 4


def save_branch(branch: Branch, path: str | Path) -> Path:
    """Write a branch, finished or not, and return the path. Raises `BadInput` if it cannot be written."""
    return write_file(path, lambda file: write_branch(file, branch))


def write_branch(file: h5py.File, branch: Branch) -> None:
    """Write a branch with everything needed to continue it."""
    write_result(file, branch)
    turns = file.create_group("turns")
    for place, half in enumerate(branch.half_branches):
        turns.create_dataset(str(place), data=half.points[-1].overlap_extrema)


def load_branch(path: str | Path) -> Branch:
    """Return the branch that `save_branch` wrote, ready to be continued. Raises `BadInput` for any other file."""
    with opened(path, "is not a branch written by granchain") as file:
        file.schema()
        return _read(file)


# --- reading ------------------------------------------------------------------------------------------------


def _read(file: File) -> Branch:
    header, scene = _header(file.json("branch")), file.scene()
    amplitude = Amplitude.from_json(file.json("amplitude")) if file.stated("amplitude") else None
    axis = KnobAxis.of(scene, header["knob"], header["start"], header["end"], amplitude)
    if axis.by_overlap and not file.stated("coordinate"):
        axis = replace(axis, by_overlap=False)
    for table in branch_tables(axis, ()):
        file.expect_units(table.units)
    points = _read_orbits(file, "branch", axis)
    place = _places(file, "branch/arm", len(points), len(header["arms"]))
    special = _read_special(file, axis)
    special_place = _places(file, "special/arm", len(special), len(header["arms"]))
    half_branches = []
    for number, half in enumerate(header["arms"]):
        points_here = [p for p, where in zip(points, place, strict=True) if where == number]
        if not points_here:
            raise Refused(f"half-branch {number} has no orbits")
        extrema = file.numbers(f"turns/{number}", (*file.shape(f"turns/{number}")[:1], _EXTREMUM))
        object.__setattr__(points_here[-1], "overlap_extrema", extrema)
        special_here = [s for s, where in zip(special, special_place, strict=True) if where == number]
        half_branches.append(HalfBranch(half["direction"], points=points_here, special=special_here, step=half["step"],
                                        ended=half["ended"], reason=half["reason"]))
    return Branch(axis, header["period"], tuple(half_branches))


def _header(attribute: Any) -> dict[str, Any]:
    """Return the attribute `branch`, with checked entries and one or two half-branches."""
    half_branches = attribute.pop("arms", None) if isinstance(attribute, dict) else None
    header = entries("branch", attribute, {"knob": "text", "start": "number", "end": "number", "period": "whole"})
    if not isinstance(half_branches, list) or not 1 <= len(half_branches) <= 2:
        raise Refused("its attribute branch does not have one half-branch or two")
    if not 1 <= header["period"] <= LONGEST_LOCKED_PERIOD:
        raise Refused(f"its period {header['period']} is outside 1 to {LONGEST_LOCKED_PERIOD}")
    header["arms"] = [entries("arm", half, {"direction": "number", "step": "text", "ended": "text", "reason": "text"})
                      for half in half_branches]
    for half in header["arms"]:
        half["step"] = finite("step", float.fromhex(half["step"]))
        if half["direction"] not in (-1, 1):
            raise Refused(f"direction {half['direction']} is neither 1 nor -1")
        one_of("ended", half["ended"], _ENDS)
    return header


def _places(file: File, path: str, count: int, half_branches: int) -> np.ndarray:
    """Return the number of each row's half-branch."""
    return within(f"/{path}", file.numbers(path, (count,), "i"), 0, half_branches - 1)


def _read_orbits(file: File, group: str, axis: KnobAxis) -> list[BranchPoint]:
    n = axis.scene.N
    count, longest = file.shape(f"{group}/residual")
    read = {name: file.numbers(f"{group}/{name}", (count, *width)) for name, width in (
        ("knob", ()), ("state", (2 * n,)), ("tangent", (2 * n + 1,)), ("slope", (2 * n,)), ("arclength", ()),
        ("multiplier_real", (2 * n,)), ("multiplier_imag", (2 * n,)), *((force, ()) for force in MAXIMA),
        ("residual", (longest,)), ("liouville", ()))}
    closings = file.numbers(f"{group}/closings", (count, n + 1), "i")
    if count and np.isnan(read["residual"][:, :1]).any():
        raise Refused(f"/{group}/residual has orbits without a residual")
    return [BranchPoint(
        knob=float(read["knob"][i]), x=read["state"][i], tangent=read["tangent"][i], slope=read["slope"][i],
        arclength=float(read["arclength"][i]),
        multipliers=read["multiplier_real"][i] + 1j * read["multiplier_imag"][i],
        **{force: float(read[force][i]) for force in MAXIMA}, closings=closings[i],
        residuals=tuple(float(r) for r in read["residual"][i] if not np.isnan(r)),
        liouville_error=float(read["liouville"][i]), overlap_extrema=np.zeros((0, _EXTREMUM)),
        damped=axis.damped_at(float(read["knob"][i])),
    ) for i in range(count)]


def _read_special(file: File, axis: KnobAxis) -> list[SpecialPoint]:
    before, after = (_read_orbits(file, f"special_{side}", axis) for side in ("before", "after"))
    count = len(before)
    read = {name: file.numbers(f"special/{name}", (count,)) for name in (
        "knob", "knob_low", "knob_high", "multiplier_real", "multiplier_imag")}
    contacts = within("/special/contact", file.numbers("special/contact", (count,), "i"), NO_CONTACT, axis.scene.N)
    forms = _read_normal_forms(file, count)
    kinds, events = file.words("special/kind", count, SPECIAL_KINDS), file.words("special/event", count, ("", *_GAINED))
    return [SpecialPoint(
        kind=kinds[i], knob=float(read["knob"][i]), interval=(float(read["knob_low"][i]), float(read["knob_high"][i])),
        before=before[i], after=after[i],
        multiplier=(None if np.isnan(read["multiplier_real"][i])
                    else complex(read["multiplier_real"][i], read["multiplier_imag"][i])),
        contact=None if contacts[i] == NO_CONTACT else int(contacts[i]), gained=_GAINED.get(events[i]),
        normal_form=forms[i]) for i in range(count)]


def _read_normal_forms(file: File, count: int) -> list[NormalForm | None]:
    if not file.has("special/criticality"):
        return [None] * count
    criticalities = file.words("special/criticality", count, ("", *CRITICALITIES))
    reasons = [EARLIER_REASONS.get(reason, reason)
               for reason in file.words("special/undecided", count, ("", *REASONS, *EARLIER_REASONS))]
    numbers, errors = (file.numbers(f"special/{name}", (count,)) for name in ("coefficient", "coefficient_error"))
    if any((word == NOT_DECIDED) != bool(reason) for word, reason in zip(criticalities, reasons, strict=True)):
        raise Refused("/special/undecided does not fit /special/criticality")
    return [NormalForm(criticalities[i], float(numbers[i]), float(errors[i]), reasons[i]) if criticalities[i] else None
            for i in range(count)]
