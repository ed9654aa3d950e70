"""Targets of a fit and their residuals: a curve, a series, or the frequencies of peaks and valleys.

A residual is a difference over its standard deviation. A motion that is not periodic has no steady maximum and no
train that comes back: there the model predicts a distribution only, so the variance is enlarged by the model's own, and
2 ln of the enlargement is added to χ², as in a normal likelihood; else chaos, which predicts nothing, would win.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, Cancelled, ComputationError
from ..execution.stop import Stop
from ..experiment import Feature, Measured, Series, model_minus_measured
from ..experiment.sensors import SAMPLES_PER_BANDWIDTH, Sensors
from ..results.regime import Regime
from ..scene import Amplitude, Scene
from ..scene.quantities import QUANTITIES
from ..steady.curve.curve import Curve, CurvePoint
from ..steady.curve.resonance import peaks_and_valleys
from ..steady.curve.resonance_curve import resonance_curve
from ..steady.settling.settle import settle
from .trains import Train, moved

#: [fit] Relative standard deviation of the largest force of a motion that is not periodic.
SCATTER = 0.2
#: [fit] Residual of a point whose computation failed, in standard deviations.
FAILED = 20.0
#: [fit] Standard deviation where neither errors nor repeats are known, as a fraction of the largest force. The misfit
#: is then scaled so that it has the size of its degrees of freedom.
ASSUMED = 0.05
#: [fit] Forces below this fraction of the largest have the absolute error of a force of this fraction.
_SMALLEST = 1e-3
#: [fit] Least relative scatter of repeats that is believed. Closer agreement may be chance.
_LEAST_SCATTER = 1e-4
#: [fit] Samples of a model's train in a drive period.
_TRAIN = 768
#: [fit] Most samples of a model's train in a drive period, for sensors with a bandwidth.
_MOST_TRAIN = 8192
#: [fit] Most samples of a series that are compared; a longer one is thinned out evenly.
_COMPARED = 4000


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Residuals (n,) in standard deviations, and the regimes.

    `log_variance` is Σ 2 ln(σ'/σ) over the data whose standard deviation σ' is enlarged: on a curve by the stated
    numerical error of a periodic motion and by a fifth of the force of any other, in a series by the standard deviation
    of the waveform of a motion that is not periodic. It belongs to the likelihood, and not to χ². `regimes` are
    "periodic3", "chaotic" and so on. `model` is the model's value for each datum, for pictures: forces [N], frequencies
    [Hz].
    """

    residuals: np.ndarray
    log_variance: float
    regimes: tuple[str, ...]
    model: np.ndarray
    curve: Curve | None = None


class Compared:
    """What most targets have in common: smooth residuals; errors that are given, or estimated from the fit."""

    @property
    def smooth(self) -> bool:
        """Whether residuals are smooth between regimes."""
        return True

    @property
    def error_freedom(self) -> int | None:
        """Degrees of freedom with which repeats tell the standard deviation; None where they do not."""
        return None


@dataclass(frozen=True, eq=False)
class CurveTarget(Compared):
    """A measured curve: largest output force over the frequency, `elastic` for its elastic part.

    `error` is a standard deviation as a fraction of each force, used where the measurement has none of its own.
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
        """Standard deviation of every force [N]: stated, given, from repeats (pooled, relative), or assumed."""
        known = self._known_sigma
        return np.full(len(self.measured.force), ASSUMED * self.measured.force.max()) if known is None else known

    @property
    def sigma_known(self) -> bool:
        """Whether the standard deviations are more than assumed."""
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
        """Where it was measured (F,) [Hz]."""
        return self.measured.frequency

    def where(self, datum: int) -> str:
        """Where a datum was measured, in words."""
        return f"at {self.frequencies[datum]:g} Hz"

    def evaluate(self, scene: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        """Residuals (F,) at the measured frequencies, in standard deviations; the model's forces (F,) [N] from a curve.

        Raises `Cancelled`.
        """
        curve = resonance_curve(scene, self.measured.frequency, self.start, stop=stop, amplitude=amplitude)
        _check(stop, len(curve.points) == len(self.measured.frequency))
        name = "max_output_force_elastic" if self.elastic else "max_output_force"
        model = curve.column(name)
        periodic = np.array([p.regime.name == "periodic" for p in curve.points])
        sigma = self.sigma
        stated = np.array([(p.force_errors.elastic if self.elastic else p.force_errors.output) or 0.0
                           for p in curve.points])
        wide = np.sqrt(sigma**2 + np.where(periodic, stated * np.abs(model), SCATTER * np.abs(model)) ** 2)
        failed = ~np.isfinite(model)
        wide[failed] = sigma[failed]
        residuals = np.where(failed, FAILED, model_minus_measured(model, self.measured.force) / wide)
        return Evaluation(residuals, float(2.0 * np.log(wide / sigma).sum()),
                          tuple(regime_and_period(p.regime) for p in curve.points), model, curve)


@dataclass(frozen=True, eq=False)
class SeriesTarget(Compared):
    """A measured series: the forces over time, each the mean over its interval.

    `error` is the standard deviation of the forces [N], `frequency` that of the drive [Hz], by default the scene's.
    With the `bandwidth` of the force sensors [Hz] the model's forces pass the sensors' low-pass, and each sample is the
    value at its time. The start of the recording is not known: for each set of parameters the model's trains are moved
    to where the sum of squares is least.
    """

    series: Series
    error: float | None = None
    frequency: float | None = None
    bandwidth: float = math.inf

    def __post_init__(self) -> None:
        Sensors(bandwidth=self.bandwidth)  # refuses what is no bandwidth
        if not self.channels:
            raise BadInput("The series has neither an input force nor an output force; there is nothing to fit.")
        if self.frequency is not None:
            QUANTITIES["f"].check(self.frequency)

    @property
    def sensors(self) -> Sensors:
        """The sensors of the forces."""
        return Sensors(bandwidth=self.bandwidth)

    @property
    def channels(self) -> dict[str, np.ndarray]:
        """The measured forces by name, (T,) each [N], thinned out where the series is long."""
        both = {"input_force": self.series.input_force, "output_force": self.series.output_force}
        return {name: values[self._kept] for name, values in both.items() if values is not None}

    @property
    def time(self) -> np.ndarray:
        """The times (T,) of their samples [s]."""
        return self.series.time[self._kept]

    @property
    def _kept(self) -> slice:
        return slice(None, None, max(1, math.ceil(len(self.series.time) / _COMPARED)))

    @property
    def sigma_known(self) -> bool:
        """Whether the standard deviation was given."""
        return self.error is not None

    @property
    def frequencies(self) -> np.ndarray:
        """Empty (0,): all samples of a series have one drive frequency."""
        return np.zeros(0)

    def where(self, datum: int) -> str:
        """Which force a datum is, and when it was measured, in words."""
        channel, sample = divmod(datum, len(self.time))
        return f"in the {list(self.channels)[channel].replace('_', ' ')} at {self.time[sample]:.6g} s"

    def driven(self, scene: Scene, amplitude: Amplitude | None) -> Scene:
        """The scene at the series' drive frequency, with that frequency's amplitude where each has its own."""
        scene = scene if self.frequency is None else scene.evolve(f=self.frequency)
        return scene if amplitude is None else scene.evolve(A0=amplitude.at(scene.f))

    def _samples(self, f: float) -> int:
        """Samples of the model in a drive period: more where the sensors are fast."""
        wanted = SAMPLES_PER_BANDWIDTH * self.bandwidth / f if self.sensors.filters else 0.0
        return math.ceil(min(max(_TRAIN, wanted), _MOST_TRAIN))

    def evaluate(self, scene: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        """Residuals (C·T,) of every sample, one channel after another, in standard deviations; the model's forces [N].

        Raises `Cancelled`.
        """
        time, measured = self.time, self.channels
        largest = max(float(np.abs(values).max()) for values in measured.values())
        sigma = self.error or ASSUMED * largest
        try:
            driven = self.driven(scene, amplitude)
            found = settle(driven, samples=self._samples(driven.f), stop=stop)
        except ComputationError:
            count = sum(map(len, measured.values()))
            return Evaluation(np.full(count, FAILED), 0.0, ("failed",), np.full(count, np.nan))
        trains = {name: Train.of(found.run, name) for name in measured}
        width = float(np.median(np.diff(self.series.time)))
        periodic = found.regime.name == "periodic"
        late = moved(time, measured, trains, width, len(found.run.time) - 1, self.sensors) if periodic else 0.0
        residuals, beyond, models = [], 0.0, []
        for name, values in measured.items():
            if periodic:
                model, wide = trains[name].recorded(time + late, width, self.sensors), sigma
            else:
                model = np.full(len(values), float(getattr(found.run, name).mean()))
                wide = math.hypot(sigma, float(getattr(found.run, name).std()))
            residuals.append(model_minus_measured(model, values) / wide)
            beyond += 2.0 * len(values) * math.log(wide / sigma)
            models.append(model)
        return Evaluation(np.concatenate(residuals), beyond, (regime_and_period(found.regime),),
                          np.concatenate(models))


@dataclass(frozen=True, eq=False)
class FeatureTarget(Compared):
    """Frequencies of peaks and valleys, each with the same standard deviation [Hz], sought on a grid [Hz].

    A model's extremum counts where it stands out (`steady/curve/resonance.py`) and it and both its neighbours on the
    grid are periodic; a parabola through the three gives its frequency.
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
        return np.array([one.frequency for one in self.features])

    @property
    def smooth(self) -> bool:
        """Extrema come and go."""
        return False

    def where(self, datum: int) -> str:
        """Which extremum a datum is, in words."""
        return f"at {self.frequencies[datum]:g} Hz"

    def evaluate(self, scene: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        """Residuals (F,): distances to the nearest extremum of each feature's kind, in standard deviations.

        The model's values (F,) are the frequencies of these extrema [Hz], NaN where there is none. Raises `Cancelled`.
        """
        curve = resonance_curve(scene, self.grid, self.start, stop=stop, amplitude=amplitude)
        _check(stop, len(curve.points) == len(self.grid))
        found = {kind: extrema(curve.points, kind) for kind in (True, False)}
        model, residuals = [], []
        for one in self.features:
            near = min(found[one.is_resonance], key=lambda f: abs(f - one.frequency), default=math.nan)
            width = self.grid[-1] - self.grid[0]
            model.append(near)
            residuals.append((near - one.frequency if math.isfinite(near) else width) / self.sigma)
        return Evaluation(np.array(residuals), 0.0, tuple(p.regime.name for p in curve.points), np.array(model), curve)


def regime_and_period(regime: Regime) -> str:
    """A regime as the JSON and the files of a fit write it: "periodic3", "chaotic"."""
    return f"{regime.name}{regime.period or ''}"


def extrema(points: Sequence[CurvePoint], peaks: bool) -> list[float]:
    """Frequencies of the peaks (or valleys) of the elastic output force that stand out, at periodic points [Hz]."""
    force = np.array([p.max_output_force_elastic for p in points])
    force = np.where(np.isfinite(force), force, 0.0)
    found = []
    for i in peaks_and_valleys(force)[0 if peaks else 1]:
        three = points[i - 1 : i + 2]
        if any(p.regime.name != "periodic" for p in three):
            continue
        left, middle, right = force[i - 1 : i + 2]
        step = 0.5 * (three[2].frequency - three[0].frequency)
        found.append(float(three[1].frequency + 0.5 * step * (left - right) / (left - 2.0 * middle + right)))
    return found


def _check(stop: Stop | None, complete: bool) -> None:
    """A curve that was stopped has fewer points."""
    if not complete or (stop is not None and stop):
        raise Cancelled
