"""Program and kernel: brief touches by the hundred thousand, and whether the certified method misses one.

    python -m tests.numerics.touches --count 100000 [--seed 1]

One bead with a gap on both sides (a negative static overlap), in scaled units. Either a driver of amplitude 1 comes
within the gap's depth of it while it rests, or it is thrown on its foundation and comes as near to the wall. Depths are
log-uniform from 1e-7 to 1e-2 of the amplitude, half of them negative: then nothing may be touched. Frequency, phase, step
settings and tolerance are random.
"""

from __future__ import annotations

import argparse
import time
from math import asin, pi

import numba
import numpy as np

from granchain_core.kernels.certified import certified_step
from granchain_core.kernels.dop853 import ALL_STAGES, STAGES, Dop853, Work, evaluate
from granchain_core.kernels.effects.contact import Chain
from granchain_core.kernels.effects.driver import Harmonic
from granchain_core.kernels.effects.foundation import Foundation
from granchain_core.kernels.effects.preload import Preload
from granchain_core.kernels.motion import Forces, Slots

#: Columns of what is drawn: the driver's rate β (or the bead's own ω), depth, phase it starts at, tolerance, largest
#: step as a part of the period, first step as a part of the largest.
RATE, DEPTH, PHASE, TOLERANCE, LARGEST, FIRST = range(6)
#: Columns of what is found: touches counted by onsets, error of the onset and of the release as parts of the period.
ONSETS, ONSET_ERROR, RELEASE_ERROR = range(3)


def draw(count: int, seed: int, driven: bool) -> np.ndarray:
    """Random touches (count, 6); the phase is before the top, so that the whole touch lies ahead."""
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


@numba.njit(nogil=True, error_model="numpy")
def touch(cases, driven, work, y, clock, counts, static, chain, found):
    """Run every case from its phase until the driver, or the bead, is back at middle position.

    The gap is 1 − depth. A bead that rests is where it was until the touch, so the analytic onset is asin(gap); the
    same is true of a bead on a spring of stiffness ω² with velocity ω. It lets go at π − asin(gap), but for what the
    touch moved it (`release_allowed`).
    """
    for n in range(cases.shape[0]):
        case = cases[n]
        rate, gap, start = case[RATE], 1.0 - case[DEPTH], case[PHASE]
        static[0], static[1] = (-gap, -1e3) if driven else (-1e3, -gap)
        slots = Slots(chain, None, None, Foundation(0.0 if driven else rate * rate), Preload(static),
                      Harmonic(1.0 if driven else 0.0, rate), None)
        period = 2.0 * pi / rate
        method = Dop853(case[TOLERANCE], case[LARGEST] * period)
        y[:] = 0.0
        if not driven:
            y[1], y[4] = np.sin(start), rate * np.cos(start)
        t, end = start / rate, pi / rate
        clock[0] = method.largest_step * case[FIRST]
        work.scale[0], work.scale[1] = 1.0, rate
        counts[:] = 0
        evaluate(slots, rate, t, y, work.k[0], work.forces)
        found[n, :] = 0.0
        contact = 0 if driven else 1
        while t < end * (1.0 - 1e-12):
            before = y[contact] - y[contact + 1] + static[contact] > 0.0
            status, h, changed = certified_step(method, slots, rate, t, end, y, work, clock, counts)
            if status != 0:
                found[n, ONSETS] = -1.0
                break
            t += h
            after = work.end[contact] - work.end[contact + 1] + static[contact] > 0.0
            if after and not before:
                found[n, ONSET_ERROR] = abs(t - asin(gap) / rate) / period if changed == contact else 1.0
                found[n, ONSETS] += 1.0
            if before and not after:
                found[n, RELEASE_ERROR] = abs(t - (pi - asin(gap)) / rate) / period if changed == contact else 1.0
            y[:] = work.end
            work.k[0, :] = work.k[STAGES]


def run(cases: np.ndarray, driven: bool) -> np.ndarray:
    """What is found of each case (count, 3)."""
    row, work = 3, workspace(3)
    found = np.zeros((len(cases), 3))
    chain = Chain(np.array([0.0, 1.0, 0.0]), np.ones(2))
    touch(cases, driven, work, np.zeros(2 * row), np.zeros(1), np.zeros(4, dtype=np.int64), np.zeros(2), chain, found)
    return found


def missed(cases: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Numbers of the cases that touch and were not seen to, or were seen to and do not touch."""
    return np.flatnonzero((found[:, ONSETS] == 1) != (cases[:, DEPTH] > 0.0))


def moved(cases: np.ndarray) -> np.ndarray:
    """How much later than at π − asin(gap) a touch by the driver ends, as a part of the period, to order depth²: the bead
    has moved by half the touch's length 2√(2·depth)/β times its velocity (3π√2/8)·depth²/β, over the driver's speed."""
    return 3.0 * pi * 2.0**0.5 / 8.0 * (cases[:, DEPTH] / cases[:, RATE]) ** 2 / (2.0 * pi)


@numba.njit(nogil=True, error_model="numpy")
def two_touches(rate, gaps, tolerance, work, y, clock, counts, static, chain, times):
    """Times at which two beads on springs, thrown apart with amplitude 1, reach standing driver and wall."""
    static[0], static[1], static[2] = -gaps[0], -1e3, -gaps[1]
    slots = Slots(chain, None, None, Foundation(rate * rate), Preload(static), Harmonic(0.0, rate), None)
    end = 0.5 * pi / rate
    y[:] = 0.0
    y[5], y[6] = -rate, rate
    clock[0], work.scale[0], work.scale[1], t = 0.1 * end, 1.0, rate, 0.0
    evaluate(slots, rate, t, y, work.k[0], work.forces)
    while t < end * (1.0 - 1e-12):
        status, h, _ = certified_step(Dop853(tolerance, 0.25 * end), slots, rate, t, end, y, work, clock, counts)
        if status != 0:
            return
        t += h
        for side in range(2):
            c = 2 * side
            if work.end[c] - work.end[c + 1] + static[c] > 0.0 and times[side] == 0.0:
                times[side] = t
        y[:] = work.end
        work.k[0, :] = work.k[STAGES]


def workspace(row: int) -> Work:
    """Arrays of the certified method for a chain of `row` bodies."""
    return Work(k=np.zeros((ALL_STAGES, 2 * row)), stage=np.zeros(2 * row), end=np.zeros(2 * row),
                probe=np.zeros(2 * row), slope=np.zeros(2 * row), dense=np.zeros((7, 2 * row)), scale=np.zeros(2),
                forces=Forces(np.zeros(row - 1), None))


def run_pairs(count: int, seed: int, tolerance: float) -> np.ndarray:
    """(count, 3): the time between two touches as a part of the period, log-uniform from 1e-13, and both touches' errors."""
    rng = np.random.default_rng(seed)
    work, found = workspace(4), np.zeros((count, 3))
    chain = Chain(np.array([0.0, 1.0, 1.0, 0.0]), np.ones(3))
    for n in range(count):
        rate, apart = 10.0 ** rng.uniform(-1.0, 1.0), 2.0 * pi * 10.0 ** rng.uniform(-13.0, -1.5)
        angles = rng.permutation([first := rng.uniform(0.2, 1.2), first + apart])
        times = np.zeros(2)
        two_touches(rate, np.sin(angles), tolerance, work, np.zeros(8), np.zeros(1), np.zeros(4, dtype=np.int64),
                    np.zeros(3), chain, times)
        found[n] = apart / (2.0 * pi), *np.abs(times * rate - angles) / (2.0 * pi)
    return found


def main() -> None:
    """Print what was missed and how near the onsets are."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    words = parser.parse_args()
    for driven in (True, False):
        run(draw(2, 0, driven), driven)  # compiled
        began = time.perf_counter()
        cases = draw(words.count, words.seed, driven)
        found = run(cases, driven)
        wrong, touches = missed(cases, found), cases[:, DEPTH] > 0.0
        onset = found[touches, ONSET_ERROR]
        print(f"{'driver' if driven else 'thrown bead'}: {touches.sum()} touches and {(~touches).sum()} near misses, "
              f"{len(wrong)} wrong, onset within {np.median(onset):.1e} (median), {onset.max():.1e} (worst) of a period, "
              f"{(onset > 1e-12).sum()} above 1e-12, {time.perf_counter() - began:.1f} s")
        if driven:
            exact = touches & (moved(cases) < 1e-12)
            print(f"  {exact.sum()} of these hardly move the bead, and end within {found[exact, RELEASE_ERROR].max():.1e} of a "
                  "period of where they should")
        for n in wrong[:10]:
            print("  ", dict(zip(("rate", "depth", "phase", "tolerance", "largest", "first"), cases[n], strict=True)),
                  found[n])


if __name__ == "__main__":
    main()
