"""The computations behind the table of figures (figures.py): one function for each kind of figure, from the presets.

As needed, they take the user's data, a stop flag, and a function that is called with the fraction done.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..experiment import Series, stated_features
from ..observers import force_record, observe, twin
from ..scene import Scene, scene
from ..scene.state import rest
from ..steady.curve.curve import Curve
from ..steady.curve.resonance_curve import resonance_curve
from ..steady.settling.outcome import Settled
from ..steady.settling.settle import settle
from .given import Given, delay_of, moved_back
from .results import (
    SHOWN,
    Column,
    CoupledRow,
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
SECTION_2_FREQUENCIES = np.arange(30.0, 3000.5, 10.0)
#: Frequencies of figures 5, 6 and 9 [Hz].
RIG_FREQUENCIES = np.arange(20.0, 160.5, 2.0)
#: The presets of figure 12, by the paper's frequency [Hz].
STATES = {60.0: "fig12-60", 90.0: "fig12-90", 100.0: "fig12-100"}
#: Drive amplitude of figure 6 [m], in the middle of the range that the text states for the shaker.
RIG_AMPLITUDE = scene("rig").A0
#: Amplitudes of figure 5 [m]: the range stated in the text, about 6 to 8 µm, and the rig's amplitude within it.
STATED_AMPLITUDES = (6e-6, RIG_AMPLITUDE, 8e-6)
#: Amplitudes of figure 9 [m]: those of the presets, and the largest one stated in the text, which lies between them.
MODEL_AMPLITUDES = tuple(sorted({STATED_AMPLITUDES[-1], *(scene(name).A0 for name in STATES.values())}))
#: Drive periods shown in figures 3a and 3b.
ENERGY = {"fig3a": 4, "fig3b": 9}
#: Samples per drive period of force trains: at 60 Hz, a pulse in the rig lasts 1/70 of a period.
_TRAIN_SAMPLES = 960
#: Samples per drive period of energy maps: section 2's pulses take a larger part of a period.
_ENERGY_SAMPLES = 192
#: Drive periods for which model (3) is run from rest; the last of them are shown.
FOLLOWED_PERIODS = 60
#: Accuracy of model (3)'s steps; the uncertainty of a measured force between its samples is larger.
_OBSERVER_ACCURACY = 1e-4
#: The paper's foundation, κ = k/(K√A0).
KAPPA = 0.001
#: Figure 11: drive frequency [Hz], which the text does not state; at 200 Hz, as many multipliers are outside.
COUPLED_FREQUENCY = 100.0
#: Figure 11: initial distance of the observer from its chain, in drive amplitudes.
COUPLED_DISTANCE = 1e-3
#: Figure 11: drive periods shown.
COUPLED_PERIODS = 16


def rig(name: str, fixture: bool = False) -> Rig:
    """Compute figures 1, 4 and 8; `fixture` adds the apparatus around the chain, as in figure 4."""
    return Rig(scene(name), fixture)


def transmission(given: Given, stop: Stop | None, progress: Progress) -> Transmission:
    """Compute figure 2."""
    return Transmission(_curve(scene("sec2"), SECTION_2_FREQUENCIES, stop, progress), given.curve)


def energy(names: Sequence[str], stop: Stop | None) -> EnergyMaps:
    """Compute figure 3 or one of its parts."""
    return EnergyMaps(tuple((settle(scene(name), samples=_ENERGY_SAMPLES, stop=stop), ENERGY[name]) for name in names))


def shaker(given: Given) -> ShakerAmplitude:
    """Compute figure 5."""
    return ShakerAmplitude(RIG_FREQUENCIES, STATED_AMPLITUDES, given.shaker)


def response(given: Given, observed: bool, stop: Stop | None, progress: Progress) -> RigResponse:
    """Compute figures 6 and 9; `observed` adds model (3) and more amplitudes, as in figure 9."""
    amplitudes = MODEL_AMPLITUDES if observed else (RIG_AMPLITUDE,)
    part = 1.0 / (len(amplitudes) + 1)
    curves = [_curve(scene("rig").evolve(A0=a, kappa=KAPPA), RIG_FREQUENCIES, stop, _within(progress, i * part, part))
              for i, a in enumerate(amplitudes)]
    states = tuple((f, _state(name, stop)) for f, name in STATES.items()) if observed else ()
    panel = RigCurves(tuple(curves), stated_features(), states, given.curve)
    return RigResponse(panel, column(60.0, given.series.get(60.0), observed, stop))


def trains(frequencies: Sequence[float], given: Given, observed: bool, stop: Stop | None,
           progress: Progress) -> Trains:
    """Compute figures 7, 10 and 12; `observed` adds model (3), as in figure 10."""
    columns = []
    for i, f in enumerate(frequencies):
        columns.append(column(f, given.series.get(f), observed, stop))
        progress((i + 1) / len(frequencies))
    return Trains(tuple(columns))


def observers(stop: Stop | None, frequencies: Sequence[float] = (COUPLED_FREQUENCY,),
              periods: int = COUPLED_PERIODS, distance: float = COUPLED_DISTANCE) -> Observers:
    """Compute figure 11: at every frequency [Hz], a row without a foundation, then one with κ = 0.001.

    (a) One multiplier lies outside the unit circle, (b) the chain's orbit is stable, and (c) the observer leaves it.
    (d) All multipliers lie inside, and (e, f) the first beads of both move alike.
    """
    chains = [scene(name).evolve(f=f) for f in frequencies for name in ("fig11-free", "fig11-founded")]
    return Observers(tuple(CoupledRow(chain.f, chain.kappa, twin(chain, distance, periods, stop=stop))
                           for chain in chains))


def column(named: float, series: Series | None, observed: bool, stop: Stop | None) -> Column:
    """Compute the force trains at one of the paper's frequencies [Hz], with model (3) if `observed`."""
    settled = _state(STATES[named], stop)
    run, chain = settled.run, settled.run.scene
    index, time = repeated(run, SHOWN * chain.f)
    velocity = 2.0 * math.pi * chain.f * chain.A0 * np.cos(2.0 * math.pi * chain.f * time)
    delay = 0.0 if series is None else delay_of(series, chain.f, time, velocity, run.input_force[index])
    when, force, words = _observer(chain, series, delay, stop) if observed else (None, None, "")
    return Column(named, settled, time, velocity, run.input_force[index], run.output_force[index],
                  (run.overlap[index, 0] > 0.0).astype(int), when, force, words,
                  None if series is None else moved_back(series, delay))


def _observer(chain: Scene, series: Series | None, delay: float,
              stop: Stop | None) -> tuple[np.ndarray, np.ndarray, str]:
    """Return model (3)'s time, output force and description; without a measured input force, model (5)'s is used."""
    if series is None:
        pair = twin(chain, rest(chain), FOLLOWED_PERIODS, _TRAIN_SAMPLES, stop)
        rows = min(len(pair.time), round(SHOWN * chain.f) * _TRAIN_SAMPLES + 1)
        return pair.time[:rows], pair.observer_output_force[-rows:], "fed with model (5)'s input force, from rest"
    if series.input_force is None:
        raise BadInput("Model (3) is driven by the measured input force; the series has no column input_force_N.")
    observed = observe(chain.evolve(accuracy=_OBSERVER_ACCURACY), force_record(series.time, series.input_force),
                       stop=stop)
    time = series.time - delay
    kept = (time >= 0.0) & (time <= SHOWN)
    return time[kept], observed.output_force[kept], "fed with the measured input force, from rest"


def _state(name: str, stop: Stop | None) -> Settled:
    return settle(scene(name), samples=_TRAIN_SAMPLES, stop=stop)


def _within(progress: Progress, begin: float, part: float) -> Progress:
    """Convert the progress of a part of a computation to progress of the whole."""
    return lambda done: progress(begin + part * done)


def _curve(chain: Scene, frequencies: np.ndarray, stop: Stop | None, progress: Progress) -> Curve:
    done = [0]

    def count(_: object) -> None:
        done[0] += 1
        progress(done[0] / len(frequencies))

    curve = resonance_curve(chain, frequencies, stop=stop, on_point=count)
    if stop is not None:
        stop.check()
    return curve
