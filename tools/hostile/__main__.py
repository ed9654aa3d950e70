"""Does hostile input ever lead to a traceback, a hang or another visitor's wait? (docs/reliability.md)

    python -m tools.hostile commands --count 5000 --seed 1
    python -m tools.hostile messages --count 10000 --seed 1
"""

from __future__ import annotations

import argparse
import asyncio
import tempfile
from pathlib import Path

from tools.visitors.started import Started

from . import commands


def main() -> int:
    """Run the command lines or the messages; return 1 if anything was wrong."""
    parser = argparse.ArgumentParser(prog="python -m tools.hostile", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("what", choices=("commands", "messages"))
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=20.0, help="time that a command line may take")
    parser.add_argument("--address", help="a running dashboard to send the messages to, for example http://127.0.0.1:5006")
    options = parser.parse_args()
    if options.what == "commands":
        return min(1, commands.run(options.count, options.seed, options.seconds))
    from . import messages  # imports the dashboard, which command lines do not need

    with tempfile.TemporaryDirectory() as folder, Started(options.address, Path(folder) / "log") as server:
        return min(1, asyncio.run(messages.run(server, options.count, options.seed)))


if __name__ == "__main__":
    raise SystemExit(main())
