"""Compiled code is kept on disk: a second process compiles nothing."""

from __future__ import annotations

import json
import os
import subprocess
import sys

PROGRAM = """
import json, sys
from numba.core.dispatcher import Dispatcher
from granchain_core import scene
from granchain_core.integrate import Engine, Setting
for method in ("rk4", "dop853"):
    engine = Engine(scene("sec2").evolve(N=2, f=2000.0), Setting(method, tolerance=1e-3), 2)
    engine.periods(1)
    engine.record(2)
kernels = {id(k): k for name, module in sys.modules.items() if name.startswith("granchain_core")
           for k in vars(module).values() if isinstance(k, Dispatcher)}.values()
print(json.dumps([sum(sum(getattr(k.stats, name).values()) for k in kernels) for name in ("cache_hits", "cache_misses")]))
"""


def hits_and_misses(cache: str) -> tuple[int, int]:
    """Numba's own count in a new process that runs one fixed-step and one certified computation."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p), "GRANCHAIN_CACHE": cache}
    done = subprocess.run([sys.executable, "-c", PROGRAM], env=environment, text=True, capture_output=True,
                          timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    hits, misses = json.loads(done.stdout)
    return hits, misses


def test_second_process_compiles_nothing(tmp_path):
    """Empty cache: the first process compiles the entries and all they call; the next loads the entries from disk."""
    _, compiled = hits_and_misses(str(tmp_path))
    hits, misses = hits_and_misses(str(tmp_path))
    assert compiled >= 10
    assert hits >= 3  # run_steps, run_certified, place
    assert misses == 0
