"""Many draws, on several processes."""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from multiprocessing import get_context

from .check import Verdict, check
from .scenes import Draw, draw

#: Time that SciPy may take for one scene [s].
SCIPY = 1.0
#: Time that each of the other solvers may take for one scene [s].
OTHERS = 4.0
#: SciPy judges every third scene; the other solvers, which are slower, compute every sixteenth.
_EVERY_SCIPY = 3
_EVERY_OTHERS = 16


def warm(structures: list[tuple[str, str, bool, bool]]) -> None:
    """Compile everything that a check needs, so that no run is timed while the compiler works."""
    for law, tension, founded, pressed in structures:
        knobs = {"N": 2, "f": 3000.0, "accuracy": 1e-4, "dissipation": law, "tension": tension,
                 **({"kappa": 0.001} if founded else {}), **({"F0": 1.0} if pressed else {})}
        check(Draw(0, 0, knobs, {}, False), scipy=60.0, others=60.0, budget=1000.0)


def verdict_on(seed: int, index: int, structures: list[tuple[str, str, bool, bool]]) -> Verdict:
    """Return the verdict on draw `index`, whose number decides which judges are used."""
    return check(draw(seed, index, structures), scipy=0.0 if index % _EVERY_SCIPY else SCIPY,
                 others=0.0 if index % _EVERY_OTHERS else OTHERS)


def verdicts(count: int, seed: int, structures: list[tuple[str, str, bool, bool]], workers: int,
             minutes: float) -> Iterator[Verdict]:
    """Yield verdicts on draws 0, 1, … as they are finished; none is started after `minutes`."""
    until, index = time.perf_counter() + 60.0 * minutes, 0
    with ProcessPoolExecutor(workers, get_context("spawn"), warm, (structures,)) as pool:
        running: set[Future[Verdict]] = set()
        while running or (index < count and time.perf_counter() < until):
            while len(running) < 2 * workers and index < count and time.perf_counter() < until:
                running.add(pool.submit(verdict_on, seed, index, structures))
                index += 1
            done, running = wait(running, return_when=FIRST_COMPLETED)
            for one in done:
                yield one.result()
