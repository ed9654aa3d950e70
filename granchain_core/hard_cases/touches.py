"""Random grazing touches: a bead or a driver touches or misses its neighbour by as little as 1e-7 of an amplitude.

One bead has a gap on both sides (a negative static overlap), in scaled units. Either a driver of amplitude 1 reaches
into it by the depth while the bead is at rest, or the bead swings on its foundation and reaches equally far into the
wall. Depths are log-uniform from 1e-7 to 1e-2 of the amplitude, and half of them are negative: then there must be no
touch. Frequency, phase, step settings and tolerance are random.
"""

from __future__ import annotations

from math import asin, pi

import numpy as np

from ..kernels.compiling.jit import kernel
from ..kernels.dop853.step import ALL_STAGES, STAGES, Dop853, Dop853Workspace
from ..kernels.effects.contact import Chain
from ..kernels.effects.driver import Harmonic
from ..kernels.effects.foundation import Foundation
from ..kernels.effects.preload import Preload
from ..kernels.equations.motion import Forces, Slots, Trajectory, copy
from ..kernels.error_control.located_step import located_step
from ..kernels.error_control.step import DriveCycle, evaluate

#: Columns of a drawn case: the driver's angular frequency β (or the bead's own ω), depth, initial phase, tolerance,
#: largest step as a fraction of the period, first step as a fraction of the largest.
RATE, DEPTH, PHASE, TOLERANCE, LARGEST, FIRST = range(6)
#: Columns of a result: number of closings, and errors of the closing and opening times as fractions of the period.
CLOSINGS, CLOSING_ERROR, OPENING_ERROR = range(3)


def draw(count: int, seed: int, driven: bool) -> np.ndarray:
    """Draw random touches (count, 6); the phase is before the peak, so that the whole touch lies ahead."""
    rng = np.random.default_rng(seed)
    cases = np.empty((count, 6))
    cases[:, RATE] = 10.0 ** rng.uniform(-2.0, 1.0, count) if driven else 10.0 ** rng.uniform(-1.0, 1.0, count)
    cases[:, DEPTH] = 10.0 ** rng.uniform(-7.0, -2.0, count) * rng.choice([-1.0, 1.0], count)
    cases[:, PHASE] = rng.uniform(-0.5 * pi, 0.45 * pi - 0.2, count)
    low = -13.0 if driven else -13.5
    cases[:, TOLERANCE] = 10.0 ** rng.uniform(low, -4.0 if driven else -11.0, count)
    cases[:, LARGEST] = 1.0 / rng.uniform(16.0, 64.0, count)
    cases[:, FIRST] = 10.0 ** rng.uniform(-4.0, 0.0, count)
    return cases


@kernel
def touch(cases, driven, work, y, counts, static, chain, results):  # type: ignore[no-untyped-def]
    """Run every case from its phase until the driver, or the bead, is back at its middle position.

    The gap is 1 − depth. A bead at rest does not move until the touch, so the analytic closing is at asin(gap); the
    same is true of a bead on a spring of stiffness ω² with velocity ω. It separates at π − asin(gap), apart from its
    displacement by the touch.
    """
    for n in range(cases.shape[0]):
        rate, gap, start = cases[n, RATE], 1.0 - cases[n, DEPTH], cases[n, PHASE]
        static[0], static[1] = (-gap, -1e3) if driven else (-1e3, -gap)
        slots = Slots(chain, None, None, Foundation(0.0 if driven else rate * rate), Preload(static),
                      Harmonic(1.0 if driven else 0.0, rate), None)
        period = 2.0 * pi / rate
        method = Dop853(cases[n, TOLERANCE], cases[n, LARGEST] * period)
        for i in range(y.size):
            y[i] = 0.0
        if not driven:
            y[1], y[4] = np.sin(start), rate * np.cos(start)
        t, end = start / rate, pi / rate
        work.next_step[0] = method.largest_step * cases[n, FIRST]
        work.scale[0], work.scale[1] = 1.0, rate
        evaluate(slots, rate, t, y, work.k[0], work.forces)
        trajectory = Trajectory(slots, DriveCycle(rate, period), y, work)
        contact = 0 if driven else 1
        while t < end * (1.0 - 1e-12):
            before = y[contact] - y[contact + 1] + static[contact] > 0.0
            status, h, changed = located_step(method, trajectory, t, end, counts)
            if status != 0:
                results[n, CLOSINGS] = -1.0
                break
            t += h
            after = work.end[contact] - work.end[contact + 1] + static[contact] > 0.0
            if after and not before:
                results[n, CLOSING_ERROR] = abs(t - asin(gap) / rate) / period if changed == contact else 1.0
                results[n, CLOSINGS] += 1.0
            if before and not after:
                results[n, OPENING_ERROR] = abs(t - (pi - asin(gap)) / rate) / period if changed == contact else 1.0
            copy(work.end, y)
            copy(work.k[STAGES], work.k[0])


def run(cases: np.ndarray, driven: bool) -> np.ndarray:
    """Return the results of each case (count, 3)."""
    row, results = 3, np.zeros((len(cases), 3))
    chain = Chain(np.array([0.0, 1.0, 0.0]), np.ones(2))
    touch(cases, driven, workspace(row), np.zeros(2 * row), np.zeros(4, dtype=np.int64), np.zeros(2), chain,
          results)
    return results


def workspace(row: int) -> Dop853Workspace:
    """Return dop853's work arrays for a chain of `row` bodies."""
    return Dop853Workspace(
        k=np.zeros((ALL_STAGES, 2 * row)), stage=np.zeros(2 * row), end=np.zeros(2 * row), probe=np.zeros(2 * row),
        slope=np.zeros(2 * row), dense=np.zeros((7, 2 * row)), scale=np.zeros(2), next_step=np.zeros(1),
        forces=Forces(np.zeros(row - 1), None))


def missed(cases: np.ndarray, results: np.ndarray) -> np.ndarray:
    """Return the indices of the cases whose touch was missed or invented."""
    return np.flatnonzero((results[:, CLOSINGS] == 1) != (cases[:, DEPTH] > 0.0))


def moved(cases: np.ndarray) -> np.ndarray:
    """Return a driver touch's delay after π − asin(gap) in ending, as a fraction of the period, to order depth².

    The bead has moved by half the touch's duration 2√(2·depth)/β times its velocity (3π√2/8)·depth²/β. The delay is
    this displacement over the driver's speed.
    """
    return 3.0 * pi * 2.0**0.5 / 8.0 * (cases[:, DEPTH] / cases[:, RATE]) ** 2 / (2.0 * pi)
