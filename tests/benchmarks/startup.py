"""Benchmark of start-up and memory: every peer in a separate process, with an empty and with a filled cache."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .tables import seconds, table

_ROOT = Path(__file__).resolve().parents[2]
_BARE = "import json, tests.benchmarks.machine as m; print(json.dumps({'peak_mb': m.peak_megabytes()}))"


def child(command: list[str], cache: str) -> dict[str, Any]:
    """Run a child process and return its output and its total time [s]."""
    places = {"GRANCHAIN_CACHE": cache, "NUMBA_CACHE_DIR": cache, "JAX_COMPILATION_CACHE_DIR": f"{cache}/jax"}
    began = time.perf_counter()
    answer = subprocess.run([sys.executable, *command], cwd=_ROOT, env={**os.environ, **places}, capture_output=True,
                            text=True, check=True)
    return {**json.loads(answer.stdout.strip().splitlines()[-1]), "whole": time.perf_counter() - began}


def _whole(one: dict[str, Any]) -> float:
    return float(one["whole"])


def report(names: list[str], quick: bool, tell: Callable[[str], None]) -> str:
    """Return the table; cold means an empty cache of compiled code, warm the median of three further processes."""
    rows = []
    with tempfile.TemporaryDirectory() as cache:
        bare = child(["-c", _BARE], cache)
        rows.append(["python alone", "", "–", seconds(bare["whole"]), "–", "–", f"{bare['peak_mb']:.0f}"])
    for name in names:
        tell(name)
        with tempfile.TemporaryDirectory() as cache:
            command = ["-m", "tests.benchmarks.child", name]
            cold = child(command, cache)
            warm = [cold] if quick else sorted((child(command, cache) for _ in range(3)), key=_whole)
            middle = warm[len(warm) // 2]
        rows.append([middle["label"], "w", seconds(cold["whole"]), seconds(middle["whole"]),
                     seconds(middle["import"] + middle["first"]), seconds(middle["again"]), f"{middle['peak_mb']:.0f}"])
    if quick:
        rows = [[*row[:3], "–", *row[4:]] for row in rows]
    return table("Start-up and memory: a new process, one trajectory twice",
                 ["peer", "form", "cold, whole", "warm, whole", "to first answer", "second answer", "peak MB"], rows,
                 ["Cold: no compiled code is on disk. The columns to the right are those of a warm process (with --quick, of the "
                  "cold one). C is compiled at every start. CyRK and "
                  "numbalsoda have wrappers that Numba compiles in every process. Peak: largest resident set."])
