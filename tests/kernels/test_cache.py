"""Compiled code is kept on disk: a second process compiles nothing."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import granchain_core

PROGRAM = """
import json, sys
from numba.core.dispatcher import Dispatcher
from granchain_core import scene
from granchain_core.integrate import Engine, Setting
for method in ("rk4", "dop853"):
    engine = Engine(scene("sec2").evolve(N=2, f=2000.0), Setting(method, tolerance=1e-3), 2)
    engine.periods(1)
    engine.record(2)
found = [getattr(k, "dispatcher", k) for name, module in sys.modules.items() if name.startswith("granchain_core")
         for k in vars(module).values()]
kernels = {id(k): k for k in found if isinstance(k, Dispatcher)}.values()
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


#: Notes that a piece is compiled, or asks whether it is, without compiling anything.
MARK = """
import sys
from granchain_core import scene, warm
warm.PIECES[warm.LIVE] = lambda short: None
if sys.argv[1] == "compile":
    warm.compile_piece(scene("sec2"), warm.LIVE)
print(warm.is_warm(scene("sec2"), [warm.LIVE]))
"""


def copied_core(tree: Path) -> Path:
    """A copy of the core with its scenes, files with the same times."""
    root = Path(granchain_core.__path__[0]).parent
    for name in ("granchain_core", "assets"):
        shutil.copytree(root / name, tree / name, ignore=shutil.ignore_patterns("__pycache__"))
    return tree


def is_warm(tree: Path, cache: Path, word: str = "ask") -> bool:
    """What a new process in a copy of the core says."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "GRANCHAIN_CACHE": str(cache)}
    done = subprocess.run([sys.executable, "-c", MARK, word], env=environment, cwd=tree, text=True, capture_output=True,
                          timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip() == "True"


def test_what_numba_would_compile_again_is_not_called_compiled(tmp_path: Path) -> None:
    """Numba knows a source by its place and its time: from another clone, and after a touch, it compiles anew."""
    tree, clone, cache = copied_core(tmp_path / "one"), copied_core(tmp_path / "two"), tmp_path / "cache"
    assert is_warm(tree, cache, "compile")
    assert is_warm(tree, cache)
    assert not is_warm(clone, cache)
    touched = tree / "granchain_core" / "kernels" / "samples.py"
    os.utime(touched, ns=(0, touched.stat().st_mtime_ns + 1))
    assert not is_warm(tree, cache)
    assert len(list(cache.iterdir())) == 1  # the content is the same, so all of it was in one folder


def test_second_process_compiles_nothing(tmp_path):
    """Empty cache: the first process compiles the entries and all they call; the next loads the entries from disk."""
    _, compiled = hits_and_misses(str(tmp_path))
    hits, misses = hits_and_misses(str(tmp_path))
    assert compiled >= 10
    assert hits >= 3  # run_steps, run_certified, place
    assert misses == 0
