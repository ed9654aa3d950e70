"""A program that checks the stated errors of the largest forces: it prints a table for random scenes, and every scene
with a force outside its stated error.

    python -m tests.numerics.forces run --count 1000 [--seed 1] [--few]
    python -m tests.numerics.forces curve --count 100
    python -m tests.numerics.forces map --count 100
    python -m tests.numerics.forces run --seed 1 --only 17
    python -m tests.numerics.forces run --scene sec2 --set f=1130 --periods 300 --record 3

`run` checks whole motions; `curve` and `map` check steady states, with eight frequencies or cells per draw. The seeds
with which safety factors were chosen are not those with which they are reported. `--scene` judges a single motion, as
`granchain run` computes it. The status is then 1 if a force is not within its stated error.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections import Counter

import numpy as np

from app.cli.common import chosen_scene
from granchain_core import BadInput, Scene

from .draw import FEW, STRUCTURES, Draw
from .judge import COLUMNS, MOST_STEPS, SILENT, Verdict, judge_run, verdicts

#: Limits between the table's groups of λ.
_STRENGTHS = (0.0, 0.02, 0.1, 0.5, 2.0, 100.0)


def describe(v: Verdict) -> str:
    """Describe a verdict in one line."""
    s = v.scene
    figures = "; ".join(f"{name} true {e:.2e} stated {b:.1e} known {k:.0e}"
                        for name, e, b, k in zip(COLUMNS, v.error, v.stated, v.known, strict=True))
    return (f"{v.kind} {v.index} λ={v.strength:.2g} {v.what}: {figures}: "
            f"{s.name} f={s.f!r} A0={s.A0!r} D={s.D!r} k={s.k!r} F0={s.F0!r} N={s.N} "
            f"{s.wall} {s.dissipation} {s.tension} accuracy={s.accuracy:g} thrown={s.start_velocity}")


def table(found: list[Verdict]) -> str:
    """Return a table by damping and force: numbers of claims, of bounded ones, and of forces with large errors."""
    rows = ["      λ          force    scenes  judged  claimed  bounded  wrong by > 1e-3 (all)  silent  median true/stated   worst"]
    groups = [(f"{a:g}..{b:g}", [v for v in found if a <= v.strength < b]) for a, b in itertools.pairwise(_STRENGTHS)]
    for name, part in [*groups, ("all", found)]:
        for c, force in enumerate(COLUMNS if part else ()):
            sure = [v for v in part if v.judged[c]]
            claimed = [v for v in sure if not np.isnan(v.stated[c])]
            ratio = np.array([v.error[c] / max(v.stated[c], 1e-300) for v in claimed] or [np.nan])
            rows.append(f"{name:>12} {force:>10} {len(part):9} {len(sure):7} {len(claimed):8} {_part([v.bounded[c] for v in claimed])} "
                        f"{_part([v.error[c] > SILENT for v in sure]):>14} {sum(bool(v.silent[c]) for v in sure):14} "
                        f"{np.median(ratio):15.2g} {ratio.max():12.2g}")
    return "\n".join(rows)


def _part(true: list) -> str:
    return f"{np.mean(true):9.2%}" if true else "        –"


def _summary(args: argparse.Namespace, found: list[Verdict], others: Counter[str], began: float) -> str:
    """Summarise the verdicts so far in a line and a table."""
    apart = "; ".join(f"{count} {name}" for name, count in others.items())
    return (f"{args.kind}, seed {args.seed}: {len(found)} scenes in {time.perf_counter() - began:.0f} s"
            f"{'; ' if apart else ''}{apart}\n{table(found)}")


def judge_one(scene: Scene, periods: int, record: int, most_steps: int) -> int:
    """Print the verdict on the forces of one motion; return 1 if one is not judged or not within its stated error."""
    verdict = judge_run(Draw(0, scene, periods, record), most_steps)
    if isinstance(verdict, str):
        print(f"Not judged: {verdict}.")
        return 1
    good = True
    for c, name in enumerate(COLUMNS):
        stated = not np.isnan(verdict.stated[c])
        good &= bool(verdict.judged[c] and (verdict.bounded[c] or not stated))
        claim = ("not judged: the reference is not known well enough" if not verdict.judged[c] else "no error is stated" if not stated
                 else "within it" if verdict.bounded[c] else "NOT WITHIN it")
        print(f"{name} force: true error {verdict.error[c]:.1e} ± {verdict.known[c]:.0e}, stated error {verdict.stated[c]:.1e}: {claim}")
    return int(not good)


def main() -> int:
    """Print the table and the unbounded cases, or the verdict on one motion; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=("run", "curve", "map"))
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--few", action="store_true", help="only the structures of the test suite")
    parser.add_argument("--only", type=int, help="judge only this draw")
    parser.add_argument("--minutes", type=float, default=600.0, help="start no draw later than this")
    own = parser.add_argument_group("one motion instead of random ones")
    own.add_argument("--scene", metavar="SCENE", help="a name of `granchain scenes`, or a scene file NAME.toml")
    own.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="change a knob")
    own.add_argument("--periods", type=int, default=100, help="drive periods before those recorded (%(default)s)")
    own.add_argument("--record", type=int, default=20, help="drive periods recorded (%(default)s)")
    own.add_argument("--most-steps", type=int, default=MOST_STEPS, help="give up the reference after this many steps (%(default)s)")
    args = parser.parse_args()
    if args.scene is not None:
        if args.kind != "run":
            parser.error("--scene is for run")
        try:
            chosen = chosen_scene(args)
            if not chosen.is_driven:
                parser.error("the reference can compute driven chains only")
            return judge_one(chosen, args.periods, args.record, args.most_steps)
        except BadInput as problem:
            parser.error(str(problem))
    began, found, others = time.perf_counter(), [], Counter[str]()
    first, count = (0, args.count) if args.only is None else (args.only, 1)
    for verdict in verdicts(args.kind, count, args.seed, FEW if args.few else STRUCTURES, first):
        if isinstance(verdict, str):
            others[verdict] += 1
            continue
        found.append(verdict)
        faults = verdict.judged & ~np.isnan(verdict.stated) & (~verdict.bounded | verdict.silent)
        if faults.any() or args.only is not None:
            print(describe(verdict), flush=True)
        if len(found) % 100 == 0:
            print(_summary(args, found, others, began), flush=True)
        if time.perf_counter() > began + 60.0 * args.minutes:
            break
    print(_summary(args, found, others, began))
    return 0


if __name__ == "__main__":
    sys.exit(main())
