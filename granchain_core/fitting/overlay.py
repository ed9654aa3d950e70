"""A measured series overlaid on a periodic motion of the model: the shift in time, and the remaining difference.

Equation   late = argmin_s Σ_t (F_model(t + s) − F_measured(t))²,   rms_i = √⟨(F_model,i(t + late) − F_measured,i(t))²⟩
Note       The start of a recording is not known, so the series is shifted to where the sum of squares of all its forces
           is least. The model's force is the mean over the series' sampling interval or, if the bandwidth of the
           sensors is known, the force after their low-pass, as in a fit (trains.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..experiment import Misfit, Series
from ..experiment.sensors import Sensors
from ..results.run import Run
from .trains import Train, moved

#: The forces that a series may have.
_FORCES = ("input_force", "output_force")
#: Sensors without a low-pass.
_PERFECT = Sensors()


@dataclass(frozen=True, eq=False)
class Overlay:
    """A series overlaid on a run, in SI.

    `time` (T,) is the run's time, shifted so that the series begins less than one orbit before the run. `forces` are
    the measured ones by name, and `rms` their differences from the model [N]; `rms` is None for a motion that does not
    repeat, and the series is then not shifted. `sensors` are those whose low-pass the model's forces have passed.
    `displacement` is that of the shaker minus its mean, because a sensor's zero is arbitrary; None if it was not
    measured.
    """

    time: np.ndarray
    forces: dict[str, np.ndarray]
    rms: dict[str, float] | None
    displacement: np.ndarray | None = None
    sensors: Sensors = _PERFECT

    @property
    def sentence(self) -> str:
        """The shift of the series and the differences, in words."""
        if self.rms is None:
            return "The current motion does not repeat: the series is drawn from its own start, and no misfit is given."
        left = " and ".join(f"{rms:.3g} N for the {name.replace('_', ' ')}" for name, rms in self.rms.items())
        low_pass = f" after a low-pass of {self.sensors.bandwidth:g} Hz" if self.sensors.filters else ""
        return f"Shifted in time to the least sum of squares; rms difference from the model{low_pass}: {left}."


def overlay(series: Series, run: Run, sensors: Sensors = _PERFECT) -> Overlay | None:
    """Overlay a series on the run's orbit, with its forces after the low-pass of `sensors`; None if it has no force."""
    forces = {name: values for name in _FORCES if (values := getattr(series, name)) is not None}
    if not forces:
        return None
    swing = None if series.displacement is None else series.displacement - series.displacement.mean()
    if run.regime.name != "periodic":
        return Overlay(series.time, forces=forces, rms=None, displacement=swing, sensors=sensors)
    trains = {name: Train.of(run, name) for name in forces}
    width = float(np.median(np.diff(series.time)))
    late = moved(series.time, forces, trains, width, len(run.time) - 1, sensors)
    rms = {name: Misfit.of(trains[name].recorded(series.time + late, width, sensors), values).rms
           for name, values in forces.items()}
    length = next(iter(trains.values())).length
    return Overlay(series.time + late - np.ceil(late / length) * length, forces=forces, rms=rms, displacement=swing,
                   sensors=sensors)
