"""Program: profile where a resonance curve spends its time, with cProfile in the computing thread.

    python -m tools.profile_curve [--scene sec2] [--from 30] [--to 3000] [--points 298] [--rows 30]

Kernels appear as built-in methods (`run_batch` is the batch), Python code as functions of the package. Profiling slows
down Python but not kernels, so the shares of Python are too large. The last line has the time without profiling.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import threading
import time
from collections.abc import Callable
from unittest import mock

import numpy as np

from granchain_core import resonance_curve, scene


def profiled(work: Callable[[], object]) -> pstats.Stats:
    """Run `work`, and return the profile of the threads that it starts."""
    profiles: list[cProfile.Profile] = []
    run = threading.Thread.run

    def run_profiled(thread: threading.Thread) -> None:
        profile = cProfile.Profile()
        profiles.append(profile)
        profile.runcall(run, thread)

    with mock.patch.object(threading.Thread, "run", run_profiled):
        work()
    return pstats.Stats(*profiles)


def main() -> None:
    """Print the functions that take the most time, then the time of a curve on one thread."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--scene", default="sec2")
    parser.add_argument("--from", dest="low", type=float, default=30.0)
    parser.add_argument("--to", dest="high", type=float, default=3000.0)
    parser.add_argument("--points", type=int, default=298)
    parser.add_argument("--rows", type=int, default=30)
    given = parser.parse_args()
    chain, frequencies = scene(given.scene), np.linspace(given.low, given.high, given.points)

    def curve() -> object:
        return resonance_curve(chain, frequencies, workers=1)

    curve()  # compiles
    profiled(curve).strip_dirs().sort_stats("tottime").print_stats(given.rows)
    began = time.perf_counter()
    curve()
    print(f"{given.points} points on one thread, without profiling: {time.perf_counter() - began:.3f} s")


if __name__ == "__main__":
    main()
