"""Measure one peer in its own process: the time from the start to its first trajectory, and its largest memory.

    python -m tests.benchmarks.child numbalsoda

Prints one JSON object. No other peer is imported.
"""

from __future__ import annotations

import json
import sys
import time

from . import machine
from .peers import peer

BEGAN = time.perf_counter()


def main(name: str) -> None:
    """Import the peer, and solve the trajectory twice at its loosest setting."""
    case = next(c for c in peer(name).cases() if c.prepare is not None and c.form == "w")
    imported = time.perf_counter()
    run = case.prepare(case.ladder[0])
    run()
    first = time.perf_counter()
    run()
    print(json.dumps({
        "label": case.label, "import": imported - BEGAN, "first": first - imported, "again": time.perf_counter() - first,
        "peak_mb": machine.peak_megabytes(),
    }))


if __name__ == "__main__":
    main(sys.argv[1])
