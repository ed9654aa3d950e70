"""Time `resonance_curve`, as a user calls it, in a separate process: on all cores and on one, alternately.

    python -m tests.benchmarks.product 9 frequencies.json

Other solvers that were loaded before would cost it a fifth of its time. The output is one JSON object: for each number
of threads, the seconds of every turn, the forces, and which points are periodic.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from granchain_core import resonance_curve, scene

from . import machine


def main(turns: int, frequencies: np.ndarray) -> None:
    """Time the curve over these frequencies `turns` times with each number of threads."""
    machine.pin()
    threads = (machine.unpin(), 1)
    curves: dict[int, Any] = {}
    times: dict[int, list[float]] = {workers: [] for workers in threads}
    for turn in range(turns):
        for workers in threads:
            machine.pin() if workers == 1 else machine.unpin()
            if turn == 0:
                resonance_curve(scene("sec2"), frequencies[::25], workers=workers)  # the first call may compile
            began = time.perf_counter()
            curves[workers] = resonance_curve(scene("sec2"), frequencies, workers=workers)
            times[workers].append(time.perf_counter() - began)
    print(json.dumps({str(workers): {
        "seconds": times[workers],
        "forces": list(curve.column("max_output_force_elastic")),
        "periodic": [point.regime.name == "periodic" for point in curve.points],
    } for workers, curve in curves.items()}))


if __name__ == "__main__":
    main(int(sys.argv[1]), np.array(json.loads(Path(sys.argv[2]).read_text(encoding="utf-8"))))
