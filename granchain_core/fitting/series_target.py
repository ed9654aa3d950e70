"""Target of a fit: a measured series of forces over time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput, ComputationError
from ..execution.stop import Stop
from ..experiment import Series, model_minus_measured
from ..experiment.sensors import SAMPLES_PER_BANDWIDTH, Sensors
from ..results.run import Run
from ..scene import Amplitude, Scene
from ..scene.quantities import QUANTITIES
from ..steady.settling.settle import settle
from .evaluation import ASSUMED, FAILED, Compared, Evaluation, regime_and_period
from .trains import Train, moved

#: [fit] Samples per drive period of the model's force train.
_TRAIN = 768
#: [fit] Maximum number of samples per drive period of the model's force train, for sensors with a bandwidth.
_MOST_TRAIN = 8192
#: [fit] Maximum number of samples of a series that are compared; a longer series is thinned out evenly.
_COMPARED = 4000


@dataclass(frozen=True, eq=False)
class SeriesTarget(Compared):
    """A measured series: the forces over time, each sample the mean over its interval.

    `error` is the standard deviation of the forces [N], and `frequency` the drive frequency [Hz], by default the
    scene's. If the `bandwidth` of the force sensors [Hz] is given, the model's forces pass the sensors' low-pass, and
    each sample is the value at its time. The start of the recording is not known: for each set of parameters, the
    model's force trains are shifted to where the sum of squares is least.
    """

    series: Series
    error: float | None = None
    frequency: float | None = None
    bandwidth: float = math.inf

    def __post_init__(self) -> None:
        Sensors(bandwidth=self.bandwidth)  # refuses an invalid bandwidth
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
        """The measured forces by name, (T,) each [N], thinned out if the series is long."""
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
        """The force and the time of a datum, in words."""
        channel, sample = divmod(datum, len(self.time))
        return f"in the {list(self.channels)[channel].replace('_', ' ')} at {self.time[sample]:.6g} s"

    def driven(self, scene: Scene, amplitude: Amplitude | None) -> Scene:
        """The scene at the series' drive frequency, with that frequency's amplitude if each frequency has its own."""
        scene = scene if self.frequency is None else scene.evolve(f=self.frequency)
        return scene if amplitude is None else scene.evolve(A0=amplitude.at(scene.f))

    def _samples(self, f: float) -> int:
        """Samples of the model per drive period: more if the sensors are fast."""
        wanted = SAMPLES_PER_BANDWIDTH * self.bandwidth / f if self.sensors.filters else 0.0
        return math.ceil(min(max(_TRAIN, wanted), _MOST_TRAIN))

    def evaluate(self, scene: Scene, amplitude: Amplitude | None, stop: Stop | None) -> Evaluation:
        """Compute the residuals (C·T,) of all samples, channel by channel, in standard deviations, and the forces [N].

        Raises `Cancelled`.
        """
        measured = self.channels
        sigma = self.error or ASSUMED * max(float(np.abs(values).max()) for values in measured.values())
        try:
            driven = self.driven(scene, amplitude)
            settled = settle(driven, samples=self._samples(driven.f), stop=stop)
        except ComputationError:
            count = sum(map(len, measured.values()))
            return Evaluation(np.full(count, FAILED), 0.0, ("failed",), np.full(count, np.nan))
        if settled.regime.name == "periodic":
            models, scatter = self._recorded(settled.run), dict.fromkeys(measured, 0.0)
        else:
            trains = {name: getattr(settled.run, name) for name in measured}
            models = {name: np.full(len(measured[name]), float(train.mean())) for name, train in trains.items()}
            scatter = {name: float(train.std()) for name, train in trains.items()}
        residuals, log_variance = [], 0.0
        for name, values in measured.items():
            enlarged = math.hypot(sigma, scatter[name])
            residuals.append(model_minus_measured(models[name], values) / enlarged)
            log_variance += 2.0 * len(values) * math.log(enlarged / sigma)
        return Evaluation(np.concatenate(residuals), log_variance, (regime_and_period(settled.regime),),
                          np.concatenate(list(models.values())))

    def _recorded(self, run: Run) -> dict[str, np.ndarray]:
        """The forces of a periodic motion as the sensors record them, (T,) each [N], shifted to the measured ones."""
        time, measured = self.time, self.channels
        trains = {name: Train.of(run, name) for name in measured}
        width = float(np.median(np.diff(self.series.time)))
        late = moved(time, measured, trains, width, len(run.time) - 1, self.sensors)
        return {name: trains[name].recorded(time + late, width, self.sensors) for name in measured}
