"""`fit`: parameters of a scene from a measurement, their intervals, and whether the model can describe it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import chi2, f

from ..errors import BadInput
from ..execution.stop import Stop
from ..scene import Amplitude, Scene
from ..scene.refusals import refuse_undriven
from ..tables import Labelled, Table, or_nan, provenance
from ..tables.provenance import Attribute
from .intervals import LEVEL, BetterMinimum, Profile, limit, profile
from .parameters import Free, with_values
from .search import STEP, Problem, Target, descend, search
from .tables import data_table, landscape_table, parameter_table, profile_table
from .targets import Evaluation, FeatureTarget, SeriesTarget

#: [fit] The verdict is *cannot* if the probability of a χ² as large, were the model true, is below this.
CANNOT = 0.01
#: [fit] Most parameters. Every one has a profile, for which all others are searched again and again.
MOST_FREE = 30
#: [fit] Times that the search goes on from a better point that a profile found.
_AGAIN = 4


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Labelled):
    """The result of a fit.

    Attributes
    ----------
    scene : Scene
        The scene with the best values.
    amplitude : Amplitude or None
        The drive amplitude over the frequency, where one was fitted for each.
    free : tuple of Free
        What was fitted, with bounds and priors.
    best : numpy.ndarray, shape (p,)
        Values with the least misfit.
    profiles : tuple of Profile
        For each parameter its profile and its 95 % interval; empty if none was asked for.
    misfit : float
        The least −2 ln likelihood up to a constant: χ² plus the logarithms of enlarged variances.
    data : int
        Number of data and priors.
    freedom : int
        Degrees of freedom: number of data and priors minus number of parameters.
    probability : float or None
        Probability of a χ² at least as large if the model were true; None where the data's errors are not known.
    verdict : str
        "can", "cannot" or "not known".
    sentence : str
        The verdict with its evidence.
    evaluation : Evaluation
        Residuals and model values at the best values.
    landscape : tuple of numpy.ndarray
        Values (n, p) and misfits (n,) of everything that was evaluated.
    target : CurveTarget, SeriesTarget, RecordsTarget or FeatureTarget
        What was compared.
    scale : float
        Unit of the misfit: 1, or χ² per degree of freedom where the data's errors are not known.
    wall_s : float
        Wall-clock time [s].
    correlation : numpy.ndarray, shape (p, p), or None
        Correlation of the estimates, from the residuals' slopes at the best values: near ±1 the data determine a
        combination of two parameters better than either. NaN where a parameter changes nothing; None for features,
        whose residuals are not smooth, and where the best values stand at a bound.

    Examples
    --------
    >>> import numpy as np
    >>> from granchain_core import fit, scene
    >>> from granchain_core.fitting import CurveTarget, Free, virtual_curve
    >>> truth = scene("sec2").evolve(N=2, D=120.0)
    >>> measured = virtual_curve(truth, np.linspace(1500.0, 2500.0, 9), 0.02, np.random.default_rng(1))
    >>> found = fit(truth.evolve(D=80.0), CurveTarget(measured), [Free("D", 50.0, 200.0)])
    >>> found.profiles[0].low < 120.0 < found.profiles[0].high, found.verdict
    (True, 'can')
    """

    scene: Scene
    amplitude: Amplitude | None
    free: tuple[Free, ...]
    best: np.ndarray
    profiles: tuple[Profile, ...]
    misfit: float
    data: int
    freedom: int
    probability: float | None
    verdict: str
    sentence: str
    evaluation: Evaluation
    landscape: tuple[np.ndarray, np.ndarray]
    target: Target
    scale: float = 1.0
    wall_s: float = 0.0
    correlation: np.ndarray | None = None

    @property
    def varied(self) -> tuple[str, ...]:
        """The frequency, unless a series at the scene's own was fitted, and the drive amplitude where it follows."""
        own = isinstance(self.target, SeriesTarget) and self.target.frequency is None
        return (() if own else ("f",)) + (() if self.amplitude is None else ("A0",))

    def tables(self) -> tuple[Table, ...]:
        """`parameters` with their intervals, `data` with the model, `profiles`, and the `landscape` of the misfit."""
        profiles = (profile_table(self.free, self.profiles),) if self.profiles else ()
        return (parameter_table(self.free, self.best, self.profiles), data_table(self.target, self.evaluation),
                *profiles, landscape_table(self.free, self.landscape))

    def attributes(self) -> dict[str, Attribute]:
        """Misfit and verdict, and where they come from."""
        extra: dict[str, Attribute] = {} if self.amplitude is None else {
            "amplitude": json.dumps(self.amplitude.to_json())}
        if self.correlation is not None:
            extra["correlation"] = json.dumps(self._correlation_rows())
        return {**provenance(self.scene, "least squares, profile likelihood", None), "misfit": self.misfit,
                "data": self.data, "freedom": self.freedom, "probability": or_nan(self.probability),
                "verdict": self.verdict, "sentence": self.sentence, "scale": self.scale, "level": LEVEL,
                "wall_s": self.wall_s, **extra}

    @property
    def chi_squared(self) -> float:
        """The sum of the squared residuals and priors: the misfit without the logarithms of the variances."""
        return self.misfit - self.evaluation.log_variance

    @property
    def limit(self) -> float:
        """How far the misfit has risen at the ends of the 95 % intervals."""
        return limit(self.scale, _scale_freedom(self.target, self.freedom))

    def summary(self) -> list[str]:
        """Each parameter with its interval, and the verdict."""
        lines = []
        for i, one in enumerate(self.free):
            unit = "" if one.unit == "1" else f" {one.unit}"
            ends = (f", 95 %: {self.profiles[i].low:.5g} to {self.profiles[i].high:.5g}{unit}" if self.profiles else
                    ", no interval computed")
            lines.append(f"{one.name} = {self.best[i]:.5g}{unit}{ends}")
        return [*lines, self.sentence]

    def to_json(self) -> dict[str, Any]:
        """The result as plain data."""
        parameters = []
        for i, one in enumerate(self.free):
            entry: dict[str, Any] = {"name": one.name, "unit": one.unit, "best": float(self.best[i]),
                                     "bounds": [one.low, one.high], "prior": list(one.prior) if one.prior else None}
            if self.profiles:
                found = self.profiles[i]
                entry |= {"low": found.low, "high": found.high, "open_low": found.open_low,
                          "open_high": found.open_high, "profile": [list(found.values), list(found.rises)]}
            parameters.append(entry)
        return {"scene": self.scene.name, "knobs": self.scene.knobs, "parameters": parameters, "level": LEVEL,
                "misfit": self.misfit, "chi_squared": self.chi_squared, "data": self.data, "freedom": self.freedom,
                "probability": self.probability, "verdict": self.verdict, "sentence": self.sentence,
                "evaluations": len(self.landscape[1]),
                "residuals": [float(r) for r in self.evaluation.residuals],
                "model": [float(m) if np.isfinite(m) else None for m in self.evaluation.model],
                "frequency": [float(f) for f in self.target.frequencies],
                "regimes": list(self.evaluation.regimes), "wall_s": self.wall_s,
                "correlation": self._correlation_rows()}

    def _correlation_rows(self) -> list[list[float | None]] | None:
        """The correlation as plain data; None in place of NaN."""
        return None if self.correlation is None else [
            [float(value) if np.isfinite(value) else None for value in row] for row in self.correlation]


def fit(scene: Scene, target: Target, free: Sequence[Free], design: int = 0, intervals: bool = True,
        stop: Stop | None = None, progress: Callable[[int], None] | None = None, scheduler: Any = None) -> Fit:
    """Fit parameters of a scene to a measurement.

    Parameters
    ----------
    scene : Scene
        The chain; parameters that are not free stay as they are.
    target : CurveTarget, SeriesTarget, RecordsTarget or FeatureTarget
        What is compared.
    free : sequence of Free
        Parameters with bounds and, if there are any, priors.
    design : int
        Number of points within the bounds that are tried first; 0 means 32, 64 or 128 for up to 2, 3 or more
        parameters.
    intervals : bool
        Whether profile likelihoods and their 95 % intervals are computed.
    stop : Stop, optional
        Ends the fit when another thread sets it.
    progress : callable, optional
        Called with the number of sets of parameters evaluated.
    scheduler : distributed.Client, optional
        Its workers evaluate the initial points and the derivatives, a set of parameters at a time.

    Returns
    -------
    Fit
        Best values, intervals, misfit and verdict.

    Raises
    ------
    BadInput
        No parameter, too many, one twice, or fewer data than parameters.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import fit, scene
    >>> from granchain_core.experiment import read_data
    >>> from granchain_core.fitting import CurveTarget, Free
    >>> measured = read_data(b"f [Hz],F [N],error [N]\\n1800,3.3,0.1\\n2000,2.3,0.1\\n2200,1.9,0.1\\n")
    >>> found = fit(scene("sec2").evolve(N=2), CurveTarget(measured), [Free("D", 50.0, 200.0)], intervals=False)
    >>> found.data, found.freedom
    (3, 2)
    """
    began = time.perf_counter()
    names = [one.name for one in free]
    refuse_undriven(scene)
    if not 1 <= len(free) <= MOST_FREE or len(set(names)) < len(names) or {"k", "kappa"} <= set(names):
        raise BadInput(f"A fit has 1 to {MOST_FREE} different parameters, of k and kappa only one; not "
                       f"{', '.join(names) or 'none'}.")
    if "kappa" in names and any(one.at is not None for one in free):
        raise BadInput("kappa = k/(K√A0) has no one value where each frequency has its own A0; fit k instead.")
    problem = Problem(scene, target, tuple(free), Stop() if stop is None else stop,
                      progress or (lambda _: None), scheduler=scheduler)
    middle = np.full(len(free), 0.5)
    data = len(problem.evaluate(middle).residuals) + sum(one.prior is not None for one in free)
    freedom = data - len(free)
    if freedom < 0:
        raise BadInput(f"{data} data and priors do not determine {len(free)} parameters; give priors or fewer of them.")
    known = target.sigma_known

    def enough(x: np.ndarray) -> bool:
        return _verdict(_probability(problem, x, data, freedom)) != "cannot"

    best = search(problem, design or (32 if len(free) <= 2 else 64 if len(free) == 3 else 128), enough)
    profiles: tuple[Profile, ...] = ()
    for again in range(_AGAIN):
        scale = 1.0 if known else problem.chi_squared(best) / max(freedom, 1)
        try:
            if intervals and target.smooth and freedom > 0:
                profiles = tuple(profile(problem, best, j, scale, _scale_freedom(target, freedom), again == _AGAIN - 1)
                                 for j in range(len(free)))
            break
        except BetterMinimum as better:
            best = descend(problem, better.x, range(len(free)))
    return _result(problem, best, profiles, data, freedom, scale, time.perf_counter() - began)


def _counted(problem: Problem, data: int, freedom: int) -> int:
    """Degrees of freedom of the verdict: of features each datum, as an extremum need not follow every parameter."""
    return data if isinstance(problem.target, FeatureTarget) else freedom


def _scale_freedom(target: Target, freedom: int) -> int | None:
    """Degrees of freedom with which the size of the data's errors is known; None where it is known exactly."""
    return target.error_freedom if target.sigma_known else freedom


def _probability(problem: Problem, x: np.ndarray, data: int, freedom: int) -> float | None:
    """Probability of a χ² as large as this if the model were true.

    None where no errors are known, or nothing is left free.
    """
    counted = _counted(problem, data, freedom)
    if not problem.target.sigma_known or counted == 0:
        return None
    chi_squared, repeats = problem.chi_squared(x), problem.target.error_freedom
    if repeats is None:
        return float(chi2.sf(chi_squared, counted))
    return float(f.sf(chi_squared / counted, counted, repeats))


def _verdict(probability: float | None) -> str:
    return "not known" if probability is None else "can" if probability >= CANNOT else "cannot"


def _result(problem: Problem, best: np.ndarray, profiles: tuple[Profile, ...], data: int, freedom: int, scale: float,
            wall_s: float) -> Fit:
    misfit, evaluation = problem.misfit(best), problem.evaluate(best)
    values = problem.values(best)
    fitted, amplitude = with_values(problem.scene, problem.free, values)
    probability = _probability(problem, best, data, freedom)
    verdict = _verdict(probability)
    landscape = (np.array([problem.values(x) for x in problem.points]), np.array(problem.misfits))
    return Fit(fitted, amplitude, tuple(problem.free), values, profiles, misfit, data, freedom, probability, verdict,
               _sentence(problem, evaluation, best, _counted(problem, data, freedom), probability, verdict),
               evaluation, landscape, problem.target, scale, wall_s, _correlation(problem, best))


def _correlation(problem: Problem, best: np.ndarray) -> np.ndarray | None:
    """The correlation of the estimates where slopes describe the misfit: inside the bounds, for smooth residuals."""
    inside = best.min() > STEP and best.max() < 1.0 - STEP
    return problem.correlation(best) if problem.target.smooth and inside else None


def _sentence(problem: Problem, evaluation: Evaluation, best: np.ndarray, counted: int,
              probability: float | None, verdict: str) -> str:
    """The verdict with its evidence."""
    if verdict == "not known":
        return ("The errors of the data are not known, so there is no verdict. Intervals hold if the model fits."
                if not problem.target.sigma_known else "There are as many parameters as data: any model would fit.")
    numbers = f"χ² = {problem.chi_squared(best):.4g} for {counted} degrees of freedom, probability {probability:.2g}"
    edge = [one.name for one, x in zip(problem.free, best, strict=True) if min(x, 1.0 - x) < 1e-3]
    bounds = f"; {', '.join(edge)} at {'a bound' if len(edge) == 1 else 'bounds'}" if edge else ""
    if verdict == "can":
        return f"The model can describe the data ({numbers}{bounds})."
    worst = int(np.argmax(np.abs(evaluation.residuals)))
    return (f"The model cannot describe the data within these bounds: the best of {len(problem.misfits)} sets of "
            f"parameters has {numbers}{bounds}; it is {abs(evaluation.residuals[worst]):.1f} standard deviations "
            f"away {problem.target.where(worst)}.")
