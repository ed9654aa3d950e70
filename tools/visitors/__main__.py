"""How fast the dashboard answers many visitors, each of whom moves a knob once a second (docs/reliability.md).

    python -m tools.visitors --count 24 --minutes 1
    python -m tools.visitors --count 24 --minutes 1 --heavy      with nine other pages of 10,000 beads at 0.1 Hz
    python -m tools.visitors soak --minutes 120                  visits that open, move and leave: memory, threads, …
    python -m tools.visitors restart --count 200                 how soon all pages are back after a restart

It starts a server of its own, unless `--address` names one that is already running.
"""

from __future__ import annotations

import argparse
import asyncio
import tempfile
from pathlib import Path

from . import load, restart, soak
from .started import Started


def main() -> None:
    """Read the options, run the load, the soak or the restart, and print its table."""
    parser = argparse.ArgumentParser(prog="python -m tools.visitors", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("what", nargs="?", choices=("load", "soak", "restart"), default="load")
    parser.add_argument("--count", type=int, default=24, help="visitors")
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--heavy", "--bomb", action="store_true",
                        help="add nine pages of 10,000 beads at 0.1 Hz that insist on their picture")
    parser.add_argument("--same", action="store_true", help="all visitors make the same moves")
    parser.add_argument("--address", help="a running dashboard, for example http://127.0.0.1:5006")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, Started(options.address, Path(folder) / "log") as server:
        if options.what == "soak":
            asyncio.run(soak.run(server, options.minutes, options.seed))
        elif options.what == "restart":
            asyncio.run(restart.run(server, options.count, options.seed))
        else:
            asyncio.run(load.run(server, options.count, options.minutes, options.heavy, options.same, options.seed))


if __name__ == "__main__":
    main()
