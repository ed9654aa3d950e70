"""Branch switching: from a period doubling to the branch of twice the period.

At a multiplier −1 with eigenvector η, the orbits of twice the period lie at x ± γη + O(γ²), ζ + O(γ²). Newton's method
on the doubled map, in the plane at distance γ along η, finds one, because the trivial solution is not in that plane.
"""

from __future__ import annotations

import numpy as np

from ...errors import BadInput, ComputationError
from ...execution.stop import Stop
from .branch import Branch
from .equations import BranchEquations, Solved
from .half_branch import HalfBranch
from .point import branch_point
from .special import SpecialPoint

#: Distances γ along the eigenvector that are tried, in arclength. The knob changes by about γ² times the coefficient of
#: the normal form. Next to grazings that coefficient is large, and only the last distances are small enough.
_DISTANCES = (0.02, 0.005, 0.05, 0.001, 1e-4, 3e-5)
#: Largest change of the knob's coordinate: of order γ², but possibly with a large factor.
_LARGEST_KNOB_CHANGE = 0.3
#: Smallest difference of the orbit's halves, relative to the one expected from γ.
_LEAST_DOUBLING = 0.5


def switch_to_doubled(branch: Branch, special: SpecialPoint, stop: Stop | None = None) -> Branch:
    """Start the branch of twice the period that leads away from the period doubling `special` of `branch`.

    Raises `BadInput` for another kind of point and `ComputationError` where no doubled orbit is found.
    """
    if special.kind != "period_doubling":
        raise BadInput(f"A doubled branch begins at a period_doubling, not at a {special.kind}.")
    if special.multiplier is None:
        raise BadInput(f"At {branch.axis.text(special.knob)} this branch merges with that of half its period; "
                       "no orbit of twice its own period begins there.")
    once = BranchEquations(branch.axis, branch.period, stop)
    twice = BranchEquations(branch.axis, 2 * branch.period, stop)
    foot = special.before
    z = once.point(foot.x, foot.knob)
    direction = np.append(doubling_direction(once, foot.x, foot.knob), 0.0)
    tried = []
    for distance in _DISTANCES:
        try:
            solved = twice.solve(z + distance * direction, direction, farthest=_LARGEST_KNOB_CHANGE)
        except ComputationError as problem:
            tried.append(problem.sentence)
            continue
        x = twice.state(solved.z)
        halves = once.stroboscopic_map(twice.value(solved.z)).end(x) - x
        if np.linalg.norm(halves) / once.weight > _LEAST_DOUBLING * 2.0 * distance:
            return Branch(branch.axis, 2 * branch.period, (_half(twice, solved, direction),))
        tried.append("the orbit that was found repeats after half of its period.")
    raise ComputationError(f"No orbit of {2 * branch.period} drive periods was found near the period doubling at "
                           f"{branch.axis.text(special.knob)}: {tried[-1]}", "no-convergence")


def doubling_direction(equations: BranchEquations, x: np.ndarray, value: float) -> np.ndarray:
    """Unit eigenvector of the multiplier nearest to −1."""
    multipliers, vectors = np.linalg.eig(equations.stroboscopic_map(value)(x).derivative)
    vector = np.real(vectors[:, np.argmin(np.abs(multipliers + 1.0))])
    return vector / np.linalg.norm(vector)


def _half(equations: BranchEquations, solved: Solved, away: np.ndarray) -> HalfBranch:
    tangent = equations.tangent(solved, away)
    start = branch_point(equations, solved, tangent, 0.0)
    return HalfBranch(start.knob_direction, [start])
