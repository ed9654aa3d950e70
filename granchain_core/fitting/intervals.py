"""Profile likelihood: the least misfit with one parameter fixed, and the 95 % interval that follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, f

from .search import Problem, descend

#: [fit] Confidence level: the fraction of repetitions in which an interval contains the true value.
LEVEL = 0.95
#: [fit] Maximum number of steps towards each end of an interval.
_MOST_STEPS = 8
#: [fit] Maximum number of evaluations of a descent on the way to an end of an interval.
_DESCENT_CALLS = 6
#: [fit] Distance of √Δχ² from its limit at which the end of an interval counts as found, relative to the limit.
_ROOT_TOLERANCE = 0.03
#: [fit] A misfit that is lower than the least so far by more than this, in its unit, is another minimum.
_BETTER_BY = 0.3
#: [fit] First distance from the best value at which an end is sought if χ² has no curvature, as a fraction of the
#: range.
_FLAT_REACH = 0.25
#: [fit] Distance below which two values of a parameter are the same, as a fraction of the range.
_SAME_VALUE = 1e-9
#: [fit] Factor by which an end is sought beyond the secant's root while no value outside the interval is known.
_OVERSHOOT = 1.2
#: [fit] Least fraction of the bracket that a secant step leaves on either side.
_LEAST_PART = 0.1


class BetterMinimum(Exception):
    """A profile found a point x with a smaller misfit than the best one; the search continues from there."""

    def __init__(self, x: np.ndarray) -> None:
        super().__init__("a smaller misfit")
        self.x = x


@dataclass(frozen=True)
class Profile:
    """The profile of one parameter: values, rises of the least misfit; the interval, and which of its ends are open.

    At an open end, the misfit has not reached its limit: the end is a bound, and the data do not limit the parameter
    there, or it is the farthest value that was tried.
    """

    values: tuple[float, ...]
    rises: tuple[float, ...]
    low: float
    high: float
    open_low: bool
    open_high: bool


def limit(scale: float = 1.0, degrees_of_freedom: int | None = None) -> float:
    """Rise of the misfit at the ends of an interval for one parameter.

    If the errors are known, the rise is that of χ² with one degree of freedom. If their variance is estimated with
    `degrees_of_freedom`, from repeats or as `scale` from the fit, the rise in its unit has an F distribution.
    """
    return float(chi2.ppf(LEVEL, 1) if degrees_of_freedom is None else f.ppf(LEVEL, 1, degrees_of_freedom)) * scale


def profile(problem: Problem, best: np.ndarray, j: int, scale: float, degrees_of_freedom: int | None,
            last: bool) -> Profile:
    """Compute the profile of parameter j; `scale` and `degrees_of_freedom` are those of `limit`.

    Raises `BetterMinimum` if it finds a point that is better than `best`, unless this is the `last` attempt.
    """
    top, lowest = math.sqrt(limit(scale, degrees_of_freedom)), -math.inf if last else -_BETTER_BY * scale
    ridge, reach = _ridge(problem, best, j, top)
    rises: dict[float, float] = {float(best[j]): 0.0}
    (low, open_low), (high, open_high) = (_end(problem, best, j, ridge, sign * reach, top, lowest, rises)
                                          for sign in (-1.0, 1.0))
    parameter = problem.free[j]
    along = sorted(rises)
    return Profile(tuple(parameter.value(x) for x in along), rises=tuple(rises[x] for x in along),
                   low=parameter.value(low), high=parameter.value(high), open_low=open_low, open_high=open_high)


def _ridge(problem: Problem, best: np.ndarray, j: int, top: float) -> tuple[np.ndarray, float]:
    """The direction (P,) in which χ² rises least with parameter j, and the change of j by which √Δχ² rises to `top`.

    Both follow from the parabola at the best point.
    """
    others = _others(best, j)
    curvature = problem.curvature(best)
    ridge = np.zeros(len(best))
    if others:
        ridge[others] = -np.linalg.lstsq(curvature[np.ix_(others, others)], curvature[others, j], rcond=None)[0]
    ridge[j] = 1.0
    along = float(ridge @ curvature @ ridge)
    return ridge, min(1.0, top / math.sqrt(along)) if along > 0.0 else _FLAT_REACH


def _others(best: np.ndarray, j: int) -> list[int]:
    """The numbers of all parameters but j."""
    return [i for i in range(len(best)) if i != j]


def _end(problem: Problem, best: np.ndarray, j: int, ridge: np.ndarray, reach: float, top: float, lowest: float,
         rises: dict[float, float]) -> tuple[float, bool]:
    """Find the end of the interval on the side of `reach`, where √Δχ² crosses its limit, and whether the end is open.

    The first point is `reach` away from the best one; secants lead to the next. The rise of the misfit at each value is
    added to `rises`. Raises `BetterMinimum` if the misfit falls below the least by more than −`lowest`.
    """
    least_misfit, others, sign = problem.misfit(best), _others(best, j), math.copysign(1.0, reach)
    bound = 1.0 if sign > 0.0 else 0.0
    inside, root_inside = float(best[j]), 0.0
    outside, root_outside = math.nan, math.nan
    start, trial = best, best[j] + reach
    for _ in range(_MOST_STEPS):
        trial = min(max(trial, 0.0), 1.0)
        if abs(trial - inside) < _SAME_VALUE:
            break
        x = np.clip(start + ridge * (trial - start[j]), 0.0, 1.0)
        x[j] = trial
        x = descend(problem, x, others, _DESCENT_CALLS)
        rise = problem.misfit(x) - least_misfit
        if rise < lowest:
            raise BetterMinimum(x)
        root = math.sqrt(max(rise, 0.0))
        rises[float(trial)] = max(rise, 0.0)
        if root <= top:
            inside, root_inside, start = trial, root, x
        else:
            outside, root_outside = trial, root
        if abs(root - top) < _ROOT_TOLERANCE * top:
            return trial, False
        if root <= top and trial == bound:
            return bound, True
        if math.isnan(outside):
            slope = root_inside / abs(inside - best[j]) if root_inside > 0.0 else 0.0
            ahead = (top - root_inside) / slope if slope > 0.0 else 2.0 * abs(inside - best[j])
            trial = inside + sign * min(_OVERSHOOT * ahead, 2.0 * abs(inside - best[j]) + 1e-6)
        else:
            part = (top - root_inside) / (root_outside - root_inside)
            trial = inside + min(max(part, _LEAST_PART), 1.0 - _LEAST_PART) * (outside - inside)
    if math.isnan(outside):
        return inside, True  # the limit was never crossed: how far the interval extends is not known
    return inside + (top - root_inside) / (root_outside - root_inside) * (outside - inside), False
