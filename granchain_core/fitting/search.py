"""Minimising a misfit that is smooth within a regime and jumps between regimes.

A Sobol sequence (scipy.stats.qmc) samples the range between the bounds: no slope leads from one regime to the next, so
every regime must be sampled. From the best points, SciPy's `least_squares` descends, a trust-region method with bounds
(Branch, Coleman & Li 1999). It exploits that χ² is a sum of squares, needs about a tenth of the curves that a general
method would, and rejects a step over a jump that makes χ² larger. Where the regimes differ around the point at which it
stops, or residuals are not smooth at all (frequencies of peaks), Nelder and Mead's simplex, which uses no slopes,
continues.

The misfit has a term that is not a sum of squares, L = Σ ln(σ'²/σ²) of enlarged variances. The descent has √L as an
additional residual: its square is L, so the gradient is right. But the slope L'/(2√L) is unbounded at L = 0, and its
contribution to JᵀJ is not the curvature of L. So the curvature for correlations and profiles is computed without it.
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
from .curve_target import CurveTarget
from .evaluation import Evaluation
from .feature_target import FeatureTarget
from .parameters import Free, with_values
from .records import RecordsTarget
from .series_target import SeriesTarget

Target = CurveTarget | SeriesTarget | RecordsTarget | FeatureTarget
# Lengths are fractions of the range between a parameter's bounds. All but `STEP` are chosen, not measured: they decide
# how many evaluations a search takes, and whether it finds the best regime, but not where the minimum is.
#: [fit] Step of the difference quotients. It is above the noise of a curve's points (1e-5) and below a peak's width.
STEP = 2e-3
#: [fit] Number of initial points from which the search descends in one round.
_STARTS = 3
#: [fit] Maximum number of evaluations of a descent from one of these points.
_DESCENT_CALLS = 20
#: [fit] Maximum number of evaluations of the simplex, per parameter.
_SIMPLEX_CALLS = 40
#: [fit] Least distance between two starts in some parameter, as a fraction of the range between its bounds.
_APART_BY = 0.1
#: [fit] Maximum number of rounds of the search, each with twice as many initial points.
_MOST_ROUNDS = 3
#: [fit] Distance of the initial points from the bounds.
_MARGIN = 0.02
#: [fit] Distance from the bounds at which a descent begins: `least_squares` can only start inside them.
_INSIDE = 1e-6
#: [fit] Unit of length in `least_squares` (`x_scale`), which sets the size of its first step.
_LENGTH_SCALE = 0.1
#: [fit] Relative change of the point, or of the misfit, at which a descent ends: the noise of a curve's points.
_DESCENT_TOLERANCE = 1e-5
#: [fit] Size of the first simplex where a descent has stopped between regimes: the search continues near the point.
_NEAR_SIMPLEX = 0.02
#: [fit] Size of the first simplex where slopes are not used at all.
_FIRST_SIMPLEX = 0.1
#: [fit] Size of the simplex at which its search ends: a twentieth of `STEP`.
_LAST_SIMPLEX = 1e-4
#: [fit] Range of misfits in the simplex at which its search ends. It is far below the rise of 3.84 at an interval end.
_LAST_RANGE = 1e-3


@dataclass(eq=False)
class Problem:
    """Misfit of a target over the unit cube of the free parameters; all evaluations are kept.

    A point x (P,) has a number from 0 to 1 for each of the P parameters in `free`. `points` and `misfits` are those
    that were evaluated, in order, and `tell` is called with their number after each. `scheduler` is a Dask client or
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
        """Evaluate in parallel, with the scheduler's workers, points that will be needed; do nothing without one."""
        new = {key: x for x in map(_inside, points) if (key := x.tobytes()) not in self._known}
        if self.scheduler is None or len(new) < 2:
            return
        tasks = [(self.target, *with_values(self.scene, self.free, self.values(x))) for x in new.values()]
        evaluations = dict(results(self.scheduler, evaluated, tasks, self.stop))
        for number, x in enumerate(new.values()):  # in the order of the points, not of completion
            self._keep(x, evaluations[number])

    def evaluate(self, x: np.ndarray) -> Evaluation:
        """Evaluate the target at x (P,), clipped to the cube, or return the known evaluation. Raises `Cancelled`."""
        x = _inside(x)
        key = x.tobytes()
        if key not in self._known:
            self.stop.check()
            scene, amplitude = with_values(self.scene, self.free, self.values(x))
            self._keep(x, self.target.evaluate(scene, amplitude, self.stop))
        return self._known[key]

    def _keep(self, x: np.ndarray, evaluation: Evaluation) -> None:
        self._known[x.tobytes()] = evaluation
        self.points.append(x)
        self.misfits.append(self._misfit(evaluation, x))
        self.tell(len(self.misfits))

    def values(self, x: np.ndarray) -> np.ndarray:
        """Parameters (P,) at x (P,), each in its own unit."""
        return np.array([parameter.value(float(part)) for parameter, part in zip(self.free, x, strict=True)])

    def priors(self, x: np.ndarray) -> np.ndarray:
        """Residuals of the priors at x, one for each parameter that has one, in standard deviations."""
        return np.array([(value - parameter.prior[0]) / parameter.prior[1] for parameter, value
                         in zip(self.free, self.values(np.clip(x, 0, 1)), strict=True) if parameter.prior])

    def residuals(self, x: np.ndarray) -> np.ndarray:
        """Residuals (R + 1,) at x: of the data, of the priors, and lastly the root of the variances' logarithms."""
        evaluation = self.evaluate(x)
        return np.concatenate([evaluation.residuals, self.priors(x), [np.sqrt(max(evaluation.log_variance, 0.0))]])

    def misfit(self, x: np.ndarray) -> float:
        """The quantity to be minimised: χ² plus the logarithms of the variances, −2 ln L up to a constant."""
        return self._misfit(self.evaluate(x), np.clip(x, 0.0, 1.0))

    def chi_squared(self, x: np.ndarray) -> float:
        """The sum of the squared residuals and priors at x, whose distribution is known if the model is true."""
        return self.misfit(x) - self.evaluate(x).log_variance

    def _misfit(self, evaluation: Evaluation, x: np.ndarray) -> float:
        return float((evaluation.residuals**2).sum() + (self.priors(x) ** 2).sum() + evaluation.log_variance)

    def jacobian(self, x: np.ndarray, moving: Sequence[int]) -> np.ndarray:
        """Derivatives (R + 1, M) of the residuals with respect to the M parameters with the numbers `moving`.

        They are differences over `STEP` of the cube, towards the side that is within the bounds.
        """
        beside = [_beside(x, j) for j in moving]
        self.ahead([x, *beside])
        base = self.residuals(x)
        return np.stack([(self.residuals(neighbour) - base) / (STEP if x[j] + STEP <= 1.0 else -STEP)
                         for j, neighbour in zip(moving, beside, strict=True)], axis=1)

    def curvature(self, x: np.ndarray) -> np.ndarray:
        """JᵀJ (P, P) of the residuals of data and priors: half the second derivatives of χ², after Gauss and Newton.

        The logarithms of enlarged variances are left out: JᵀJ of their root is not their curvature.
        """
        slopes = self.jacobian(x, range(len(x)))[:-1]
        return np.asarray(slopes.T @ slopes)

    def correlation(self, x: np.ndarray) -> np.ndarray:
        """Correlation (P, P) of the estimates at a minimum, from the inverse of `curvature`; NaN if it is singular.

        It describes the parabola with which χ² rises from its minimum, and is valid only as far as the regime extends.
        """
        curvature = self.curvature(x)
        if np.linalg.matrix_rank(curvature) < len(x):  # a parameter has no effect, or two have the same
            return np.full(curvature.shape, np.nan)
        covariance = np.linalg.inv(curvature)
        deviation = np.sqrt(np.diag(covariance))
        return np.asarray(covariance / np.outer(deviation, deviation))

    def jumps_beside(self, x: np.ndarray) -> bool:
        """Whether a regime changes within `STEP` of x."""
        here = self.evaluate(x).regimes
        return any(self.evaluate(_beside(x, j)).regimes != here for j in range(len(x)))


def evaluated(target: Target, scene: Scene, amplitude: Amplitude | None) -> Evaluation:
    """Evaluate one set of parameters: the task of a scheduler's worker."""
    return target.evaluate(scene, amplitude, None)


def _inside(x: np.ndarray) -> np.ndarray:
    return np.clip(x, 0.0, 1.0)


def _beside(x: np.ndarray, j: int) -> np.ndarray:
    """The point `STEP` away from x in parameter j, towards the side that is within the bounds."""
    neighbour = np.array(x, dtype=float)
    neighbour[j] += STEP if x[j] + STEP <= 1.0 else -STEP
    return neighbour


def descend(problem: Problem, x: np.ndarray, moving: Sequence[int], most: int = _DESCENT_CALLS) -> np.ndarray:
    """Descend from x by `least_squares`, changing only the parameters `moving`; return the best point."""
    moving = list(moving)
    if not moving:
        return x

    def with_all(part: np.ndarray) -> np.ndarray:
        """The point whose parameters `moving` are `part`."""
        point = np.array(x, dtype=float)
        point[moving] = part
        return point

    descent = least_squares(lambda part: problem.residuals(with_all(part)),
                            np.clip(x[moving], _INSIDE, 1.0 - _INSIDE),
                            jac=lambda part: problem.jacobian(with_all(part), moving), bounds=(0.0, 1.0), method="trf",
                            x_scale=_LENGTH_SCALE, xtol=_DESCENT_TOLERANCE, ftol=_DESCENT_TOLERANCE, max_nfev=most)
    end = with_all(descent.x)
    return end if problem.misfit(end) <= problem.misfit(x) else x


def descend_by_simplex(problem: Problem, x: np.ndarray, size: float) -> np.ndarray:
    """Descend from x by Nelder and Mead's simplex of initial `size`; return the best point."""
    count = len(x)
    corners = np.vstack([x, *(x + (size if x[j] + size <= 1.0 else -size) * np.eye(count)[j]
                                  for j in range(count))])
    descent = minimize(problem.misfit, x, method="Nelder-Mead", bounds=[(0.0, 1.0)] * count,
                       options={"initial_simplex": corners, "maxfev": _SIMPLEX_CALLS * count, "xatol": _LAST_SIMPLEX,
                                "fatol": _LAST_RANGE})
    end = np.clip(descent.x, 0.0, 1.0)
    return end if problem.misfit(end) <= problem.misfit(x) else x


def search(problem: Problem, initial_points: int, enough: Callable[[np.ndarray], bool]) -> np.ndarray:
    """Find the best point: initial points within the bounds, descents from the best, a simplex where regimes change.

    If the best point is not good `enough`, the number of initial points is doubled, in at most `_MOST_ROUNDS` rounds: a
    missed valley must not lead to a verdict against the model.
    """
    count = len(problem.free)
    size = max(1, (initial_points - 1).bit_length())
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
        best = descend(problem, descend_by_simplex(problem, best, _NEAR_SIMPLEX), range(count))
    return best


def _inner_points(points: np.ndarray, spacing: float) -> np.ndarray:
    """Points of [0, 1)ⁿ shifted cyclically by half their spacing, and kept away from the bounds by `_MARGIN`."""
    return np.asarray(_MARGIN + (1.0 - 2.0 * _MARGIN) * ((points + 0.5 * spacing) % 1.0))


def _next_starts(problem: Problem, tried: list[np.ndarray], starts: list[np.ndarray]) -> list[np.ndarray]:
    """The next `_STARTS` points with the least misfits that are far from all `starts`, to which they are added."""
    new: list[np.ndarray] = []
    problem.ahead(tried)
    for x in sorted(tried, key=problem.misfit):
        if all(np.abs(x - start).max() > _APART_BY for start in starts):
            starts.append(x)
            new.append(x)
        if len(new) == _STARTS:
            break
    return new


def _minimize(problem: Problem, start: np.ndarray) -> np.ndarray:
    """Descend with the method for this target's residuals."""
    if problem.target.smooth:
        return descend(problem, start, range(len(start)))
    return descend_by_simplex(problem, start, _FIRST_SIMPLEX)
