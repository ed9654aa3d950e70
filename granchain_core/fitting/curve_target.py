"""Target of a fit: a measured curve of the largest output force over the frequency."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..experiment import Measured, model_minus_measured
from ..scene import Amplitude, Scene
from ..steady.curve.resonance_curve import resonance_curve
from .evaluation import ASSUMED, FAILED, Compared, Evaluation, refuse_stopped, regime_and_period

#: [fit] Relative standard deviation of the largest force of a motion that is not periodic.
SCATTER = 0.2
#: [fit] Forces below this fraction of the largest have the same absolute error as a force of this fraction.
_SMALLEST = 1e-3
#: [fit] Least relative scatter of repeats that is accepted. Closer agreement may be due to chance.
_LEAST_SCATTER = 1e-4


@dataclass(frozen=True, eq=False)
class CurveTarget(Compared):
    """A measured curve: largest output force over the frequency, `elastic` for its elastic part.

    `error` is a standard deviation as a fraction of each force, used if the measurement has no errors of its own.
    """

    measured: Measured
    error: float | None = None
    elastic: bool = False
    start: str = "rest"

    def __post_init__(self) -> None:
        if self.measured.error is not None and self.error is None and not (self.measured.error > 0.0).all():
            at = float(self.measured.frequency[self.measured.error <= 0.0][0])
            raise BadInput(f"The measured error at {at:g} Hz is 0; no force is known exactly, so give each an error.")
        if not self.measured.force.max() > 0.0:
            raise BadInput("All measured forces are 0; there is nothing to fit.")

    @property
    def sigma(self) -> np.ndarray:
        """Standard deviation of every force [N]: measured, given, from repeats (pooled, relative), or assumed."""
        known = self._known_sigma
        return np.full(len(self.measured.force), ASSUMED * self.measured.force.max()) if known is None else known

    @property
    def sigma_known(self) -> bool:
        """Whether the standard deviations are known, not only assumed."""
        return self._known_sigma is not None

    @property
    def error_freedom(self) -> int | None:
        """Degrees of freedom of the repeats; None where the standard deviation is given or not known."""
        given = self.error is not None or self.measured.error is not None
        return None if given or not self.sigma_known else self._spare

    @property
    def _spare(self) -> int:
        """Number of repeats beyond the first of each frequency."""
        return 0 if self.measured.repeats is None else int((self.measured.repeats - 1).sum())

    @property
    def _known_sigma(self) -> np.ndarray | None:
        force, repeats, scatter = self.measured.force, self.measured.repeats, self.measured.scatter
        if self.measured.error is not None and (self.measured.error > 0.0).all():
            return self.measured.error
        size = np.maximum(force, _SMALLEST * force.max())
        if self.error is not None:
            return np.asarray(self.error * size)
        if repeats is None or scatter is None or (repeats > 1).sum() < 2:
            return None
        relative = math.sqrt(float(((repeats - 1) * (scatter / size) ** 2).sum() / self._spare))
        return np.asarray(max(relative, _LEAST_SCATTER) * size / np.sqrt(repeats))

    @property
    def frequencies(self) -> np.ndarray:
        """The measured frequencies (F,) [Hz]."""
        return self.measured.frequency

    def where(self, datum: int) -> str:
        """The frequency of a datum, in words."""
        return f"at {self.frequencies[datum]:g} Hz"

    def evaluate(self, scene: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        """Compute the curve's residuals (F,) at the measured frequencies, in standard deviations, and forces (F,) [N].

        Raises `Cancelled`.
        """
        curve = resonance_curve(scene, self.measured.frequency, self.start, stop=stop, amplitude=amplitude)
        refuse_stopped(stop, len(curve.points) == len(self.measured.frequency))
        name = "max_output_force_elastic" if self.elastic else "max_output_force"
        model = curve.column(name)
        periodic = np.array([p.regime.name == "periodic" for p in curve.points])
        sigma = self.sigma
        stated = np.array([(p.force_errors.elastic if self.elastic else p.force_errors.output) or 0.0
                           for p in curve.points])
        enlarged = np.sqrt(sigma**2 + np.where(periodic, stated * np.abs(model), SCATTER * np.abs(model)) ** 2)
        failed = ~np.isfinite(model)
        enlarged[failed] = sigma[failed]
        residuals = np.where(failed, FAILED, model_minus_measured(model, self.measured.force) / enlarged)
        return Evaluation(residuals, log_variance=float(2.0 * np.log(enlarged / sigma).sum()),
                          regimes=tuple(regime_and_period(p.regime) for p in curve.points), model=model, curve=curve)
