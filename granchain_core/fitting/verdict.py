"""The verdict of a fit: whether the model can describe the data, and the evidence in a sentence."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2, f

from .feature_target import FeatureTarget
from .search import Problem, Target

#: [fit] The verdict is *cannot* if the probability of a χ² as large, were the model true, is below this.
CANNOT = 0.01
#: [fit] A best value nearer to a bound than this fraction of its range counts as at the bound.
_AT_A_BOUND = 1e-3


def degrees_of_freedom_of_verdict(problem: Problem, data: int) -> int:
    """Data minus parameters; for features all data count, because an extremum need not depend on every parameter."""
    return data if isinstance(problem.target, FeatureTarget) else data - len(problem.free)


def scale_degrees_of_freedom(target: Target, degrees_of_freedom: int) -> int | None:
    """Degrees of freedom of the estimated size of the data's errors; None if it is known exactly."""
    return target.error_freedom if target.sigma_known else degrees_of_freedom


def probability_of(problem: Problem, x: np.ndarray, data: int) -> float | None:
    """Probability of a χ² at least as large as that at x (P,) if the model were true.

    None if no errors are known, or if no degree of freedom is left.
    """
    degrees_of_freedom = degrees_of_freedom_of_verdict(problem, data)
    if not problem.target.sigma_known or degrees_of_freedom == 0:
        return None
    chi_squared, of_errors = problem.chi_squared(x), problem.target.error_freedom
    if of_errors is None:
        return float(chi2.sf(chi_squared, degrees_of_freedom))
    return float(f.sf(chi_squared / degrees_of_freedom, degrees_of_freedom, of_errors))


def verdict_of(probability: float | None) -> str:
    """Whether the model can describe the data, from the probability of a χ² as large; "not known" if that is None."""
    return "not known" if probability is None else "can" if probability >= CANNOT else "cannot"


def verdict_sentence(problem: Problem, best: np.ndarray, data: int) -> str:
    """The verdict with its evidence."""
    probability = probability_of(problem, best, data)
    if probability is None:
        return ("The errors of the data are not known, so there is no verdict. Intervals are valid if the model fits."
                if not problem.target.sigma_known else "There are as many parameters as data: any model would fit.")
    numbers = (f"χ² = {problem.chi_squared(best):.4g} for {degrees_of_freedom_of_verdict(problem, data)} degrees of "
               f"freedom, probability {probability:.2g}")
    edge = [parameter.name for parameter, x in zip(problem.free, best, strict=True) if min(x, 1.0 - x) < _AT_A_BOUND]
    bounds = f"; {', '.join(edge)} at {'a bound' if len(edge) == 1 else 'bounds'}" if edge else ""
    if verdict_of(probability) == "can":
        return f"The model can describe the data ({numbers}{bounds})."
    residuals = problem.evaluate(best).residuals
    worst = int(np.argmax(np.abs(residuals)))
    return (f"The model cannot describe the data within these bounds: the best of {len(problem.misfits)} sets of "
            f"parameters has {numbers}{bounds}; it is {abs(residuals[worst]):.1f} standard deviations "
            f"away {problem.target.where(worst)}.")
