"""`fit`: parameters of a scene from a measurement, their intervals, and whether the model can describe it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..scene import Scene
from ..scene.refusals import refuse_undriven
from .intervals import BetterMinimum, Profile, profile
from .parameters import Free, with_values
from .result import Fit
from .search import STEP, Problem, Target, descend, search
from .verdict import probability_of, scale_degrees_of_freedom, verdict_of, verdict_sentence

#: [fit] Maximum number of parameters. Each one has a profile, for which all others are searched again and again.
MOST_FREE = 30
#: [fit] Maximum number of times the profiles are computed. Each time but the first starts at a better point that a
#: profile found.
_MOST_PROFILE_ROUNDS = 4


def fit(scene: Scene, target: Target, free: Sequence[Free], initial_points: int = 0, intervals: bool = True,
        stop: Stop | None = None, progress: Callable[[int], None] | None = None, scheduler: Any = None,
        design: int | None = None) -> Fit:
    """Fit parameters of a scene to a measurement.

    Parameters
    ----------
    scene : Scene
        The chain; parameters that are not free keep their values.
    target : CurveTarget, SeriesTarget, RecordsTarget or FeatureTarget
        The measurement, with the rule by which it is compared.
    free : sequence of Free
        Parameters with bounds and, if there are any, priors.
    initial_points : int
        Number of points within the bounds at which the misfit is computed first; 0 means 32 for up to two parameters,
        64 for three and 128 for more.
    intervals : bool
        Whether profile likelihoods and their 95 % intervals are computed.
    stop : Stop, optional
        Ends the fit when another thread sets it.
    progress : callable, optional
        Called with the number of sets of parameters evaluated.
    scheduler : distributed.Client, optional
        Its workers evaluate the initial points and the derivatives, one set of parameters at a time.
    design : int, optional
        `initial_points` under its former name.

    Returns
    -------
    Fit
        Best values, intervals, misfit and verdict.

    Raises
    ------
    BadInput
        No parameter, too many, a repeated one, or fewer data than parameters.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import fit, scene
    >>> from granchain_core.experiment import read_data
    >>> from granchain_core.fitting import CurveTarget, Free
    >>> measured = read_data(b"f [Hz],F [N],error [N]\\n1800,3.3,0.1\\n2000,2.3,0.1\\n2200,1.9,0.1\\n")
    >>> fitted = fit(scene("sec2").evolve(N=2), CurveTarget(measured), [Free("D", 50.0, 200.0)], intervals=False)
    >>> fitted.data, fitted.degrees_of_freedom
    (3, 2)
    """
    began = time.perf_counter()
    _check(scene, free)
    problem = Problem(scene, target, tuple(free), Stop() if stop is None else stop,
                      progress or (lambda _: None), scheduler=scheduler)
    data = _count_data(problem)
    wanted = initial_points if design is None else design
    best = search(problem, wanted or _usual_initial_points(len(free)),
                  lambda x: verdict_of(probability_of(problem, x, data)) != "cannot")
    best, profiles, scale = _profiles(problem, best, data - len(free), intervals)
    return _result(problem, best, profiles, data, scale, time.perf_counter() - began)


def _check(scene: Scene, free: Sequence[Free]) -> None:
    """Raise `BadInput` for a scene without a drive, and for parameters that cannot be fitted together."""
    names = [parameter.name for parameter in free]
    refuse_undriven(scene)
    if not 1 <= len(free) <= MOST_FREE or len(set(names)) < len(names) or {"k", "kappa"} <= set(names):
        raise BadInput(f"A fit has 1 to {MOST_FREE} different parameters, of k and kappa only one; not "
                       f"{', '.join(names) or 'none'}.")
    if "kappa" in names and any(parameter.at is not None for parameter in free):
        raise BadInput("kappa = k/(K√A0) has no single value if each frequency has its own A0; fit k instead.")


def _count_data(problem: Problem) -> int:
    """Number of data and priors, at least as many as parameters. Raises `BadInput`, `Cancelled`."""
    count = len(problem.free)
    data = (len(problem.evaluate(np.full(count, 0.5)).residuals)
            + sum(parameter.prior is not None for parameter in problem.free))
    if data < count:
        raise BadInput(f"{data} data and priors do not determine {count} parameters; give more priors or fewer "
                       "parameters.")
    return data


def _usual_initial_points(parameters: int) -> int:
    """Default number of initial points for a number of parameters."""
    return 32 if parameters <= 2 else 64 if parameters == 3 else 128


def _profiles(problem: Problem, best: np.ndarray, degrees_of_freedom: int,
              intervals: bool) -> tuple[np.ndarray, tuple[Profile, ...], float]:
    """The best point, the profile of each parameter if `intervals` are wanted, and the unit of the misfit.

    If a profile finds a better point than `best`, all parameters are searched from there, and the profiles start again.
    """
    target = problem.target
    for number in range(1, _MOST_PROFILE_ROUNDS + 1):
        scale = 1.0 if target.sigma_known else problem.chi_squared(best) / max(degrees_of_freedom, 1)
        if not (intervals and target.smooth and degrees_of_freedom > 0):
            break
        known_with = scale_degrees_of_freedom(target, degrees_of_freedom)
        try:
            return best, tuple(profile(problem, best, j, scale, known_with, number == _MOST_PROFILE_ROUNDS)
                               for j in range(len(best))), scale
        except BetterMinimum as better:
            best = descend(problem, better.x, range(len(best)))
    return best, (), scale


def _result(problem: Problem, best: np.ndarray, profiles: tuple[Profile, ...], data: int, scale: float,
            wall_s: float) -> Fit:
    """The result at the best point (P,) of the unit cube."""
    values = problem.values(best)
    fitted, amplitude = with_values(problem.scene, problem.free, values)
    probability = probability_of(problem, best, data)
    landscape = (np.array([problem.values(x) for x in problem.points]), np.array(problem.misfits))
    return Fit(scene=fitted, amplitude=amplitude, free=tuple(problem.free), best=values, profiles=profiles,
               misfit=problem.misfit(best), data=data, degrees_of_freedom=data - len(problem.free),
               probability=probability, verdict=verdict_of(probability),
               sentence=verdict_sentence(problem, best, data), evaluation=problem.evaluate(best), landscape=landscape,
               target=problem.target, scale=scale, wall_s=wall_s, correlation=_correlation(problem, best))


def _correlation(problem: Problem, best: np.ndarray) -> np.ndarray | None:
    """The correlation of the estimates if slopes describe the misfit: inside the bounds, for smooth residuals."""
    inside = best.min() > STEP and best.max() < 1.0 - STEP
    return problem.correlation(best) if problem.target.smooth and inside else None
