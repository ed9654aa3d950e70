"""Target of a fit: the frequencies of peaks and valleys."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..execution.stop import Stop
from ..experiment import Feature
from ..scene import Amplitude, Scene
from ..steady.curve.curve import CurvePoint
from ..steady.curve.resonance import peaks_and_valleys
from ..steady.curve.resonance_curve import resonance_curve
from .evaluation import Compared, Evaluation, refuse_stopped


@dataclass(frozen=True, eq=False)
class FeatureTarget(Compared):
    """Frequencies of peaks and valleys, each with the same standard deviation [Hz], sought on a grid [Hz].

    An extremum of the model counts if it stands out (`steady/curve/resonance.py`) and if the motions there and at both
    neighbours on the grid are periodic; a parabola through the three points gives its frequency.
    """

    features: Sequence[Feature]
    grid: np.ndarray
    sigma: float = 3.0
    start: str = "rest"

    @property
    def sigma_known(self) -> bool:
        """The standard deviation is given."""
        return True

    @property
    def frequencies(self) -> np.ndarray:
        """The stated frequencies (F,) [Hz]."""
        return np.array([feature.frequency for feature in self.features])

    @property
    def smooth(self) -> bool:
        """False, because extrema appear and disappear."""
        return False

    def where(self, datum: int) -> str:
        """The frequency of a datum, in words."""
        return f"at {self.frequencies[datum]:g} Hz"

    def evaluate(self, scene: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        """Compute residuals (F,): distances to the nearest extremum of each feature's kind, in standard deviations.

        The model's values (F,) are the frequencies of these extrema [Hz], NaN where there is no such extremum. Raises
        `Cancelled`.
        """
        curve = resonance_curve(scene, self.grid, self.start, stop=stop, amplitude=amplitude)
        refuse_stopped(stop, len(curve.points) == len(self.grid))
        of_kind = {is_resonance: extrema(curve.points, is_resonance) for is_resonance in (True, False)}
        width = self.grid[-1] - self.grid[0]
        model, residuals = [], []
        for feature in self.features:
            nearest = min(of_kind[feature.is_resonance], key=lambda f: abs(f - feature.frequency), default=math.nan)
            model.append(nearest)
            residuals.append((nearest - feature.frequency if math.isfinite(nearest) else width) / self.sigma)
        return Evaluation(np.array(residuals), log_variance=0.0, regimes=tuple(p.regime.name for p in curve.points),
                          model=np.array(model), curve=curve)


def extrema(points: Sequence[CurvePoint], peaks: bool) -> list[float]:
    """Frequencies of the peaks (or valleys) of the elastic output force that stand out, at periodic points [Hz]."""
    force = np.array([p.max_output_force_elastic for p in points])
    force = np.where(np.isfinite(force), force, 0.0)
    frequencies = []
    for i in peaks_and_valleys(force)[0 if peaks else 1]:
        three = points[i - 1 : i + 2]
        if any(p.regime.name != "periodic" for p in three):
            continue
        left, middle, right = force[i - 1 : i + 2]
        step = 0.5 * (three[2].frequency - three[0].frequency)
        frequencies.append(float(three[1].frequency + 0.5 * step * (left - right) / (left - 2.0 * middle + right)))
    return frequencies
