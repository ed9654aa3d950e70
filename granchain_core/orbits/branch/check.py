"""Checks that every branch must pass, whatever its chain and knob."""

from __future__ import annotations

import numpy as np

from ...steady.residuals import ACCEPTED_RESIDUAL
from ..orbit import ROUNDING
from .branch import Branch
from .half_branch import HalfBranch
from .point import BranchPoint
from .steps import LONGEST_STEP

#: Factor by which neighbours may be farther apart than the longest step, to which the correction adds.
_DISTANCE_FACTOR = 1.2
#: Error of Liouville's formula allowed in addition to the rounding of the multipliers. Motion, tangents and trace share
#: their steps, so it was at most 8e-7 on branches of sec2, of the rig, with preload and with Tsuji's law.
_LIOUVILLE_ERROR = 1e-5


def check_branch(branch: Branch) -> list[str]:
    """Return a sentence for each violated invariant; none for a correct branch.

    The invariants: residuals are small, neighbours are near, and Liouville's formula is satisfied. Stability, direction
    and the closings of each contact change only at reported special points, and each of these is in its interval,
    between two orbits that differ.
    """
    faults = []
    for half in branch.half_branches:
        for point in half.points:
            faults.extend(_orbit_wrong(branch, point))
        for i in range(1, len(half.points)):
            faults.extend(_step_wrong(branch, half, i))
        faults.extend(_special_wrong(branch, half))
    return faults


def _orbit_wrong(branch: Branch, point: BranchPoint) -> list[str]:
    where, faults = branch.axis.text(point.knob), []
    if not point.residual <= ACCEPTED_RESIDUAL:
        faults.append(f"residual {point.residual:.1e} at {where}")
    smallest, largest = np.abs(point.multipliers[-1]), max(1.0, float(np.abs(point.multipliers[0])))
    # where the smallest multiplier is a rounding error, its logarithm is meaningless
    rounding = len(point.multipliers) * np.finfo(float).eps * largest / smallest
    if smallest >= ROUNDING * largest and point.liouville_error > _LIOUVILLE_ERROR + rounding:
        faults.append(f"Liouville is off by {point.liouville_error:.1e} at {where}")
    return faults


def _step_wrong(branch: Branch, half: HalfBranch, i: int) -> list[str]:
    a, b, faults = half.points[i - 1], half.points[i], []
    where = f"between {branch.axis.text(a.knob)} and {branch.axis.text(b.knob)}"
    moved = np.append((b.x - a.x) / np.sqrt(len(a.x)), branch.axis.coordinate(b.knob) - branch.axis.coordinate(a.knob))
    if np.linalg.norm(moved) > _DISTANCE_FACTOR * LONGEST_STEP or not b.arclength > a.arclength:
        faults.append(f"neighbours are {np.linalg.norm(moved):.2g} apart {where}")
    between = [s for s in half.special if a.arclength <= s.before.arclength and s.after.arclength <= b.arclength
               and s.before.arclength < b.arclength]
    if a.stable != b.stable and not any(s.multiplier is not None for s in between):
        faults.append(f"stability changes without a special point {where}")
    if a.doubling_sign != b.doubling_sign and not any(s.kind == "period_doubling" for s in between):
        faults.append(f"a multiplier passes -1 without a period doubling {where}")
    if a.knob_direction != b.knob_direction and not any(s.kind == "fold" for s in between):
        faults.append(f"the knob turns without a fold {where}")
    for contact in np.flatnonzero(a.closings != b.closings):
        if not any(s.contact == contact for s in between):
            faults.append(f"contact {contact} closes more or less often without a grazing {where}")
    return faults


def _special_wrong(branch: Branch, half: HalfBranch) -> list[str]:
    faults = []
    for s in half.special:
        where, (low, high) = f"{s.kind} at {branch.axis.text(s.knob)}", s.interval
        if not low <= s.knob <= high:
            faults.append(f"{where} is outside its interval")
        if s.before.signature == s.after.signature:
            faults.append(f"{where} lies between orbits that are alike")
        inside = [low - 1e-12 * abs(low) <= p.knob <= high + 1e-12 * abs(high) for p in (s.before, s.after)]
        if s.before.knob_direction == s.after.knob_direction and not all(inside):
            faults.append(f"{where} has orbits outside its interval")
    return faults
