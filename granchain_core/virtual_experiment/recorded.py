"""Records of virtual experiments: a time series, or a resonance curve with repeats, as the text of a CSV file.

The text has the form of an experiment's data, and its first line says that nothing was measured. It is read by the
reader of all measurements (experiment/reader.py), which keeps that mark.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

import numpy as np

from ..errors import BadInput
from ..execution.stop import Stop
from ..experiment.measured import VIRTUAL
from ..experiment.sensors import SAMPLES_PER_BANDWIDTH, Sensors
from ..fitting.trains import Train
from ..inputs.checks import check_range, unknown_name, whole_number
from ..integrate import Engine, fixed_step_setting, following_setting
from ..integrate.methods import typical_error
from ..observers.record import shortest_pulse
from ..results.run import GIVEN_STATE, Cost, Run, run_from
from ..scene import Scene
from ..scene.refusals import refuse_undriven
from ..scene.state import State
from ..steady.settling.outcome import Settled
from ..steady.settling.settle import settle
from ..version import __version__
from .from_rest import from_rest

#: Model samples per sensor sample.
_PER_SAMPLE = 4
#: Model samples over the shortest pulse of the force, which suffice for any bandwidth: linear interpolation is accurate
#: to (π/64)²/8 of the pulse's height, 0.03 %.
_PER_PULSE = 64
#: Smallest number of model samples per drive period.
_LEAST_SAMPLES = 96
#: Relative error of a record's initial state.
_START_ACCURACY = 1e-5
#: Steps of a record per default step.
_STEPS_PER_DEFAULT = 2
#: Largest number of samples in a series.
MOST_SAMPLES = 1_000_000
#: Largest number of records in a curve.
MOST_RECORDS = 10_000
#: Largest number of values in the model's motion for one record, beads times samples.
MOST_VALUES = 20_000_000
#: Largest number of drive periods in a record.
MOST_RECORD_PERIODS = 10_000
#: Possible starts of a series.
STARTS = ("settled", "rest")
#: Largest seed.
_LARGEST_SEED = 2**63 - 1


def virtual_series_csv(scene: Scene, periods: int, sensors: Sensors, seed: int = 0, stop: Stop | None = None,
                       start: str = "settled") -> str:
    """Return the sensors' record over several drive periods: time, velocity, input and output force.

    Parameters
    ----------
    scene : Scene
        A driven chain.
    periods : int
        Length of the record in drive periods, 1 to 10,000.
    sensors : Sensors
        Noise, bandwidth, tip mass and sampling rate of the sensors.
    seed : int
        Seed of the noise and of the phase.
    stop : Stop, optional
        Ends the computation when another thread sets it.
    start : str
        "settled": the record is of the steady state and starts at a random phase. "rest": it starts before the shaker
        does, with one drive period at rest and two in which the shaker's amplitude rises.

    Returns
    -------
    str
        The text of a CSV file, marked as virtual.

    Raises
    ------
    BadInput
        No drive, or a number out of range.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene
    >>> from granchain_core.experiment import read_data
    >>> from granchain_core.virtual_experiment import Sensors, virtual_series_csv
    >>> text = virtual_series_csv(scene("sec2").evolve(N=2, f=2000.0), 3, Sensors(noise=0.01))
    >>> found = read_data(text.encode())
    >>> found.virtual, len(found.time)
    (True, 150)
    """
    refuse_undriven(scene)
    periods = whole_number("periods =", periods, 1, MOST_RECORD_PERIODS)
    count = round(periods * sensors.rate / scene.f)
    check_range("samples (periods · rate / f) =", count, 8, MOST_SAMPLES)
    random = np.random.default_rng(whole_number("seed =", seed, 0, _LARGEST_SEED))
    if start not in STARTS:
        raise unknown_name("start", start, STARTS)
    recorded = _recorded if start == "settled" else _from_rest
    times, velocity, forces = recorded(scene, count, sensors, random, stop)
    rows = "\n".join(f"{t:.9g},{v:.7g},{i:.7g},{o:.7g}" for t, v, i, o in zip(times, velocity, *forces, strict=True))
    begun = "" if start == "settled" else "# begins at rest: the shaker starts after one drive period\n"
    return (f"{_head(scene, sensors, seed)}{begun}time (s),velocity (m/s),input force (N),output force (N)\n{rows}\n")


def virtual_curve_csv(scene: Scene, frequencies: Sequence[float] | np.ndarray, sensors: Sensors, repeats: int = 3,
                      scatter: float = 0.0, periods: int = 20, seed: int = 0, stop: Stop | None = None,
                      progress: Callable[[int, int], None] | None = None) -> str:
    """Return a "measured" resonance curve: the largest output force recorded, several times per frequency.

    As in the laboratory, the largest of noisy samples is too large on average.

    Parameters
    ----------
    scene : Scene
        A driven chain; its own frequency does not matter.
    frequencies : sequence of float
        Drive frequencies [Hz].
    sensors : Sensors
        Noise, bandwidth, tip mass and sampling rate of the sensors.
    repeats : int
        Records at each frequency, 1 to 100.
    scatter : float
        Standard deviation of the drive amplitude between the records, over its mean, 0 to 0.5.
    periods : int
        Length of each record in drive periods.
    seed : int
        Seed of noise, phase and scatter.
    stop : Stop, optional
        Ends the computation when another thread sets it.
    progress : callable, optional
        Called with the number of finished records and the number of all records.

    Returns
    -------
    str
        The text of a CSV file with a row for every record, marked as virtual.

    Raises
    ------
    BadInput
        No drive, or a number out of range.
    Cancelled
        `stop` was set.

    Examples
    --------
    >>> from granchain_core import scene
    >>> from granchain_core.experiment import read_data
    >>> from granchain_core.virtual_experiment import Sensors, virtual_curve_csv
    >>> text = virtual_curve_csv(scene("sec2").evolve(N=2), [1800.0, 2000.0], Sensors(noise=0.01), scatter=0.02)
    >>> found = read_data(text.encode())
    >>> found.repeats.tolist(), found.virtual
    ([3, 3], True)
    """
    refuse_undriven(scene)
    repeats = whole_number("repeats =", repeats, 1, 100)
    check_range("scatter =", scatter, 0.0, 0.5)
    periods = whole_number("periods =", periods, 1, MOST_RECORD_PERIODS)
    count = len(frequencies) * repeats
    check_range("records (frequencies · repeats) =", count, 1, MOST_RECORDS)
    random, rows = np.random.default_rng(whole_number("seed =", seed, 0, _LARGEST_SEED)), []
    for frequency in frequencies:
        for _ in range(repeats):
            amplitude = scene.A0 * max(0.01, 1.0 + scatter * random.standard_normal())
            driven = scene.evolve(f=float(frequency), A0=amplitude)
            samples = round(periods * sensors.rate / driven.f)
            check_range(f"samples at {driven.f:g} Hz (periods · rate / f) =", samples, 8, MOST_SAMPLES)
            _, _, (_, output) = _recorded(driven, samples, sensors, random, stop)
            rows.append(f"{driven.f:.9g},{max(0.0, float(output.max())):.7g}")
            if progress is not None:
                progress(len(rows), count)
    about = f"{repeats} records of {periods} periods at each frequency"
    if scatter > 0.0:
        about += f", drive amplitude scattered by {100.0 * scatter:g} %"
    return f"{_head(scene, sensors, seed)}# {about}\nfrequency (Hz),force (N)\n" + "\n".join(rows) + "\n"


def _head(scene: Scene, sensors: Sensors, seed: int) -> str:
    changed = ", ".join(f"{name} = {value}" for name, value in scene.differences().items())
    return (f"# {VIRTUAL} by granchain {__version__}, nothing was measured: scene {scene.name}"
            f"{f' with {changed}' if changed else ''}\n# sensors: {sensors.words}; seed {seed}\n")


def _recorded(scene: Scene, count: int, sensors: Sensors, random: np.random.Generator,
              stop: Stop | None) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Return time, velocity, and both forces of `count` samples that start at a random phase of the steady state."""
    begun = random.random() / scene.f + sensors.lead_in
    motion, fine = _motion(scene, begun + (count + 1) / sensors.rate, sensors, stop)
    times = np.arange(count) / sensors.rate
    at = times + begun
    omega = 2.0 * math.pi * scene.f
    inertia = -sensors.tip_mass * scene.A0 * omega**2 * np.imag(sensors.response(scene.f) * np.exp(1j * omega * at))
    forces = []
    for name, added in (("input_force", inertia), ("output_force", 0.0)):
        train = Train.of(motion, name)
        force = sensors.passed(train.time, train.force, at) if sensors.filters else train.mean_over(at, 1.0 / fine)
        forces.append(force + added + sensors.noise * random.standard_normal(count))
    velocity = scene.A0 * omega * np.cos(omega * at)
    return times, velocity + sensors.velocity_noise * random.standard_normal(count), forces


def _from_rest(scene: Scene, count: int, sensors: Sensors, random: np.random.Generator,
               stop: Stop | None) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Return time, velocity, and both forces of `count` samples that start at rest."""
    settled, times = _settled(scene, stop), np.arange(count) / sensors.rate
    largest = max(settled.run.max_input_force, settled.run.max_output_force)
    velocity, forces = from_rest(_quick(scene), times, _fastest(scene, largest, sensors), sensors, stop)
    forces = [force + sensors.noise * random.standard_normal(count) for force in forces]
    return times, velocity + sensors.velocity_noise * random.standard_normal(count), forces


def _quick(scene: Scene) -> Scene:
    """Return the scene with an accuracy that suffices for a record."""
    return scene.evolve(accuracy=max(scene.accuracy, _START_ACCURACY))


def _settled(scene: Scene, stop: Stop | None) -> Settled:
    return settle(_quick(scene), stop=stop)


def _fastest(scene: Scene, force: float, sensors: Sensors) -> float:
    """Return the model samples per second [Hz]: enough for the filter or, without one, for the sensor samples.

    No pulse is shorter than the one with the largest `force` [N].
    """
    pulses = _PER_PULSE / shortest_pulse(scene, force) if force > 0.0 else 0.0
    needed = min(SAMPLES_PER_BANDWIDTH * sensors.bandwidth, pulses)
    return needed if sensors.filters else max(needed, _PER_SAMPLE * sensors.rate)


def _motion(scene: Scene, length: float, sensors: Sensors, stop: Stop | None) -> tuple[Run, float]:
    """Return the steady state from phase 0 over slightly more than `length` [s], and its samples per second [Hz]."""
    settled = _settled(scene, stop)
    largest = max(settled.run.max_input_force, settled.run.max_output_force)
    samples = max(_LEAST_SAMPLES, math.ceil(_fastest(scene, largest, sensors) / scene.f))
    periods = math.ceil(length * scene.f) + 1
    if periods * samples * scene.N > MOST_VALUES:
        raise BadInput(f"{periods} drive periods of {samples} samples for {scene.N} beads are more than "
                       f"{MOST_VALUES:.0e} values; take fewer periods, a smaller rate or a smaller bandwidth.")
    setting = following_setting(True) if scene.cuts_tension else fixed_step_setting(_STEPS_PER_DEFAULT)
    engine = Engine(scene, setting, samples, stop=stop)
    engine.start(State(settled.run.displacement[-1], settled.run.velocity[-1]))
    began, rows = time.perf_counter(), engine.record(periods * samples)
    cost = Cost.of(time.perf_counter() - began, engine.counts, setting.method)
    run = run_from(engine, rows, 0, settled.regime, typical_error(setting), cost, start=GIVEN_STATE)
    return run, samples * scene.f
