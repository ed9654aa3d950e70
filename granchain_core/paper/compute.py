"""The results behind the figures of the paper, from the presets: one function for each kind of figure.

Each function takes a user's data, a stop flag, and a function that is called with the fraction done.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..errors import BadInput
from ..experiment import Series, stated_features
from ..observe import figure_11, force_record, observe, twin
from ..scene import Scene, scene
from ..state import rest
from ..steady.curve.curve import Curve
from ..steady.curve.resonance_curve import resonance_curve
from ..steady.settling.outcome import Settled
from ..steady.settling.settle import settle
from ..stop import Stop
from .given import Given, behind, moved
from .results import (
    SHOWN,
    Column,
    EnergyMaps,
    Observers,
    Rig,
    RigCurves,
    RigResponse,
    ShakerAmplitude,
    Trains,
    Transmission,
    repeated,
)

Progress = Callable[[float], None]
#: Frequencies of figure 2 [Hz].
SECTION_2 = np.arange(30.0, 3000.5, 10.0)
#: Frequencies of figures 5, 6 and 9 [Hz].
RIG = np.arange(20.0, 160.5, 2.0)
#: Amplitudes of figure 5 [m]: the range that the text states, and its middle.
STATED = (6e-6, 7e-6, 8e-6)
#: Amplitude of figure 6 [m]: that middle.
MIDDLE = (7e-6,)
#: Amplitudes of figure 9 [m]: those of the presets and one between, across the range of the paper's model.
MODELLED = (6e-6, 8e-6, 11e-6, 13e-6)
#: The presets of figure 12 by the paper's frequency [Hz].
STATES = {60.0: "fig12-60", 90.0: "fig12-90", 100.0: "fig12-100"}
#: Drive periods shown of figures 3a and 3b.
ENERGY = {"fig3a": 4, "fig3b": 9}
#: Samples a drive period of the rig's force trains: a pulse lasts 1/70 of a period at 60 Hz.
_TRAIN = 960
#: Samples a drive period of section 2's energies, whose pulses are slower.
_ENERGY = 192
#: Drive periods for which model (3) is followed from rest before it is shown.
_FOLLOWED = 60
#: Figure 11: the observer starts `perturbation` · A0 beside its chain and is followed for `periods` drive periods.
FIGURE_11 = {"frequencies": (100.0,), "periods": 16, "perturbation": 1e-3}


def rig(name: str, fixture: bool = False, **changes: float) -> Rig:
    """Figures 1, 4 and 8."""
    return Rig(scene(name).evolve(**changes), fixture)


def transmission(given: Given, stop: Stop | None, progress: Progress) -> Transmission:
    """Figure 2."""
    return Transmission(_curve(scene("sec2"), SECTION_2, stop, progress), given.curve)


def energy(names: Sequence[str], stop: Stop | None) -> EnergyMaps:
    """Figure 3 or one of its parts."""
    return EnergyMaps(tuple((settle(scene(name), samples=_ENERGY, stop=stop), ENERGY[name]) for name in names))


def shaker(given: Given) -> ShakerAmplitude:
    """Figure 5."""
    return ShakerAmplitude(RIG, STATED, given.shaker)


def response(given: Given, observed: bool, stop: Stop | None, progress: Progress) -> RigResponse:
    """Figures 6 and 9; `observed` adds model (3) and more amplitudes, as figure 9 does."""
    amplitudes = MODELLED if observed else MIDDLE
    part = 1.0 / (len(amplitudes) + 1)
    curves = [_curve(scene("rig").evolve(A0=a, kappa=0.001), RIG, stop, _within(progress, i * part, part))
              for i, a in enumerate(amplitudes)]
    states = tuple((f, _state(name, stop)) for f, name in STATES.items()) if observed else ()
    panel = RigCurves(tuple(curves), stated_features(), states, given.curve)
    return RigResponse(panel, column(60.0, given.series.get(60.0), observed, stop))


def trains(frequencies: Sequence[float], given: Given, observed: bool, stop: Stop | None,
           progress: Progress) -> Trains:
    """Figures 7, 10 and 12; `observed` adds model (3), as figure 10 does."""
    columns = []
    for i, f in enumerate(frequencies):
        columns.append(column(f, given.series.get(f), observed, stop))
        progress((i + 1) / len(frequencies))
    return Trains(tuple(columns))


def observers(stop: Stop | None) -> Observers:
    """Figure 11."""
    return Observers(figure_11(**FIGURE_11, stop=stop))  # type: ignore[arg-type]


def column(named: float, series: Series | None, observed: bool, stop: Stop | None) -> Column:
    """The trains of one of the paper's frequencies [Hz], with model (3) if `observed`."""
    found = _state(STATES[named], stop)
    run, chain = found.run, found.run.scene
    index, time = repeated(run, SHOWN * chain.f)
    velocity = 2.0 * math.pi * chain.f * chain.A0 * np.cos(2.0 * math.pi * chain.f * time)
    back = 0.0 if series is None else behind(series, chain.f, time, velocity, run.input_force[index])
    when, force, words = _observer(chain, series, back, stop) if observed else (None, None, "")
    return Column(named, found, time, velocity, run.input_force[index], run.output_force[index],
                  (run.overlap[index, 0] > 0.0).astype(int), when, force, words,
                  None if series is None else moved(series, back))


def _observer(chain: Scene, series: Series | None, back: float,
              stop: Stop | None) -> tuple[np.ndarray, np.ndarray, str]:
    """Model (3): time, output force and words. A measured input force drives it or, without one, model (5)'s."""
    if series is None:
        pair = twin(chain, rest(chain), _FOLLOWED, _TRAIN, stop)
        rows = min(len(pair.time), round(SHOWN * chain.f) * _TRAIN + 1)
        return pair.time[:rows], pair.observer_output_force[-rows:], "fed with model (5)'s input force, from rest"
    if series.input_force is None:
        raise BadInput("Model (3) is pushed by the measured input force; the series has no column input_force_N.")
    found = observe(chain.evolve(accuracy=1e-4), force_record(series.time, series.input_force), stop=stop)
    time = series.time - back
    kept = (time >= 0.0) & (time <= SHOWN)
    return time[kept], found.output_force[kept], "fed with the measured input force, from rest"


def _state(name: str, stop: Stop | None) -> Settled:
    return settle(scene(name), samples=_TRAIN, stop=stop)


def _within(progress: Progress, begin: float, part: float) -> Progress:
    """Progress of a part of a computation as that of the whole."""
    return lambda done: progress(begin + part * done)


def _curve(chain: Scene, frequencies: np.ndarray, stop: Stop | None, progress: Progress) -> Curve:
    done = [0]

    def count(_: object) -> None:
        done[0] += 1
        progress(done[0] / len(frequencies))

    found = resonance_curve(chain, frequencies, stop=stop, on_point=count)
    if stop is not None:
        stop.check()
    return found
