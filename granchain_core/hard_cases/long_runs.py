"""Hard cases of long runs: the drive must keep its phase, and interrupting a run must not change its result."""

from __future__ import annotations

import numpy as np

from ..integrate import METHODS, Engine, MethodSetting, fixed_step_setting
from ..integrate.checkpoint import Checkpoint, checkpoint, resumed
from ..scene import scene
from .case import Measurement, Picture, Trace

_SAMPLES = 8


def cut_and_gone_on(method: str, periods: int, cuts: int, seed: int = 1) -> float:
    """Count the numbers in the final state and the samples that change if the run is cut at random places.

    At each cut, a checkpoint is written to bytes and read into a new engine. Fixed-step methods are cut at any sample,
    and methods with error control only at whole periods.
    """
    chosen = scene("sec2").evolve(f=1130.0, N=5)
    setting = MethodSetting(method, 1.0, 1e-9 if METHODS[method].error_control else 0.0)
    total = periods * _SAMPLES
    unit = _SAMPLES if METHODS[method].error_control else 1
    rng = np.random.default_rng(seed)
    where = unit * np.sort(rng.choice(np.arange(1, total // unit), min(cuts, total // unit - 1), replace=False))
    uncut, pieces = Engine(chosen, setting, _SAMPLES), Engine(chosen, setting, _SAMPLES)
    differs, done = 0, 0
    for end in [*where, total]:
        count = int(end - done)
        one, other = whole_part(uncut, count), whole_part(pieces, count)
        differs += int((one != other).sum()) + int((uncut.y != pieces.y).sum())
        pieces = resumed(chosen, Checkpoint.from_bytes(checkpoint(pieces).to_bytes()))
        done = int(end)
    return float(differs)


def whole_part(engine: Engine, count: int) -> np.ndarray:
    """Return the displacements of the next `count` samples."""
    return engine.record(count).displacement


def uninterrupted(method: str, periods: int, cuts: int) -> float:
    """Count the numbers in the final state that differ between one call over all periods and many calls."""
    chosen = scene("sec2").evolve(f=1130.0, N=5)
    setting = MethodSetting(method, 1.0, 1e-9 if METHODS[method].error_control else 0.0)
    uncut, pieces = Engine(chosen, setting, 1), Engine(chosen, setting, 1)
    uncut.periods(periods, watch=False)
    where = np.sort(np.random.default_rng(2).choice(np.arange(1, periods), min(cuts, periods - 1), replace=False))
    for count in np.diff([0, *where, periods]):
        pieces.periods(int(count), watch=False)
        pieces = resumed(chosen, Checkpoint.from_bytes(checkpoint(pieces).to_bytes()))
    return float((uncut.y != pieces.y).sum())


def phase_error(periods: int) -> tuple[float, float]:
    """Return the driver's distance from sin 2πft after `periods` + 1 periods, in amplitudes, and miscounted periods."""
    engine = Engine(scene("sec2").evolve(N=1, f=3000.0), fixed_step_setting(), _SAMPLES)
    left = periods
    while left > 0:
        engine.periods(min(left, 10_000))
        left -= 10_000
    worst = abs(float(engine.y[0]))
    for j in range(1, _SAMPLES + 1):
        engine.record(1)
        worst = max(worst, abs(float(engine.y[0]) - np.sin(2.0 * np.pi * j / _SAMPLES)))
    return worst, abs(engine.elapsed - (periods + 1.0))


def long_runs(quick: bool) -> list[Measurement]:
    """Measure the drive phase and bitwise restarts."""
    periods = 20_000 if quick else 100_000
    phase, counted = phase_error(periods)
    measurements = [Measurement(f"drive phase after {periods} periods, in amplitudes", phase, 1e-15),
             Measurement("periods counted wrongly", counted, 0.0)]
    cuts = 40 if quick else 1_000
    for method in METHODS:
        run = 2 * cuts if quick else periods // (10 if METHODS[method].error_control else 1)
        differs = cut_and_gone_on(method, 2 * cuts, cuts) + uninterrupted(method, run, cuts)
        measurements.append(Measurement(f"numbers that {cuts} random cuts change, {method}", differs, 0.0,
                                 f"{run} periods in one call, and {2 * cuts} sample by sample"))
    return measurements


def long_runs_picture() -> Picture:
    """Draw the phase error of a clock that adds its steps, t += dt, in drive amplitudes; granchain's error is 0."""
    frequency, steps, marks = 340.0, 200, np.array([1, 10, 100, 1_000, 10_000, 50_000])
    dt = 1.0 / frequency / steps
    times = np.add.accumulate(np.full(int(marks[-1]) * steps, dt))[marks * steps - 1]
    wrong = np.abs(np.sin(2.0 * np.pi * frequency * times)) + 1e-17
    return Picture(np.log10(marks), "drive periods, log10", "error of the driver in amplitudes, log10",
                   (Trace("granchain", np.full(len(marks), -17.0)), Trace("t += dt", np.log10(wrong))))
