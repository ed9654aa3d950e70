"""Run a small kernel in a separate process, with its own cache."""

from __future__ import annotations

import json
import os
from pathlib import Path

from forked import python

ROOT = Path(__file__).resolve().parents[3]

#: Runs one small kernel and prints the cache folder, whether its result is right, and how often Numba loaded it.
PROGRAM = """
import json
import numpy as np
from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER
from granchain_core.kernels.forces.peaks import PEAKS, reset_peaks
peaks = np.ones(PEAKS)
reset_peaks(peaks)
right = bool(peaks[0] == -np.inf and peaks[1] == 0.0)
print(json.dumps({"folder": str(CACHE_FOLDER), "right": right, "loaded": sum(reset_peaks.stats.cache_hits.values())}))
"""
#: Prints the cache folder and compiles nothing.
FOLDER = """
import json
from granchain_core.kernels.compiling.cache_folder import CACHE_FOLDER
print(json.dumps({"folder": str(CACHE_FOLDER)}))
"""


def used(folder: Path, program: str = PROGRAM) -> tuple[dict, list[str]]:
    """Run a program in a new process. Return what it prints about its kernel, and its lines on stderr."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "GRANCHAIN_CACHE": str(folder)}
    done = python("-c", program, folder=ROOT, environment=environment)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1]), done.stderr.splitlines()
