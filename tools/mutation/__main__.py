"""Program: change the core in one place at a time and see whether a test notices.

    python -m tools.mutation [--only PART_OF_A_NAME ...] [--list | --at FILE | --check] [--minutes M] [--seed S]
                             [--work FOLDER] [--named]

The tests named in the table are first run on the unchanged core, then with each mutant. A mutant that survives them is
run against all tests of the core before it counts as survived. With --seed, the order is random, so that --minutes
gives a sample of the table. --at runs nothing and lists the mutants of a file, by line, with their tests. --check runs
nothing and lists the entries that no longer match the source or the tests' names; as long as there are any, no run
starts. --work keeps the copy and the compiled kernels of the unchanged core for the next run.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from dataclasses import replace
from pathlib import Path

from .bench import Bench, Outcome
from .in_step import problems
from .mutant import ROOT, Mutant
from .table import BROAD, DEMANDED, MUTANTS

#: Time that the named tests may take [s]. A mutant that hangs is killed after it and listed as timed out.
_LIMIT = 150.0
#: Time that all tests may take [s].
_BROAD_LIMIT = 3600.0


def main() -> int:
    """Print the table and the share that died; return 1 if one survived or the unchanged core fails its tests."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="*", default=[], help="only mutants with one of these words in their name")
    parser.add_argument("--list", action="store_true", help="print the table without running anything")
    parser.add_argument("--at", metavar="FILE", help="print the mutants of a file and their tests, without running anything")
    parser.add_argument("--check", action="store_true", help="check whether the table matches source and tests")
    parser.add_argument("--minutes", type=float, default=1e9, help="start no mutant after this time")
    parser.add_argument("--seed", type=int, help="run the mutants in random order")
    parser.add_argument("--work", type=Path, help="folder for the copy, which is kept")
    parser.add_argument("--named", action="store_true", help="run only the named tests")
    args = parser.parse_args()
    chosen = [m for m in MUTANTS if not args.only or any(word in m.name for word in args.only)]
    if args.seed is not None:
        random.Random(args.seed).shuffle(chosen)
    if args.list:
        for one in chosen:
            print(f"{one.name}: {one.breaks} ({one.path})")
        return 0
    if args.at:
        return _list_at(args.at, chosen)
    if found := problems():
        print("The table is out of step with the source:", *found, sep="\n  ")
        return 1
    if args.check:
        print(f"{len(MUTANTS)} mutants in step with the source")
        return 0
    with Bench(args.work) as bench:
        return _run(bench, chosen, time.perf_counter() + 60.0 * args.minutes, args.named)


def _list_at(file: str, chosen: list[Mutant]) -> int:
    """Print the mutants of a file in the order of its lines, with their tests; return 1 if there are none."""
    path = Path(file).resolve()
    found = sorted((one.line, one.name, one) for one in chosen
                   if path == ROOT / one.path or file in (one.file, one.path))
    for line, _, one in found:
        print(f"{one.path}:{line}  {one.name}: {one.breaks}\n    {' '.join(one.killers)}")
    if not found:
        print(f"No mutant changes {file}.")
    return 0 if found else 1


def _run(bench: Bench, chosen: list[Mutant], end: float, named_only: bool) -> int:
    sound: set[tuple[str, ...]] = set()
    ended: list[tuple[Mutant, Outcome]] = []
    for one in chosen:
        if time.perf_counter() > end:
            break
        for tests in filter(None, (one.killers, one.blind)):
            if tests not in sound and not _passes(bench, tests, _LIMIT, one.optimised):
                return 1
            sound.add(tests)
        found = bench.mutated(one, one.killers, _LIMIT)
        if one.blind and (seen := bench.mutated(one, one.blind, _LIMIT)).verdict != "passed":
            print(f"{one.name} should not be noticed by {' '.join(one.blind)}: {seen.verdict} {seen.by}\n{seen.tail}")
            return 1
        if found.verdict == "passed" and not named_only:
            if BROAD not in sound and not _passes(bench, BROAD, _BROAD_LIMIT, False):
                return 1
            sound.add(BROAD)
            found = bench.mutated(one, BROAD, _BROAD_LIMIT)
            if found.verdict == "timed out":  # with so many tests, a timeout is no evidence
                found = replace(found, verdict="passed")
        ended.append((one, found))
        print(_row(one, found), flush=True)
    alive = [one.name for one, found in ended if found.verdict in ("passed", "stillborn")]
    died = len(ended) - len(alive)
    late = sum(found.verdict == "timed out" for _, found in ended)
    print(f"\n{died} of {len(ended)} mutants died ({100.0 * died / max(1, len(ended)):.1f} %), {late} of them by a timeout")
    for tests, names in DEMANDED.items():
        if set(names) <= {one.name for one, _ in ended}:
            print(f"{tests}: {'survived' if set(names) & set(alive) else 'dead'} ({', '.join(names)})")
    for name in alive:
        print(f"survived or stillborn: {name}")
    return 1 if alive else 0


def _passes(bench: Bench, tests: tuple[str, ...], limit: float, optimised: bool) -> bool:
    """Return whether the unchanged core passes; print the reason if it does not."""
    found = bench.plainly(tests, limit, optimised)
    if found.verdict != "passed":
        print(f"the unchanged core does not pass {' '.join(tests)}: {found.verdict} {found.by}\n{found.tail}")
    return found.verdict == "passed"


def _row(one: Mutant, found: Outcome) -> str:
    by = {"passed": "SURVIVED", "stillborn": "STILLBORN", "timed out": "a timeout", "crashed": "a crash"}.get(found.verdict, found.by or "import")
    return f"{one.name:34s} {by:110s} {found.seconds:6.1f} s"


if __name__ == "__main__":
    sys.exit(main())
