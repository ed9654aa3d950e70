"""Program: kill commands at random instants, let them continue with --resume, and count what goes wrong.

    python -m tools.kills [--count 100] [--seed 1] [--minutes 10] [run] [curve] [branch] [map]

Each command is started, ended after a random time by SIGINT, SIGTERM or SIGKILL, inspected, and started again with
--resume until it is done. Its result is then compared with that of an undisturbed command.
"""

from __future__ import annotations

import argparse
import datetime
import random
import tempfile
from pathlib import Path

from .trial import COMMANDS, Counts, trial


def main() -> None:
    """Print a row for each command, and every fault as it happens."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commands", nargs="*", default=list(COMMANDS), metavar="COMMAND")
    parser.add_argument("--count", type=int, default=100, help="kills of each command")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=600.0, help="time for each command")
    args = parser.parse_args()
    print(f"{datetime.date.today()}, seed {args.seed}\n\n{Counts.header()}", flush=True)
    for name in args.commands:
        with tempfile.TemporaryDirectory() as folder:
            rng = random.Random(f"{args.seed} {name}")
            print(trial(name, args.count, rng, Path(folder), args.minutes).row(name), flush=True)


if __name__ == "__main__":
    main()
