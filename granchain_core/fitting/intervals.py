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


def limit(scale: float = 1.0, freedom: int | None = None) -> float:
    """Rise of the misfit at the ends of an interval for one parameter.

    Where the errors are known it is that of χ² with one degree of freedom. Where their variance is estimated with
    `freedom` degrees of freedom, from repeats or as `scale` from the fit, the rise in its unit has the distribution F.
    """
    return float(chi2.ppf(LEVEL, 1) if freedom is None else f.ppf(LEVEL, 1, freedom)) * scale


def profile(problem: Problem, best: np.ndarray, j: int, scale: float, freedom: int | None, last: bool) -> Profile:
    """The profile of parameter j; `scale` and `freedom` are those of `limit`.

    Raises `BetterMinimum` where it finds a point that is better than `best`, unless it is the `last` try.
    """
    least, top = problem.misfit(best), math.sqrt(limit(scale, freedom))
    others = [i for i in range(len(best)) if i != j]
    slopes = problem.jacobian(best, range(len(best)))
    normal = slopes.T @ slopes
    ridge = np.zeros(len(best))
    if others:
        ridge[others] = -np.linalg.lstsq(normal[np.ix_(others, others)], normal[others, j], rcond=None)[0]
    ridge[j] = 1.0
    curvature = float(ridge @ normal @ ridge)
    reach = min(1.0, top / math.sqrt(curvature)) if curvature > 0.0 else 0.25
    found: dict[float, float] = {float(best[j]): 0.0}
    ends = []
    for sign in (-1.0, 1.0):
        lowest = -math.inf if last else -_BETTER_BY * scale
        ends.append(_end(problem, best, j, others, ridge, sign, reach, top, least, lowest, found))
    one = problem.free[j]
    along = sorted(found)
    (low, open_low), (high, open_high) = ends
    return Profile(tuple(one.value(x) for x in along), tuple(found[x] for x in along), one.value(low),
                   one.value(high), open_low, open_high)


def _end(problem: Problem, best: np.ndarray, j: int, others: list[int], ridge: np.ndarray, sign: float, reach: float,
         top: float, least: float, lowest: float, found: dict[float, float]) -> tuple[float, bool]:
    """Where √Δχ² crosses its limit on one side: the root between points below and above it, by the secant."""
    bound = 1.0 if sign > 0.0 else 0.0
    inside, root_inside = float(best[j]), 0.0
    outside, root_outside = math.nan, math.nan
    start, trial = best, best[j] + sign * reach
    for _ in range(_MOST_STEPS):
        trial = min(max(trial, 0.0), 1.0)
        if abs(trial - inside) < 1e-9:
            break
        x = np.clip(start + ridge * (trial - start[j]), 0.0, 1.0)
        x[j] = trial
        x = descend(problem, x, others, _DESCENT_CALLS)
        rise = problem.misfit(x) - least
        if rise < lowest:
            raise BetterMinimum(x)
        root = math.sqrt(max(rise, 0.0))
        found[float(trial)] = max(rise, 0.0)
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
            trial = inside + sign * min(1.2 * ahead, 2.0 * abs(inside - best[j]) + 1e-6)
        else:
            part = (top - root_inside) / (root_outside - root_inside)
            trial = inside + min(max(part, 0.1), 0.9) * (outside - inside)
    if math.isnan(outside):
        return inside, True  # the limit was never crossed: the interval goes on, nobody knows how far
    return inside + (top - root_inside) / (root_outside - root_inside) * (outside - inside), False
