"""Cancels pictures at random instants and measures how long they continue (docs/reliability.md).

    python -m tools.cancellations --count 1000 --seed 1

Chains have 1 to 10,000 beads and amplitudes and frequencies from their whole ranges, all drawn uniformly in their
logarithms; scenes that the dashboard computes only on insistence are included. The measured time is that from the stop
flag to the end of the computation's thread. The thread's processor time in this interval does not depend on what else
the machine does.
"""

from __future__ import annotations

import argparse
import os
import random
import threading
import time

from app.frames import samples_for
from granchain_core import BadInput, Cancelled, ComputationError, Scene, Stop, scene, settling
from granchain_core.precompile.pieces import DOP853_KERNELS, FIXED_STEP_KERNELS
from granchain_core.precompile.warm import compile_piece

#: Classes of chain length in the table.
_CLASSES = ((1, 10), (11, 100), (101, 1000), (1001, 10_000))
#: Latest instant of a cancellation [s].
_LATEST = 1.0


def a_scene(chance: random.Random, low: int, high: int) -> Scene:
    """Draw a chain with a random length, amplitude and frequency."""

    def drawn(a: float, b: float) -> float:
        return float(a * (b / a) ** chance.random())

    while True:
        try:
            return scene("sec2").evolve(N=min(high, round(drawn(low, high))), A0=drawn(1e-7, 1e-4), f=drawn(0.3, 3000.0))
        except BadInput:
            continue


def cancelled_after(chain: Scene, instant: float) -> tuple[float, float] | None:
    """Return seconds and processor time from the cancellation to the end; None if the picture was already finished."""
    stop, ended = Stop(), [0.0, 0.0]

    def work() -> None:
        try:
            for _ in settling(chain, samples=samples_for(chain), stop=stop):
                stop.check()
        except (Cancelled, ComputationError, BadInput):
            pass
        ended[:] = time.perf_counter(), time.thread_time()

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    time.sleep(instant)
    if not thread.is_alive():
        return None
    try:
        used = time.clock_gettime(time.pthread_getcpuclockid(thread.ident or 0))
    except OSError:  # the thread has just ended
        return None
    asked = time.perf_counter()
    stop.set()
    thread.join()
    return ended[0] - asked, ended[1] - used


def main() -> None:
    """Print a row for each class of chain length."""
    parser = argparse.ArgumentParser(prog="python -m tools.cancellations", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    for piece in (FIXED_STEP_KERNELS, DOP853_KERNELS):  # the compiler cannot be cancelled; the dashboard runs it in another process
        compile_piece(scene("sec2"), piece)
    cancelled_after(scene("sec2"), 0.5)
    print("beads | cancellations | p50 ms | p99 ms | longest ms | processor p99 ms | longest ms | load")
    for low, high in _CLASSES:
        chance, times = random.Random(f"{options.seed} {low}"), []
        while len(times) < options.count // len(_CLASSES):
            chain = a_scene(chance, low, high)
            taken = cancelled_after(chain, chance.uniform(0.0, _LATEST))
            if taken is not None:
                times.append(taken)
        wall, used = (sorted(1e3 * one for one in column) for column in zip(*times, strict=True))
        most = int(0.99 * len(times))
        print(f"{low} to {high} | {len(times)} | {wall[len(times) // 2]:.0f} | {wall[most]:.0f} | {wall[-1]:.0f} | "
              f"{used[most]:.0f} | {used[-1]:.0f} | {os.getloadavg()[0]:.1f}", flush=True)


if __name__ == "__main__":
    main()
