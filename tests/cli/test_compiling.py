"""Who waits for the compiler at a terminal is told so, once; a script's stderr has nothing of it."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from pathlib import Path

from app.cli.compiling import WORDS

#: Compiles two functions, as a first run does.
PROGRAM = """
from numba import njit
from app.cli.common import in_background
def work(stop):
    njit(lambda x: x + 1)(1)
    njit(lambda x: x + 2)(1)
    return 3
print(in_background(work))
"""
ROOT = Path(__file__).resolve().parents[2]


def at_a_terminal() -> str:
    """What a person sees of stderr."""
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


def test_a_person_at_a_terminal_is_told_once() -> None:
    assert at_a_terminal().split("\r\n") == [WORDS, ""]


def test_a_script_reads_nothing_of_it() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], cwd=ROOT, capture_output=True, text=True, timeout=120, check=True)
    assert (done.stdout.strip(), done.stderr) == ("3", "")
