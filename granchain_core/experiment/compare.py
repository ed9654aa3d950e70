"""The difference between a measured and a computed curve, in newtons and, if known, in units of the errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .measured import Measured


def model_minus_measured(model: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """A residual as it is signed everywhere: positive where the model is larger."""
    return np.asarray(model - measured)


@dataclass(frozen=True, eq=False)
class Difference:
    """Model − measured at every measured frequency [N]; NaN outside the computed curve.

    `model` is the computed force there [N], on straight lines between its points.
    """

    measured: Measured
    model: np.ndarray

    @property
    def residuals(self) -> np.ndarray:
        """Model − measured [N]."""
        return model_minus_measured(self.model, self.measured.force)

    @property
    def compared(self) -> np.ndarray:
        """Where there is a model."""
        return np.isfinite(self.model)

    @property
    def sentence(self) -> str:
        """The misfit in words, with its unit."""
        there = self.compared
        if not there.any():
            return "No measured frequency lies on the computed curve."
        gaps = self.residuals[there]
        rms, largest = float(np.sqrt(np.mean(gaps**2))), int(np.argmax(np.abs(gaps)))
        size = float(np.sqrt(np.mean(self.measured.force[there] ** 2)))
        share = f" ({100.0 * rms / size:.3g} %)" if size > 0.0 else ""
        words = (f"Model − measured at {there.sum()} of {len(there)} frequencies: rms {rms:.3g} N{share}, mean "
                 f"{gaps.mean():+.3g} N, largest {gaps[largest]:+.3g} N at "
                 f"{self.measured.frequency[there][largest]:g} Hz")
        error = self.measured.error
        if error is not None and (error[there] > 0.0).all():
            words += f"; rms {np.sqrt(np.mean((gaps / error[there]) ** 2)):.3g} stated errors"
        return words + "."


def compared(measured: Measured, frequencies: np.ndarray, forces: np.ndarray) -> Difference:
    """Compare the measurement with a curve of ascending frequencies [Hz] and forces [N]."""
    model = np.full(len(measured.frequency), np.nan)
    if len(frequencies):
        model = np.interp(measured.frequency, frequencies, forces, left=np.nan, right=np.nan)
    return Difference(measured, model)
