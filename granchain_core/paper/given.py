"""The user's data for a figure: the kinds it accepts, the frequency of each series, and its delay against the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..errors import BadInput
from ..experiment import Answers, Measured, Series, Shaker, read_experiment
from .results import SHOWN


@dataclass(frozen=True)
class Given:
    """Measured data for one figure: a resonance curve, the shaker's amplitude, series by the paper's frequency [Hz]."""

    curve: Measured | None = None
    shaker: Shaker | None = None
    series: dict[float, Series] = field(default_factory=dict)

    @property
    def sentences(self) -> list[str]:
        """Return a sentence for each file that says how it was understood."""
        parts = [measurement.understood for measurement in (self.curve, self.shaker) if measurement is not None]
        return parts + [f"at {f:g} Hz {measurement.understood}" for f, measurement in sorted(self.series.items())]


#: A component smaller than this fraction of the signal's range has no phase that could be aligned.
_LEAST_AMPLITUDE = 1e-3
#: The field of `Given` for a file's content.
_KINDS = {Measured: "curve", Shaker: "shaker", Series: "series"}
#: Contents of the files in words, with columns.
_WORDS = {"curve": "a resonance curve (frequency_Hz, force_N)",
          "shaker": "the shaker's amplitude (frequency_Hz, velocity_m_s or displacement_m)",
          "series": "time series (time_s and velocity_m_s, input_force_N, output_force_N)"}


def read_given(number: str, takes: Sequence[str], frequencies: Sequence[float], files: Sequence[str],
               answers: Answers | None = None) -> Given:
    """Read the files of `--data`, each FILE or HZ=FILE; `answers` apply to all of them.

    Raises `Unclear` if the user has to be asked, and `BadInput` for data that the figure does not accept.
    """
    given = Given()
    for name in files:
        if not takes:
            raise BadInput(f"Figure {number} shows nothing that was measured, so it takes no --data.")
        hertz, path = _split(name)
        measurement = read_experiment(path, answers)
        kind = _KINDS[type(measurement)]
        if kind not in takes:
            raise BadInput(f"Figure {number} takes {' and '.join(_WORDS[kind] for kind in takes)}; "
                           f"{path} is {_WORDS[kind]}.")
        if isinstance(measurement, Series):
            at = _frequency(hertz, frequencies, path, number)
            if at in given.series:
                raise BadInput(f"Two series are given for {at:g} Hz; give one.")
            given = replace(given, series={**given.series, at: measurement})
        elif getattr(given, kind) is not None:
            raise BadInput(f"Two files hold {_WORDS[kind]}; give one.")
        elif isinstance(measurement, Shaker):
            given = replace(given, shaker=measurement)
        else:
            given = replace(given, curve=measurement)
    return given


def _split(name: str) -> tuple[float | None, str]:
    hertz, equals, path = name.partition("=")
    try:
        return (float(hertz), path) if equals else (None, name)
    except ValueError:
        return None, name


def _frequency(hertz: float | None, frequencies: Sequence[float], path: str, number: str) -> float:
    if hertz is None and len(frequencies) == 1:
        return frequencies[0]
    known = ", ".join(f"{f:g}" for f in frequencies)
    if hertz is None:
        raise BadInput(f"Figure {number} shows series at {known} Hz; say to which {path} belongs, for example "
                       f"--data {frequencies[0]:g}={path}.")
    if hertz not in frequencies:
        nearest = min(frequencies, key=lambda f: abs(f - hertz))
        raise BadInput(f"Figure {number} has no series at {hertz:g} Hz; it has {known} Hz, the nearest is {nearest:g}.")
    return hertz


def delay_of(series: Series, f: float, time: np.ndarray, velocity: np.ndarray, force: np.ndarray) -> float:
    """Return by how much [s] a series must be moved back, so that its last `SHOWN` seconds start at 0 and are in phase.

    `velocity` and input `force` at `time` (T,) are the model's. The phase is that of the component at the model's drive
    frequency `f` [Hz], in the input force or, if that was not measured, in the velocity. A series without such a
    component, for example of an output force alone, is moved by whole drive periods.
    """
    for model, measured in ((force, series.input_force), (velocity, series.velocity)):
        if measured is not None:
            (phase, _), (own, size) = _component(time, model, f), _component(series.time, measured, f)
            if size > _LEAST_AMPLITUDE * float(np.ptp(measured)):
                late = float(np.mod((own - phase) / (2.0 * np.pi * f), 1.0 / f))
                break
    else:
        late = 0.0
    return late + max(0.0, np.floor((float(series.time[-1]) - SHOWN - late) * f + 1e-9)) / f


def moved_back(series: Series, delay: float) -> Series:
    """Move a series `delay` seconds earlier, and keep its part from 0 to `SHOWN`."""
    time = series.time - delay
    kept = (time >= 0.0) & (time <= SHOWN)
    velocity, entered, arrived = (None if values is None else values[kept] for values in (
        series.velocity, series.input_force, series.output_force))
    return Series(time[kept], velocity, entered, arrived, series.understood, note=series.note)


def _component(time: np.ndarray, values: np.ndarray, f: float) -> tuple[float, float]:
    """Return phase 2πfs and amplitude of the part a·cos(2πf(t − s)) of `values`, over whole periods if possible."""
    duration = np.floor((time[-1] - time[0]) * f + 1e-9) / f
    inside = time - time[0] <= duration if duration > 0.0 else np.ones(len(time), dtype=bool)
    t, v = time[inside], values[inside]
    component = 2.0 * np.trapezoid((v - v.mean()) * np.exp(2j * np.pi * f * t), t) / (t[-1] - t[0])
    return float(np.angle(component)), float(abs(component))
