"""Profile likelihood: the least misfit with one parameter fixed, and the 95 % interval that follows from it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2, f

from .search import Problem, descend

#: [fit] Part of repetitions in which an interval holds the truth.
LEVEL = 0.95
#: [fit] Most steps towards each end of an interval.
_MOST_STEPS = 8
#: [fit] Most evaluations of a descent on the way to an end of an interval.
_DESCENT_CALLS = 6
#: [fit] Distance of √Δχ² from its limit at which the end of an interval is found, relative to the limit.
_ROOT_TOLERANCE = 0.03
#: [fit] A misfit lower than the least so far by this, in its unit, is another minimum.
_BETTER_BY = 0.3
#: [fit] First distance from the best value at which an end is sought where χ² has no curvature, as a part of the range.
_FLAT_REACH = 0.25
#: [fit] Distance of two values of a parameter below which they are the same, as a fraction of the range.
_SAME_VALUE = 1e-9
#: [fit] By how much farther than the secant's root an end is sought while no value outside is known.
_OVERSHOOT = 1.2
#: [fit] Least part of the bracket that a step of the secant leaves on either side.
_LEAST_PART = 0.1


class BetterMinimum(Exception):
    """A profile found a point x with a smaller misfit than the best one; the search goes on from there."""

    def __init__(self, x: np.ndarray) -> None:
        super().__init__("a smaller misfit")
        self.x = x


@dataclass(frozen=True)
class Profile:
    """The profile of one parameter: values and least misfits above the minimum; the interval, and which ends are open.

    At an open end the misfit is not yet too large: the end is a bound, and the data do not limit the parameter there,
    or it is the farthest value that was tried.
    """

    values: tuple[float, ...]
    rises: tuple[float, ...]
    low: float
    high: float
    open_low: bool
    open_high: bool


def limit(scale: float = 1.0, degrees_of_freedom: int | None = None) -> float:
    """Rise of the misfit at the ends of an interval for one parameter.

    Where the errors are known it is that of χ² with one degree of freedom. Where their variance is estimated, from
    repeats or as `scale` from the fit, with so many `degrees_of_freedom`, the rise in its unit has the distribution F.
    """
    return float(chi2.ppf(LEVEL, 1) if degrees_of_freedom is None else f.ppf(LEVEL, 1, degrees_of_freedom)) * scale


def profile(problem: Problem, best: np.ndarray, j: int, scale: float, degrees_of_freedom: int | None,
            last: bool) -> Profile:
    """The profile of parameter j; `scale` and `degrees_of_freedom` are those of `limit`.

    Raises `BetterMinimum` where it finds a point that is better than `best`, unless it is the `last` try.
    """
    top, lowest = math.sqrt(limit(scale, degrees_of_freedom)), -math.inf if last else -_BETTER_BY * scale
    ridge, reach = _ridge(problem, best, j, top)
    rises: dict[float, float] = {float(best[j]): 0.0}
    (low, open_low), (high, open_high) = (_end(problem, best, j, ridge, sign * reach, top, lowest, rises)
                                          for sign in (-1.0, 1.0))
    parameter = problem.free[j]
    along = sorted(rises)
    return Profile(tuple(parameter.value(x) for x in along), tuple(rises[x] for x in along), parameter.value(low),
                   parameter.value(high), open_low, open_high)


def _ridge(problem: Problem, best: np.ndarray, j: int, top: float) -> tuple[np.ndarray, float]:
    """The direction (P,) in which χ² rises least with parameter j, and the change of j by which √Δχ² rises to `top`.

    Both are those of the parabola at the best point.
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
    """The end of the interval on the side of `reach`, where √Δχ² crosses its limit, by secants; and whether it is open.

    The first point is `reach` away from the best one. `rises` gets the rise of the misfit at each value. Raises
    `BetterMinimum` where the misfit falls below the least by more than −`lowest`.
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
        return inside, True  # the limit was never crossed: how far the interval goes on is not known
    return inside + (top - root_inside) / (root_outside - root_inside) * (outside - inside), False
