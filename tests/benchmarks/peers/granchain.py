"""granchain itself: its engine for a trajectory, and its batches for a curve."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from granchain_core import Scene, scene
from granchain_core.errors import ComputationError
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.integrate.batch import NEVER, Batch
from granchain_core.integrate.scaling import scale_chain
from granchain_core.kernels.batch_size import BATCH_SIZE

from .. import problem
from ..case import CURVE_REFINES, Case, Peaks, rungs
from ..problem import Solved

#: The fixed-step methods, and the factors of refinement that are tried, from 0.5 to 245 in the same ratio as the C
#: program's numbers of steps.
FIXED = ("rk4-split", "rk4")
REFINES = tuple(0.5 * 1.1**k for k in range(66))
#: The methods with error control.
ADAPTIVE = ("dop853", "dop853-root")
#: Tolerances of the reference: dop853 at its finest, and a coarser one for the 300 points of the curve.
FINEST, CURVE_TOLERANCE = 3e-15, 1e-9


def missing() -> str:
    """Return an empty text: granchain itself is always installed."""
    return ""


def _scene(frequency: float = problem.FREQUENCY) -> Scene:
    return scene("sec2").evolve(f=float(frequency))


def reference() -> Solved:
    """Return the trajectory from dop853 at its finest; states are displacements and velocities."""
    samples = Engine(_scene(), MethodSetting("dop853", tolerance=FINEST), problem.SAMPLES).record(
        problem.PERIODS * problem.SAMPLES)
    return Solved(np.hstack([samples.displacement, samples.velocity]), None)


def _recording(setting: MethodSetting) -> Callable[[], Solved]:
    """Set up one engine, untimed, which every timed run starts again from rest."""
    engine = Engine(_scene(), setting, problem.SAMPLES)
    start = engine.state

    def record() -> Solved:
        engine.start(start)
        engine.counts.array[:] = 0
        try:
            samples = engine.record(problem.PERIODS * problem.SAMPLES)
        except ComputationError:
            return Solved(np.full((problem.PERIODS * problem.SAMPLES + 1, 2 * problem.BEADS), np.nan), None)
        return Solved(np.hstack([samples.displacement, samples.velocity]), engine.counts.rhs)

    return record


def reference_peaks(frequencies: np.ndarray, tolerance: float = CURVE_TOLERANCE) -> tuple[np.ndarray, np.ndarray]:
    """Return the peaks of all points, and whether each is periodic, from dop853 on all cores."""

    def point(frequency: float) -> tuple[float, bool]:
        engine = Engine(_scene(frequency), MethodSetting("dop853", tolerance=tolerance), 1)
        engine.periods(problem.PASSED, watch=False)
        engine.reset_peaks()
        strobes, maxima = engine.periods(problem.WATCHED)
        return float(maxima[:, 2].max()), _returns(strobes)

    with ThreadPoolExecutor() as pool:
        found = list(pool.map(point, frequencies))
    return np.array([f[0] for f in found]), np.array([f[1] for f in found])


def _returns(strobes: np.ndarray, near: float = 1e-6) -> bool:
    """Return whether the last state repeats one of 1 to 16 periods before, to a relative difference of `near`."""
    last = strobes[-1]
    changes = [np.abs(last - strobes[-1 - n]).max() for n in range(1, 17)]
    return bool(min(changes) <= near * np.abs(last).max())


def batch_peaks(frequencies: np.ndarray, refine: float) -> Peaks:
    """Run exactly 100 + 20 periods of every point in batches on this thread: longest first, lanes refilled as they end.
    """
    scaled = [scale_chain(_scene(f)) for f in sorted(frequencies)]
    total = problem.PASSED + problem.WATCHED
    values, rest = np.zeros(len(scaled)), np.zeros(2 * scaled[0].bodies)
    began = time.perf_counter()
    batch = Batch(scaled[0].scene, Stop())
    waiting, place = iter(range(len(scaled))), {}

    def fill(member: int) -> None:
        number = next(waiting, None)
        if number is None:
            place.pop(member, None)
            batch.put(member, scaled[-1], rest, refine, NEVER, NEVER)
        else:
            place[member] = number
            batch.put(member, scaled[number], rest, refine, total, NEVER)

    for member in range(BATCH_SIZE):
        fill(member)
    while place:
        member, _ = batch.run()
        values[place[member]] = batch.maxima(member, problem.WATCHED)[0][2]
        fill(member)
    seconds = time.perf_counter() - began
    evaluations = 4 * total * round(refine * sum(one.steps_per_period() for one in scaled))
    order = np.argsort(np.argsort(frequencies))
    return Peaks(values[order], seconds, evaluations)


def cases() -> list[Case]:
    """Return the methods of the engine, and the batches."""
    found = [Case(f"granchain {m}", "w", REFINES, lambda r, m=m: _recording(MethodSetting(m, refine=r)), unit="refine")
             for m in FIXED]
    found += [Case(f"granchain {m}", "w", rungs(1e-4, 1e-13, 4), lambda t, m=m: _recording(MethodSetting(m, tolerance=t)))
              for m in ADAPTIVE]
    found.append(Case("granchain batches", "w", peaks=batch_peaks, curve_ladder=CURVE_REFINES,
                      unit="refine"))
    return found
