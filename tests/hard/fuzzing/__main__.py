"""Program: draw whole scenes, check each, print the table and every scene in which something did not hold.

    python -m tests.hard.fuzzing --count 20000 --seed 5 [--workers 2] [--minutes 10] [--few]
    python -m tests.hard.fuzzing --seed 5 --only 123

Every scene is held against the certified method at its finest, every third against SciPy in (u, v) too, every fifth
is given to naive RK4 and to LSODA. Where tension is cut SciPy judges always, as `run` itself is certified there.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from multiprocessing import get_context

from .check import Verdict, check
from .scenes import FEW, STRUCTURES, Draw, draw
from .table import describe, table

#: Seconds that SciPy may take for one scene, and each of the other solvers.
_SCIPY, _OTHERS = 4.0, 10.0
_EVERY_SCIPY, _EVERY_OTHERS = 3, 5


def warm(structures: list[tuple[str, str, bool, bool]]) -> None:
    """Compile everything a check needs, so that no run's time is a compiler's."""
    for law, tension, founded, pressed in structures:
        knobs = {"N": 2, "f": 3000.0, "accuracy": 1e-4, "dissipation": law, "tension": tension,
                 **({"kappa": 0.001} if founded else {}), **({"F0": 1.0} if pressed else {})}
        check(Draw(0, 0, knobs, {}, False), scipy=60.0, others=60.0, budget=1000.0)


def verdict_on(seed: int, index: int, structures: list[tuple[str, str, bool, bool]]) -> Verdict:
    """The verdict on draw `index`, with the judges its number says."""
    drawn = draw(seed, index, structures)
    judged = index % _EVERY_SCIPY == 0 or drawn.knobs["tension"] == "cut"
    return check(drawn, scipy=_SCIPY if judged else 0.0, others=0.0 if index % _EVERY_OTHERS else _OTHERS)


def verdicts(count: int, seed: int, structures: list[tuple[str, str, bool, bool]], workers: int,
             minutes: float) -> Iterator[Verdict]:
    """Verdicts on draws 0, 1, … as they are finished; none is begun after `minutes`."""
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


def main() -> None:
    """Print the table and the scenes in which something did not hold."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=600.0)
    parser.add_argument("--few", action="store_true", help="only the structures of the test suite")
    parser.add_argument("--only", type=int, help="this draw alone")
    words = parser.parse_args()
    structures, found = FEW if words.few else STRUCTURES, []
    if words.only is not None:
        one = draw(words.seed, words.only, structures)
        warm([s for s in structures if s[:2] == (one.knobs["dissipation"], one.knobs["tension"])])
        print(describe(check(one, scipy=10.0 * _SCIPY, others=_OTHERS)))
        return
    warm(structures)
    began = time.perf_counter()
    for verdict in verdicts(words.count, words.seed, structures, words.workers, words.minutes):
        found.append(verdict)
        if verdict.faults:
            print(describe(verdict), flush=True)
    print(f"\nseed {words.seed}, draws 0 to {len(found) - 1}, {len(structures)} structures, {time.perf_counter() - began:.0f} s\n")
    print(table(sorted(found, key=lambda v: v.draw.index)), flush=True)


if __name__ == "__main__":
    main()
