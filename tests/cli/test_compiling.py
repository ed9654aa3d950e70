"""A user at a terminal is told once that kernels are compiled, and sees the seconds; a script's stderr has neither."""

from __future__ import annotations

import importlib
import io
import multiprocessing
import os
import pty
import subprocess
import sys
import threading
from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest

from app.cli import main
from app.cli.common import in_background
from app.cli.compiling import WORDS, compiling_beside
from granchain_core import scene
from granchain_core.precompile import warm
from granchain_core.precompile.pieces import FIXED_STEP_KERNELS

#: Compiles two functions, like a first run.
PROGRAM = """
from numba import njit
from app.cli import main
from app.cli.common import in_background
def work(stop):
    njit(lambda x: x + 1)(1)
    njit(lambda x: x + 2)(1)
    return 3
print(in_background(work))
"""
ROOT = Path(__file__).resolve().parents[2]


def at_a_terminal() -> str:
    """Run the program and return what a user sees of its stderr."""
    mine, theirs = pty.openpty()
    done = subprocess.run([sys.executable, "-c", PROGRAM], cwd=ROOT, stderr=theirs, stdout=subprocess.PIPE, text=True,
                          timeout=120, check=True)
    os.close(theirs)
    assert done.stdout.strip() == "3"
    try:
        return os.read(mine, 10_000).decode()
    except OSError:  # nothing was written
        return ""
    finally:
        os.close(mine)


def test_compiling_is_announced_once_at_a_terminal() -> None:
    assert at_a_terminal().count(WORDS) == 1


def test_compiling_is_not_announced_to_a_script() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, timeout=120, check=True)
    assert (done.stdout.strip(), done.stderr) == ("3", "")


class Terminal(io.StringIO):
    """A terminal that sets an event when it shows seconds."""

    def __init__(self) -> None:
        super().__init__()
        self.counted = threading.Event()

    def isatty(self) -> bool:
        return True

    def write(self, text: str) -> int:
        if text.endswith(" s"):
            self.counted.set()
        return super().write(text)


def test_seconds_are_counted_where_the_work_reports_nothing_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    assert in_background(lambda stop: terminal.counted.wait(60.0))
    assert terminal.getvalue().startswith("\r  1 s") and terminal.getvalue().endswith("\r      \r")
    shown = terminal.getvalue()
    assert in_background(lambda stop: "soon") == "soon"  # within the first second
    assert terminal.getvalue() == shown


def compilers() -> list[BaseProcess]:
    """Return the processes that compile for this one."""
    return [one for one in multiprocessing.active_children() if one.name == "compiler"]


def test_a_second_process_compiles_only_where_numba_does_and_ends_with_the_block(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.cli.compiling.usable_cores", lambda: 2)
    event = importlib.import_module("numba.core.event")
    with compiling_beside(scene("sec2"), FIXED_STEP_KERNELS):
        assert compilers() == [], "nothing has been compiled yet"
        with event.trigger_event("numba:compile"), event.trigger_event("numba:compile"):
            (process,) = compilers()  # only one, however much is compiled
    process.join(60)
    assert not process.is_alive()
    with event.trigger_event("numba:compile"):
        assert compilers() == [], "the block has ended"


def test_a_second_process_that_cannot_compile_is_silent() -> None:
    """The tangent flow refuses a chain with a tension cut; the command reports this, and the second process is silent.
    """
    done = subprocess.run([sys.executable, "-c", f"""
import os
from app.cli.compiling import _compile
from granchain_core import scene
from granchain_core.precompile import warm
from granchain_core.precompile.pieces import ORBIT_KERNELS
_compile({os.getpid()}, scene("sec2").evolve(tension="cut"), (ORBIT_KERNELS,))
"""], cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (1, "", "")


def test_with_one_core_nothing_compiles_beside(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.cli.compiling.usable_cores", lambda: 1)
    event = importlib.import_module("numba.core.event")
    with compiling_beside(scene("sec2"), FIXED_STEP_KERNELS), event.trigger_event("numba:compile"):
        assert compilers() == []


def test_warm_lists_the_compiled_pieces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(warm, "CACHE_FOLDER", tmp_path)
    warm._marker(tmp_path, warm.structure(scene("sec2")), FIXED_STEP_KERNELS).touch()
    (tmp_path / "a.nbc").write_bytes(b"12")
    assert main(["warm", "--list", "sec2"]) == 0
    kernels, cache = capsys.readouterr().out.splitlines()
    assert kernels.startswith(f"{warm.structure(scene('sec2'))}: {FIXED_STEP_KERNELS} compiled; regime, ")
    assert cache == f"1 specializations of kernels, 0 MB, in {tmp_path}"
