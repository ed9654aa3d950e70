"""A program and its kernel: checks with a hundred thousand brief touches that dop853 misses none.

    python -m tests.numerics.touches --count 100000 [--seed 1]

Single touches are those of the hard case (granchain_core/hard_cases/touches.py); pairs within one step are defined
here.
"""

from __future__ import annotations

import argparse
import time
from math import pi

import numpy as np

from granchain_core.hard_cases.touches import (
    CLOSING_ERROR,
    CLOSINGS,
    DEPTH,
    OPENING_ERROR,
    TOLERANCE,
    draw,
    missed,
    moved,
    run,
    workspace,
)
from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.dop853.step import STAGES, Dop853
from granchain_core.kernels.effects.contact import Chain
from granchain_core.kernels.effects.driver import Harmonic
from granchain_core.kernels.effects.foundation import Foundation
from granchain_core.kernels.effects.preload import Preload
from granchain_core.kernels.equations.motion import Slots, Trajectory, copy
from granchain_core.kernels.error_control.located_step import located_step
from granchain_core.kernels.error_control.step import DriveCycle, evaluate

__all__ = ["CLOSINGS", "CLOSING_ERROR", "DEPTH", "OPENING_ERROR", "TOLERANCE", "draw", "missed", "moved", "run", "run_pairs"]


@kernel
def two_touches(rate, gaps, tolerance, work, y, counts, static, chain, times):
    """Compute when two beads on springs, thrown apart with amplitude 1, reach the resting driver and the wall."""
    static[0], static[1], static[2] = -gaps[0], -1e3, -gaps[1]
    slots = Slots(chain, None, None, Foundation(rate * rate), Preload(static), Harmonic(0.0, rate), None)
    end = 0.5 * pi / rate
    for i in range(y.size):
        y[i] = 0.0
    y[5], y[6] = -rate, rate
    work.next_step[0], work.scale[0], work.scale[1], t = 0.1 * end, 1.0, rate, 0.0
    evaluate(slots, rate, t, y, work.k[0], work.forces)
    trajectory = Trajectory(slots, DriveCycle(rate, 4.0 * end), y, work)
    while t < end * (1.0 - 1e-12):
        status, h, _ = located_step(Dop853(tolerance, 0.25 * end), trajectory, t, end, counts)
        if status != 0:
            return
        t += h
        for side in range(2):
            c = 2 * side
            if work.end[c] - work.end[c + 1] + static[c] > 0.0 and times[side] == 0.0:
                times[side] = t
        copy(work.end, y)
        copy(work.k[STAGES], work.k[0])


def run_pairs(count: int, seed: int, tolerance: float) -> np.ndarray:
    """Return rows (count, 3): the time between two touches as a fraction of the period, log-uniform from 1e-13, and the
    errors of both.
    """
    rng = np.random.default_rng(seed)
    work, found = workspace(4), np.zeros((count, 3))
    chain = Chain(np.array([0.0, 1.0, 1.0, 0.0]), np.ones(3))
    for n in range(count):
        rate, apart = 10.0 ** rng.uniform(-1.0, 1.0), 2.0 * pi * 10.0 ** rng.uniform(-13.0, -1.5)
        angles = rng.permutation([first := rng.uniform(0.2, 1.2), first + apart])
        times = np.zeros(2)
        two_touches(rate, np.sin(angles), tolerance, work, np.zeros(8), np.zeros(4, dtype=np.int64), np.zeros(3),
                    chain, times)
        found[n] = apart / (2.0 * pi), *np.abs(times * rate - angles) / (2.0 * pi)
    return found


def main() -> None:
    """Print missed touches and the accuracy of the closings."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    for driven in (True, False):
        run(draw(2, 0, driven), driven)  # compiles the kernel
        began = time.perf_counter()
        cases = draw(args.count, args.seed, driven)
        found = run(cases, driven)
        wrong, touches = missed(cases, found), cases[:, DEPTH] > 0.0
        closing = found[touches, CLOSING_ERROR]
        print(f"{'driver' if driven else 'thrown bead'}: {touches.sum()} touches and {(~touches).sum()} near misses, "
              f"{len(wrong)} wrong, closing within {np.median(closing):.1e} (median), {closing.max():.1e} (worst) of a period, "
              f"{(closing > 1e-12).sum()} above 1e-12, {time.perf_counter() - began:.1f} s")
        if driven:
            exact = touches & (moved(cases) < 1e-12)
            print(f"  {exact.sum()} of these hardly move the bead, and end within {found[exact, OPENING_ERROR].max():.1e} of a "
                  "period of where they should")
        for n in wrong[:10]:
            print("  ", dict(zip(("rate", "depth", "phase", "tolerance", "largest", "first"), cases[n], strict=True)),
                  found[n])


if __name__ == "__main__":
    main()
