"""Compiled code is kept on disk: a second process compiles nothing."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
from forked import python

import granchain_core
from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting

#: Kernels that compile in a few seconds and that every engine needs, and those of whole runs with the two methods.
PLACE, METHODS = "engine.evaluate()", "engine.periods(1); engine.record(2)"
PROGRAM = """
import json, sys
from numba.core.dispatcher import Dispatcher
from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting
for method in ("rk4", "dop853"):
    engine = Engine(scene("sec2").evolve(f=2000.0), MethodSetting(method, tolerance=1e-3), 2)
    exec(sys.argv[1])
found = [getattr(k, "dispatcher", k) for name, module in sys.modules.items() if name.startswith("granchain_core")
         for k in vars(module).values()]
kernels = {id(k): k for k in found if isinstance(k, Dispatcher)}.values()
print(json.dumps([sum(sum(getattr(k.stats, name).values()) for k in kernels) for name in ("cache_hits", "cache_misses")]))
"""


def hits_and_misses(cache: Path | None, tree: Path, does: str) -> tuple[int, int]:
    """Return Numba's own counts from a new process with the core in `tree`. With `cache` None, it uses the cache folder
    that all tests share.
    """
    environment = {**os.environ, "PYTHONPATH": str(tree), **({} if cache is None else {"GRANCHAIN_CACHE": str(cache)})}
    done = python("-c", PROGRAM, does, folder=tree, environment=environment)
    assert done.returncode == 0, done.stderr
    hits, misses = json.loads(done.stdout)
    return hits, misses


#: Marks a piece as compiled, or asks whether it is, without compiling anything.
MARK = """
import sys
from granchain_core import scene
from granchain_core.precompile import warm
warm.PIECES[warm.FIXED_STEP_KERNELS] = lambda short: None
if sys.argv[1] == "compile":
    warm.compile_piece(scene("sec2"), warm.FIXED_STEP_KERNELS)
print(warm.is_warm(scene("sec2"), [warm.FIXED_STEP_KERNELS]))
"""


def copied_core(tree: Path) -> Path:
    """Copy the core and its scenes, keeping the files' times so that Python's own compiled files remain valid."""
    root = Path(granchain_core.__path__[0]).parent
    for name in ("granchain_core", "assets"):
        shutil.copytree(root / name, tree / name, ignore=shutil.ignore_patterns("*.pyc.*"))  # another process's unfinished files
    return tree


def is_warm(tree: Path, cache: Path, word: str = "ask") -> bool:
    """Ask a new process that uses a copy of the core whether the piece is compiled; `word` "compile" marks it first."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "GRANCHAIN_CACHE": str(cache)}
    done = python("-c", MARK, word, folder=tree, environment=environment)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip() == "True"


def test_kernels_count_as_compiled_by_the_content_of_their_sources(tmp_path: Path) -> None:
    """Nothing is recompiled for a copy with the same sources, touched files or a new comment, only for an edit."""
    tree, clone, cache = copied_core(tmp_path / "one"), copied_core(tmp_path / "two"), tmp_path / "cache"
    assert not is_warm(tree, cache)
    assert is_warm(tree, cache, "compile")
    touched = clone / "granchain_core" / "kernels" / "samples.py"
    os.utime(touched, ns=(0, 0))
    assert is_warm(clone, cache)
    assert len(list(cache.iterdir())) == 1
    touched.write_text(touched.read_text(encoding="utf-8") + "# edited\n", encoding="utf-8")
    assert is_warm(clone, cache)
    touched.write_text(touched.read_text(encoding="utf-8") + "EDITED = 1\n", encoding="utf-8")
    assert not is_warm(clone, cache)
    assert is_warm(tree, cache)


def touched(tree: Path) -> Path:
    """Copy the core and change the times of the kernels' files."""
    for path in (copied_core(tree) / "granchain_core" / "kernels").rglob("*.py"):
        os.utime(path, ns=(0, 0))
    return tree


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A copy of the core, and the cache that its first process filled with the entries and everything they call."""
    folder = tmp_path_factory.mktemp("compiled")
    tree, cache = copied_core(folder / "one"), folder / "cache"
    assert hits_and_misses(cache, tree, PLACE)[1] >= 2
    return tree, cache


def test_second_process_compiles_nothing_nor_does_another_copy_of_the_sources(compiled: tuple[Path, Path],
                                                                              tmp_path: Path) -> None:
    """Later processes load the entries from disk."""
    tree, cache = compiled
    for there in (tree, touched(tmp_path / "two")):
        hits, misses = hits_and_misses(cache, there, PLACE)
        assert hits >= 1
        assert misses == 0


def reworded(tree: Path) -> Path:
    """Copy the core, and add a line above each kernel and change the docstrings."""
    for path in (copied_core(tree) / "granchain_core" / "kernels").rglob("*.py"):
        path.write_text("# A line more.\n" + path.read_text(encoding="utf-8").replace('"""', '"""Well: ', 1)
                        .replace("@kernel", "# Another.\n@kernel"), encoding="utf-8")
    return tree


def test_reworded_comments_compile_nothing_and_another_constant_does(compiled: tuple[Path, Path], tmp_path: Path) -> None:
    tree, cache = reworded(tmp_path / "one"), shutil.copytree(compiled[1], tmp_path / "cache")
    for _ in ("parsed", "known by its bytes"):
        hits, misses = hits_and_misses(cache, tree, PLACE)
        assert hits >= 1
        assert misses == 0
    assert len(list(cache.iterdir())) == 1
    tableau = tree / "granchain_core" / "kernels" / "rk4" / "step.py"
    tableau.write_text(tableau.read_text(encoding="utf-8").replace("0.5", "0.25"), encoding="utf-8")
    assert hits_and_misses(cache, tree, PLACE)[1] >= 1


def test_the_kernels_of_whole_runs_are_loaded_from_disk_too(tmp_path: Path) -> None:
    """This process compiles them first, unless they are in the cache already. Kernels that Numba could not keep on disk
    would be compiled again in the second process.
    """
    for method in ("rk4", "dop853"):
        engine = Engine(scene("sec2").evolve(f=2000.0), MethodSetting(method, tolerance=1e-3), 2)
        engine.periods(1)
        engine.record(2)
    hits, misses = hits_and_misses(None, touched(tmp_path / "one"), METHODS)
    assert hits >= 3  # run_steps, run_error_controlled, evaluate_at_phase
    assert misses == 0
