"""One process compiles a kernel and the others load it. No process waits forever, and no lock has to be removed by
hand.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numba
import pytest
from numba.core.errors import TypingError

from granchain_core.kernels.compiling import cache, compile_lock
from granchain_core.kernels.compiling.compile_lock import CompileLock

#: Obtains one small kernel and prints how many versions were loaded and how many compiled.
_COMPILE = """
import numpy as np
from granchain_core.kernels.forces.peaks import reset_peaks
reset_peaks(np.zeros(17))
print(len(reset_peaks.stats.cache_hits), len(reset_peaks.stats.cache_misses))
"""


def test_processes_that_want_one_kernel_compile_it_once(tmp_path: Path) -> None:
    started = [subprocess.Popen([sys.executable, "-c", _COMPILE], env={**os.environ, "GRANCHAIN_CACHE": str(tmp_path)},
                                stdout=subprocess.PIPE, text=True) for _ in range(3)]
    told = sorted(one.communicate(timeout=300)[0].strip() for one in started)
    assert told == ["0 1", "1 0", "1 0"]
    assert not list(tmp_path.rglob("*.lock"))


def test_a_waiting_process_gets_the_lock_or_compiles_without_it(tmp_path: Path) -> None:
    first, second, third = (CompileLock(tmp_path / "f.nbc") for _ in range(3))
    first.acquire()
    assert first.held
    waiting = threading.Thread(target=second.acquire)
    waiting.start()
    third.acquire(patience=0.2)  # gives up waiting; it would compile without the lock
    assert not third.held and not second.held
    first.release()
    waiting.join(60.0)
    assert second.held and not first.held
    second.release()


def test_an_interrupted_wait_leaves_no_file_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(_: float) -> None:
        raise KeyboardInterrupt

    first, second = CompileLock(tmp_path / "f.nbc"), CompileLock(tmp_path / "f.nbc")
    first.acquire()
    monkeypatch.setattr(compile_lock.time, "sleep", interrupted)
    before = len(os.listdir("/dev/fd"))
    with pytest.raises(KeyboardInterrupt):
        second.acquire()
    assert len(os.listdir("/dev/fd")) == before and not second.held
    first.release()


@pytest.fixture
def locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], list[CompileLock]]:
    """A cache in an empty folder; returns a function that lists the locks held in it."""
    made: list[CompileLock] = []

    def lock(path: Path) -> CompileLock:
        made.append(CompileLock(path))
        return made[-1]

    monkeypatch.setattr(cache, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(cache, "CompileLock", lock)
    return lambda: [one for one in made if one.held]


def test_a_compilation_that_fails_releases_its_lock(locks: Callable[[], list[CompileLock]]) -> None:
    """The next attempt fails as quickly as the first, since it does not wait for a lock of its own process."""
    @numba.njit
    def unknown(x):
        return x.unknown

    cache.keep_on_disk(unknown)
    for _ in range(2):
        with pytest.raises(TypingError):
            unknown(1.0)
        assert locks() == []


@pytest.mark.parametrize("where", ["compile", "look", "write"])
def test_an_interrupted_compilation_releases_its_lock(where: str, locks: Callable[[], list[CompileLock]],
                                                      monkeypatch: pytest.MonkeyPatch) -> None:
    @numba.njit
    def twice(x):
        return 2 * x

    held = []

    def interrupted(*words: object) -> None:
        held.append(len(locks()))
        if where != "look" or held[-1]:  # the second lookup, with the lock held
            raise KeyboardInterrupt

    cache.keep_on_disk(twice)
    owner, name = {"compile": (twice._compiler, "compile"), "look": (twice._cache, "_load"),
                   "write": (cache._Files, "save")}[where]
    monkeypatch.setattr(owner, name, interrupted)
    with pytest.raises(KeyboardInterrupt):
        twice(1.0)
    assert held[-1] == 1 and locks() == []


def test_a_kernel_that_another_process_has_just_compiled_is_not_compiled_again(
        locks: Callable[[], list[CompileLock]], monkeypatch: pytest.MonkeyPatch) -> None:
    """The other process finishes between the first lookup and the lock, which is then free at once."""
    def twice(x):
        return 2 * x

    mine, others = numba.njit(twice), numba.njit(twice)
    for one in (mine, others):
        cache.keep_on_disk(one)
    real = CompileLock.acquire

    def acquire(lock: CompileLock) -> None:
        monkeypatch.setattr(CompileLock, "acquire", real)
        others(1.0)
        real(lock)

    monkeypatch.setattr(CompileLock, "acquire", acquire)
    assert mine(1.0) == 2.0
    assert sum(mine.stats.cache_hits.values()) == 1 and sum(mine.stats.cache_misses.values()) == 0
    assert locks() == []


def test_a_killed_process_releases_its_lock(tmp_path: Path) -> None:
    held = subprocess.Popen(
        [sys.executable, "-c", "import sys, time; from pathlib import Path\n"
         "from granchain_core.kernels.compiling.compile_lock import CompileLock\n"
         "lock = CompileLock(Path(sys.argv[1])); lock.acquire(); print('held', flush=True); time.sleep(600)", str(tmp_path / "f.nbc")],
        stdout=subprocess.PIPE, text=True)
    assert held.stdout is not None and held.stdout.readline() == "held\n"
    lock = CompileLock(tmp_path / "f.nbc")
    lock.acquire(patience=0.2)
    assert not lock.held
    held.send_signal(signal.SIGKILL)
    held.wait(60.0)
    lock.acquire()
    assert lock.held
    lock.release()


def test_where_there_are_no_locks_everyone_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    lock = CompileLock(tmp_path / "file" / "f.nbc")  # no folder can be created there
    lock.acquire()
    assert not lock.held
    monkeypatch.setattr(compile_lock, "fcntl", None)
    lock = CompileLock(tmp_path / "f.nbc")
    lock.acquire()
    assert not lock.held
    lock.release()
    assert not list(tmp_path.glob("*.lock"))
