"""Minimising a misfit that is smooth within a regime and jumps between regimes.

A Sobol sequence (scipy.stats.qmc) covers the bounds: no slope leads from one regime to the next, so every regime must
be sampled. From the best points SciPy's `least_squares` descends, a trust-region method that keeps to bounds
(Branch, Coleman & Li 1999): it uses that χ² is a sum of squares, needs some ten times fewer curves than a method that
does not, and refuses a step over a jump that makes χ² larger. Where the regimes differ around the point where it stops,
or residuals are not smooth at all (frequencies of peaks), Nelder and Mead's simplex, which uses no slopes, goes on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import least_squares, minimize
from scipy.stats import qmc

from ..execution.stop import Stop
from ..scene import Amplitude, Scene
from ..scheduler import results
from .parameters import Free, with_values
from .records import RecordsTarget
from .targets import CurveTarget, Evaluation, FeatureTarget, SeriesTarget

Target = CurveTarget | SeriesTarget | RecordsTarget | FeatureTarget
#: [fit] Step of derivatives, in parts of the bounds. It is above the noise of a curve's points (1e-5) and below a
#: peak's width.
STEP = 2e-3
#: [fit] Initial points from which the search descends in a round.
_STARTS = 3
#: [fit] Most evaluations of a descent from one of these points.
_DESCENT_CALLS = 20
#: [fit] Most evaluations of the simplex for every parameter.
_SIMPLEX_CALLS = 40
#: [fit] Least distance of two starts in a parameter, as a fraction of the range between its bounds.
_APART_BY = 0.1
#: [fit] Most rounds of the search, each with twice as many initial points.
_MOST_ROUNDS = 3


@dataclass(eq=False)
class Problem:
    """Misfit of a target over the unit cube of the free parameters; all that was evaluated is kept.

    A point x (P,) has a number from 0 to 1 for each of the P parameters in `free`. `points` and `misfits` are those
    that were evaluated, in that order; `tell` is called with their number after each; `scheduler` is a Dask client or
    None.
    """

    scene: Scene
    target: Target
    free: Sequence[Free]
    stop: Stop
    tell: Callable[[int], None]
    points: list[np.ndarray] = field(default_factory=list)
    misfits: list[float] = field(default_factory=list)
    scheduler: Any = None
    _known: dict[bytes, Evaluation] = field(default_factory=dict)

    def ahead(self, points: Sequence[np.ndarray]) -> None:
        """Evaluate points that will be asked for, all at once by the workers of the scheduler; without one, nothing."""
        new = {key: x for x in map(_inside, points) if (key := x.tobytes()) not in self._known}
        if self.scheduler is None or len(new) < 2:
            return
        tasks = [(self.target, *with_values(self.scene, self.free, self.values(x))) for x in new.values()]
        found = dict(results(self.scheduler, evaluated, tasks, self.stop))
        for number, x in enumerate(new.values()):  # in the order asked, whoever was first
            self._keep(x, found[number])

    def evaluate(self, x: np.ndarray) -> Evaluation:
        """The target's evaluation at x (P,), whose numbers are clipped to the cube. Raises `Cancelled`."""
        x = _inside(x)
        key = x.tobytes()
        if key not in self._known:
            self.stop.check()
            scene, amplitude = with_values(self.scene, self.free, self.values(x))
            self._keep(x, self.target.evaluate(scene, amplitude, self.stop))
        return self._known[key]

    def _keep(self, x: np.ndarray, found: Evaluation) -> None:
        self._known[x.tobytes()] = found
        self.points.append(x)
        self.misfits.append(self._misfit(found, x))
        self.tell(len(self.misfits))

    def values(self, x: np.ndarray) -> np.ndarray:
        """Parameters (P,) at x (P,), each in its own unit."""
        return np.array([one.value(float(part)) for one, part in zip(self.free, x, strict=True)])

    def priors(self, x: np.ndarray) -> np.ndarray:
        """Residuals of the priors at x, one for each parameter that has one, in standard deviations."""
        return np.array([(value - one.prior[0]) / one.prior[1]
                         for one, value in zip(self.free, self.values(np.clip(x, 0, 1)), strict=True) if one.prior])

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """Residuals (R,) at x: of the data, of the priors, and the root of the logarithms of the variances."""
        found = self.evaluate(x)
        return np.concatenate([found.residuals, self.priors(x), [np.sqrt(max(found.log_variance, 0.0))]])

    def misfit(self, x: np.ndarray) -> float:
        """What is made least: χ² and the logarithms of the variances, −2 ln of the likelihood but for a constant."""
        return self._misfit(self.evaluate(x), np.clip(x, 0.0, 1.0))

    def chi_squared(self, x: np.ndarray) -> float:
        """The sum of the squared residuals and priors at x, whose distribution is known if the model is true."""
        return self.misfit(x) - self.evaluate(x).log_variance

    def _misfit(self, found: Evaluation, x: np.ndarray) -> float:
        return float((found.residuals**2).sum() + (self.priors(x) ** 2).sum() + found.log_variance)

    def jacobian(self, x: np.ndarray, moving: Sequence[int]) -> np.ndarray:
        """Derivatives (R, M) of the residuals by the M parameters `moving`, given by number.

        They are differences over `STEP` of the cube, to the side that stays within the bounds.
        """
        beside = [_beside(x, j) for j in moving]
        self.ahead([x, *beside])
        base = self.residuals(x)
        return np.stack([(self.residuals(other) - base) / (STEP if x[j] + STEP <= 1.0 else -STEP)
                         for j, other in zip(moving, beside, strict=True)], axis=1)

    def correlation(self, x: np.ndarray) -> np.ndarray:
        """Correlation (P, P) of the estimates at a minimum, from the inverse of JᵀJ; NaN where it has none.

        It is that of the likelihood's parabola, which ends where a regime does.
        """
        slopes = self.jacobian(x, range(len(x)))
        curvature = slopes.T @ slopes
        if np.linalg.matrix_rank(curvature) < len(x):  # a parameter that changes nothing, or two that do the same
            return np.full(curvature.shape, np.nan)
        covariance = np.linalg.inv(curvature)
        deviation = np.sqrt(np.diag(covariance))
        return np.asarray(covariance / np.outer(deviation, deviation))

    def jumps_beside(self, x: np.ndarray) -> bool:
        """Whether a regime changes within a step of derivatives."""
        here = self.evaluate(x).regimes
        return any(self.evaluate(_beside(x, j)).regimes != here for j in range(len(x)))


def evaluated(target: Target, scene: Scene, amplitude: Amplitude | None) -> Evaluation:
    """The residuals of one set of parameters: the work of a scheduler's worker."""
    return target.evaluate(scene, amplitude, None)


def _inside(x: np.ndarray) -> np.ndarray:
    return np.clip(x, 0.0, 1.0)


def _beside(x: np.ndarray, j: int) -> np.ndarray:
    """A step of derivatives away in parameter j, to the side that stays within the bounds."""
    other = np.array(x, dtype=float)
    other[j] += STEP if x[j] + STEP <= 1.0 else -STEP
    return other


def descend(problem: Problem, x: np.ndarray, moving: Sequence[int], most: int = _DESCENT_CALLS) -> np.ndarray:
    """The point to which `least_squares` goes from x when only the parameters `moving` may change."""
    moving = list(moving)
    if not moving:
        return x

    def whole(part: np.ndarray) -> np.ndarray:
        there = np.array(x, dtype=float)
        there[moving] = part
        return there

    found = least_squares(lambda part: problem.residuals(whole(part)), np.clip(x[moving], 1e-6, 1.0 - 1e-6),
                          jac=lambda part: problem.jacobian(whole(part), moving), bounds=(0.0, 1.0), method="trf",
                          x_scale=0.1, xtol=1e-5, ftol=1e-5, max_nfev=most)
    better = whole(found.x)
    return better if problem.misfit(better) <= problem.misfit(x) else x


def descend_by_simplex(problem: Problem, x: np.ndarray, size: float) -> np.ndarray:
    """The point to which Nelder and Mead's simplex of the first `size` goes from x."""
    count = len(x)
    corners = np.vstack([x, *(x + (size if x[j] + size <= 1.0 else -size) * np.eye(count)[j]
                                  for j in range(count))])
    found = minimize(problem.misfit, x, method="Nelder-Mead", bounds=[(0.0, 1.0)] * count,
                     options={"initial_simplex": corners, "maxfev": _SIMPLEX_CALLS * count, "xatol": 1e-4,
                              "fatol": 1e-3})
    better = np.clip(found.x, 0.0, 1.0)
    return better if problem.misfit(better) <= problem.misfit(x) else x


def search(problem: Problem, initial: int, enough: Callable[[np.ndarray], bool]) -> np.ndarray:
    """The best point: `initial` points over the bounds, descents from the best, a simplex where regimes change.

    Where the best point is not good `enough`, the initial points are doubled until there were `_MOST_ROUNDS`: a valley
    that was missed must not be a verdict on the model.
    """
    count = len(problem.free)
    size = max(1, (initial - 1).bit_length())
    sequence = qmc.Sobol(count, scramble=False)
    tried: list[np.ndarray] = []
    starts: list[np.ndarray] = []
    ends: list[np.ndarray] = []
    for turn in range(_MOST_ROUNDS):
        new = sequence.random_base2(size) if turn == 0 else sequence.random(len(tried))
        tried += list(_inner_points(new, 2.0**-size))
        ends += [_minimize(problem, start) for start in _next_starts(problem, tried, starts)]
        best = min(ends, key=problem.misfit)
        if enough(best):
            break
    if problem.target.smooth and problem.jumps_beside(best):
        best = descend(problem, descend_by_simplex(problem, best, 0.02), range(count))
    return best


def _inner_points(points: np.ndarray, spacing: float) -> np.ndarray:
    """Points of [0, 1)ⁿ moved by half their spacing, cyclically, and into 0.02 to 0.98: none begins on a bound."""
    return np.asarray(0.02 + 0.96 * ((points + 0.5 * spacing) % 1.0))


def _next_starts(problem: Problem, tried: list[np.ndarray], starts: list[np.ndarray]) -> list[np.ndarray]:
    """The next `_STARTS` points with the least misfits that are far from all `starts`, to which they are added."""
    new: list[np.ndarray] = []
    problem.ahead(tried)
    for x in sorted(tried, key=problem.misfit):
        if all(np.abs(x - other).max() > _APART_BY for other in starts):
            starts.append(x)
            new.append(x)
        if len(new) == _STARTS:
            break
    return new


def _minimize(problem: Problem, start: np.ndarray) -> np.ndarray:
    """Descend with the method for this target's residuals."""
    if problem.target.smooth:
        return descend(problem, start, range(len(start)))
    return descend_by_simplex(problem, start, 0.1)
