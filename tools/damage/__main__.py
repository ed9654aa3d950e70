"""Program: harm files of every kind, read them, and print the outcomes.

    python -m tools.damage --count 1000 --seed 1 [--kind run] [--old]

Without --old, the files have their seal, and forgeries are sealed again. With it, they are as earlier versions wrote
them.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter

from .harms import HARMS
from .judge import HANG, OUTCOMES, TRACEBACK, WRONG, Verdict, verdicts
from .kinds import KINDS


def table(found: list[Verdict], by: str) -> str:
    """Return the outcomes by "kind" or "harm" as a Markdown table."""
    counts = Counter((getattr(v, by), v.outcome) for v in found)
    rows = [name for name in (KINDS if by == "kind" else HARMS) if any(getattr(v, by) == name for v in found)]
    lines = [f"| {by} | files | " + " | ".join(OUTCOMES) + " |", "|---" * (len(OUTCOMES) + 2) + "|"]
    lines += [f"| {name} | {sum(counts[name, o] for o in OUTCOMES)} | " +
              " | ".join(str(counts[name, o]) for o in OUTCOMES) + " |" for name in rows]
    return "\n".join(lines)


def main() -> None:
    """Print two tables, and every file that was neither refused nor read correctly."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="files of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=KINDS, help="only this kind")
    parser.add_argument("--old", action="store_true", help="files without a seal")
    args = parser.parse_args()
    found: list[Verdict] = []
    for kind in [args.kind] if args.kind else KINDS:
        began = time.perf_counter()
        for verdict in verdicts(kind, not args.old, args.count, args.seed):
            found.append(verdict)
            if verdict.outcome in (TRACEBACK, HANG) or (verdict.outcome == WRONG and verdict.sealed):
                print(verdict, flush=True)
        print(f"{kind}: {args.count} files in {time.perf_counter() - began:.0f} s", flush=True)
    print("\n" + table(found, "kind") + "\n\n" + table(found, "harm"))


if __name__ == "__main__":
    main()
