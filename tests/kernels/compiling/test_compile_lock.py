"""One process compiles a kernel and the others load it; nobody waits for ever, and nobody is needed to unlock."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from granchain_core.kernels.compiling import compile_lock
from granchain_core.kernels.compiling.compile_lock import CompileLock

#: Compiles one small kernel and prints from where it came: numbers loaded, and compiled.
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


def test_who_waits_is_told_that_another_was_there(tmp_path: Path) -> None:
    first, second, told = CompileLock(tmp_path / "f.nbc"), CompileLock(tmp_path / "f.nbc"), []
    assert first.acquire() is False
    waiting = threading.Thread(target=lambda: told.append(second.acquire()))
    waiting.start()
    assert CompileLock(tmp_path / "f.nbc").acquire(patience=0.2) is True  # patience ends; it compiles by itself
    assert told == []
    first.release()
    waiting.join(60.0)
    assert told == [True]
    second.release()
    assert CompileLock(tmp_path / "g.nbc").acquire() is False


def test_a_process_that_is_killed_locks_nobody_out(tmp_path: Path) -> None:
    held = subprocess.Popen(
        [sys.executable, "-c", "import sys, time; from pathlib import Path\n"
         "from granchain_core.kernels.compiling.compile_lock import CompileLock\n"
         "lock = CompileLock(Path(sys.argv[1])); lock.acquire(); print('held', flush=True); time.sleep(600)", str(tmp_path / "f.nbc")],
        stdout=subprocess.PIPE, text=True)
    assert held.stdout is not None and held.stdout.readline() == "held\n"
    lock = CompileLock(tmp_path / "f.nbc")
    assert lock.acquire(patience=0.2) is True and lock._file is None
    held.send_signal(signal.SIGKILL)
    held.wait(60.0)
    lock.acquire()
    assert lock._file is not None
    lock.release()


def test_where_there_are_no_locks_everyone_compiles(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    assert CompileLock(tmp_path / "file" / "f.nbc").acquire() is False  # no folder can be made there
    monkeypatch.setattr(compile_lock, "fcntl", None)
    lock = CompileLock(tmp_path / "f.nbc")
    assert lock.acquire() is False
    lock.release()
    assert not list(tmp_path.glob("*.lock"))
