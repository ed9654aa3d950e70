"""The difference between a measured and a computed curve, in newtons and, if errors are stated, in units of these."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .measured import Measured
from .misfit import Misfit, model_minus_measured


@dataclass(frozen=True, eq=False)
class Difference:
    """Model − measured at every measured frequency [N]; NaN outside the computed curve.

    `model` is the computed force at these frequencies [N], interpolated linearly.
    """

    measured: Measured
    model: np.ndarray

    @property
    def residuals(self) -> np.ndarray:
        """Model − measured [N]."""
        return model_minus_measured(self.model, self.measured.force)

    @property
    def compared(self) -> np.ndarray:
        """Boolean mask of the points that have a model value."""
        return np.isfinite(self.model)

    @property
    def misfit(self) -> Misfit | None:
        """The misfit at these frequencies; None if there are none."""
        compared = self.compared
        return Misfit.of(self.model[compared], self.measured.force[compared]) if compared.any() else None

    @property
    def sentence(self) -> str:
        """Return the misfit in words, with its unit."""
        compared, misfit = self.compared, self.misfit
        if misfit is None:
            return "No measured frequency lies on the computed curve."
        place = f"{self.measured.frequency[compared][misfit.index]:g} Hz"
        words = f"Model − measured at {compared.sum()} of {len(compared)} frequencies: {misfit.words(place)}"
        error = self.measured.error
        if error is not None and (error[compared] > 0.0).all():
            words += f"; rms {np.sqrt(np.mean((self.residuals[compared] / error[compared]) ** 2)):.3g} stated errors"
        return words + "."


def compared(measured: Measured, frequencies: np.ndarray, forces: np.ndarray) -> Difference:
    """Compare the measurement with a curve of ascending frequencies [Hz] and forces [N]."""
    model = np.full(len(measured.frequency), np.nan)
    if len(frequencies):
        model = np.interp(measured.frequency, frequencies, forces, left=np.nan, right=np.nan)
    return Difference(measured, model)
