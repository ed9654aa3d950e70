"""Program: draw complete scenes, check each, and print the table and every scene in which a check failed.

    python -m tools.fuzzing --count 20000 --seed 5 [--workers 2] [--minutes 10] [--few]
    python -m tools.fuzzing --seed 5 --only 123

Every scene is compared with dop853 at its finest tolerance, and every third one also with SciPy in (u, v), unless that
would take long. Every sixteenth scene is also given to naive RK4 and to LSODA.
"""

from __future__ import annotations

import argparse
import time

from .check import check
from .many import OTHERS, SCIPY, verdicts, warm
from .scenes import FEW, STRUCTURES, draw
from .table import describe, table


def main() -> None:
    """Print the table and the scenes in which a check failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=600.0)
    parser.add_argument("--few", action="store_true", help="only the structures of the test suite")
    parser.add_argument("--only", type=int, help="only this draw")
    args = parser.parse_args()
    structures, found = FEW if args.few else STRUCTURES, []
    if args.only is not None:
        one = draw(args.seed, args.only, structures)
        warm([s for s in structures if s[:2] == (one.knobs["dissipation"], one.knobs["tension"])])
        print(describe(check(one, scipy=10.0 * SCIPY, others=OTHERS)))
        return
    warm(structures)
    began = time.perf_counter()
    for verdict in verdicts(args.count, args.seed, structures, args.workers, args.minutes):
        found.append(verdict)
        if verdict.faults:
            print(describe(verdict), flush=True)
    print(f"\nseed {args.seed}, draws 0 to {len(found) - 1}, {len(structures)} structures, {time.perf_counter() - began:.0f} s\n")
    print(table(sorted(found, key=lambda v: v.draw.index)), flush=True)


if __name__ == "__main__":
    main()
