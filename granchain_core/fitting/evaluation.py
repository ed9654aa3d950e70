"""Common parts of all targets of a fit: residuals with the model's values, and the origin of errors.

A residual is a difference over its standard deviation. A motion that is not periodic has no steady maximum and no
repeating force train: the model only predicts a distribution, so the variance is enlarged by that of the model, and
2 ln of the enlargement is added to χ², as in a normal likelihood. Otherwise chaos, which predicts nothing, would win.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import Cancelled
from ..execution.stop import Stop
from ..results.regime import Regime
from ..steady.curve.curve import Curve

#: [fit] Residual of a point whose computation failed, in standard deviations.
FAILED = 20.0
#: [fit] Standard deviation if neither errors nor repeats are known, as a fraction of the largest force. The misfit is
#: then scaled so that it equals its degrees of freedom.
ASSUMED = 0.05


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Residuals (n,) in standard deviations, and the regimes.

    `log_variance` is Σ 2 ln(σ'/σ) over the data whose standard deviation σ' is enlarged: on a curve by the stated
    numerical error of a periodic motion and by a fifth of the force of any other, in a series by the standard deviation
    of the waveform of a motion that is not periodic. It is part of the likelihood, but not of χ². `regimes` are
    "periodic3", "chaotic" and so on. `model` is the model's value for each datum, for figures: forces [N], frequencies
    [Hz].
    """

    residuals: np.ndarray
    log_variance: float
    regimes: tuple[str, ...]
    model: np.ndarray
    curve: Curve | None = None


class Compared:
    """Base of most targets: residuals are smooth, and errors are given or estimated from the fit."""

    @property
    def smooth(self) -> bool:
        """Whether residuals are smooth between regimes."""
        return True

    @property
    def error_freedom(self) -> int | None:
        """Degrees of freedom of a standard deviation estimated from repeats; None if it is not."""
        return None


def regime_and_period(regime: Regime) -> str:
    """A regime as spelled in the JSON and files of a fit: "periodic3", "chaotic"."""
    return f"{regime.name}{regime.period or ''}"


def refuse_stopped(stop: Stop | None, complete: bool) -> None:
    """Raise `Cancelled` for a curve that is not `complete`, because it was stopped."""
    if not complete or (stop is not None and stop):
        raise Cancelled
