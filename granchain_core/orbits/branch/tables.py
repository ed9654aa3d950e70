"""A branch as tables: every orbit, every special point, and the two orbits around each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...former_names import EVENTS
from ...scene.quantities import QUANTITIES
from ...tables import MAXIMA, Column, Table, axis, contact_axis, force_columns
from ...tables.words import multiplier_columns
from .axis import KnobAxis
from .half_branch import HalfBranch
from .normal_forms import NormalForm
from .point import BranchPoint
from .special import SPECIAL_KINDS, SpecialPoint

#: Normal form written for a special point that has none.
_NO_NORMAL_FORM = NormalForm("")
#: Meaning of the column `arm`.
_HALF_BRANCH = "half-branch: 0 first, 1 second; direction in the attribute branch"
#: Contact number written for a special point that is not a grazing.
NO_CONTACT = -1


def branch_tables(over: KnobAxis, half_branches: Sequence[HalfBranch]) -> tuple[Table, ...]:
    """All tables of a branch. Orbits are listed half-branch by half-branch, each from the starting orbit."""
    points = [(place, point) for place, half in enumerate(half_branches) for point in half.points]
    special = [(place, point) for place, half in enumerate(half_branches) for point in half.special]
    return (_orbits("branch", over, [point for _, point in points], [place for place, _ in points]),
            _special(over, [point for _, point in special], [place for place, _ in special]),
            _orbits("special_before", over, [point.before for _, point in special]),
            _orbits("special_after", over, [point.after for _, point in special]))


def _orbits(name: str, over: KnobAxis, points: Sequence[BranchPoint],
            half_branches: Sequence[int] | None = None) -> Table:
    """A table with one row for each orbit. Components are the beads' displacements, then their w, scaled."""
    n, along, knob = over.scene.N, ("point",), QUANTITIES[over.knob]

    def column(attribute: str, unit: str, meaning: str, kind: type = float, name: str = "") -> dict[str, Column]:
        values: np.ndarray = np.array([getattr(point, attribute) for point in points], dtype=kind)
        return {name or attribute: Column(values, along, unit, meaning)}

    def wide(attribute: str, width: int, kind: type = float) -> np.ndarray:
        return np.array([getattr(point, attribute) for point in points], dtype=kind).reshape(len(points), width)

    longest = max((len(point.residuals) for point in points), default=1)
    residuals = np.full((len(points), longest), np.nan)
    for row, point in zip(residuals, points, strict=True):
        row[: len(point.residuals)] = point.residuals
    forces = np.array([[getattr(point, name) for name in MAXIMA] for point in points]).reshape(-1, 3)
    of_state, of_tangent = ("point", "component"), ("point", "coordinate")
    which = {} if half_branches is None else {
        "arm": Column(np.array(half_branches, dtype=np.int64), along, "1", _HALF_BRANCH)}
    return Table(name, {
        **axis("point", np.arange(len(points)), "1", "orbit along the branch"),
        **axis("component", np.arange(2 * n), "1", "displacements, then w"), **contact_axis(n),
        **axis("coordinate", np.arange(2 * n + 1), "1", "state over √(2N), then the knob's coordinate"),
        **axis("iteration", np.arange(longest), "1", "evaluation of Newton's method"),
    }, {
        **column("knob", knob.unit, knob.label), **column("arclength", "1", "arclength from the starting orbit"),
        **force_columns(forces, along, "along the orbit"),
        **column("stable", "1", "1 if no multiplier is outside", np.int8),
        "unstable": Column(np.array([point.unstable_multipliers for point in points], dtype=np.int64), along, "1",
                           "multipliers outside the unit circle"),
        **column("liouville_error", "1", "ln |det| against the integral of the trace", name="liouville"),
        "residual": Column(residuals, ("point", "iteration"), "1", "residuals of Newton's method"),
        "state": Column(wide("x", 2 * n), of_state, "1", "scaled state at phase 0"),
        "tangent": Column(wide("tangent", 2 * n + 1), of_tangent, "1", "unit tangent"),
        "slope": Column(wide("slope", 2 * n), of_state, "1", "change of the map with ζ"),
        **multiplier_columns(wide("multipliers", 2 * n, complex), of_state),
        "closings": Column(wide("closings", n + 1, np.int64), ("point", "contact"), "1",
                           "closings of each contact; 0 always open, -1 always closed"), **which})


def _special(over: KnobAxis, special: Sequence[SpecialPoint], half_branches: Sequence[int]) -> Table:
    along, unit = ("special",), QUANTITIES[over.knob].unit
    multipliers = np.array([np.nan if s.multiplier is None else s.multiplier for s in special], dtype=complex)
    forms = [_NO_NORMAL_FORM if s.normal_form is None else s.normal_form for s in special]
    contacts = np.array([NO_CONTACT if s.contact is None else s.contact for s in special], dtype=np.int64)

    def words(values: list[str]) -> np.ndarray:
        return np.array(values, dtype=object)

    def number(values: list[float]) -> np.ndarray:
        return np.array(values, dtype=float)

    return Table("special", axis("special", np.arange(len(special)), "1", "special point along the branch"), {
        "kind": Column(words([s.kind for s in special]), along, "",
                       f"{', '.join(SPECIAL_KINDS[:-1])} or {SPECIAL_KINDS[-1]}"),
        "knob": Column(number([s.knob for s in special]), along, unit,
                       "knob at the special point, the middle of its interval"),
        "knob_low": Column(number([s.interval[0] for s in special]), along, unit,
                           "lower end of the interval that contains it"),
        "knob_high": Column(number([s.interval[1] for s in special]), along, unit, "upper end of that interval"),
        "multiplier_real": Column(multipliers.real, along, "1",
                                  "multiplier that passes the unit circle, real part"),
        "multiplier_imag": Column(multipliers.imag, along, "1", "its imaginary part"),
        "contact": Column(contacts, along, "1", "contact that grazes, -1 if none"),
        "event": Column(words(["" if s.gained is None else EVENTS[s.gained] for s in special]), along, "",
                        "what the contact has once more on one side: touch (one more contact phase) or separation"),
        "criticality": Column(words([form.criticality for form in forms]), along, "",
                              "supercritical, subcritical, generic (a nondegenerate fold) or not decided"),
        "coefficient": Column(number([form.coefficient for form in forms]), along, "1",
                              "coefficient of the normal form that decides it, NaN where not computed"),
        "coefficient_error": Column(number([form.error for form in forms]), along, "1",
                                    "error of the coefficient"),
        "undecided": Column(words([form.reason for form in forms]), along, "", "why it is not decided"),
        "arm": Column(np.array(half_branches, dtype=np.int64), along, "1", _HALF_BRANCH)})
