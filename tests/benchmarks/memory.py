"""Benchmark of memory: the largest resident set of whole commands. For the dashboard, `tools.visitors` prints it."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from .tables import table

_ROOT = Path(__file__).resolve().parents[2]
#: The commands: their text in the table, and their arguments; `{}` stands for an output file.
COMMANDS = (
    ("granchain scenes", "scenes"),
    ("granchain run sec2", "run sec2"),
    ("granchain run, N = 10,000, 4 periods", "run sec2 --set N=10000 --periods 2 --record 2 --out {}.h5"),
    ("granchain curve, 298 points", "curve sec2 --from 30 --to 3000 --points 298"),
    ("granchain orbit", "orbit sec2"),
    ("granchain map, 40 × 40", "map sec2 --x f=300:1500:40 --y A0=1e-7:1e-6:40 --out {}.h5"),
)
#: Prints the memory [MB] of the one child process that it runs.
_MEASURE = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024)
"""


def of_command(arguments: str) -> float:
    """Return the largest resident memory [MB] of a command and its children in its second run, with compiled kernels.
    """
    for _ in range(2):
        with tempfile.TemporaryDirectory() as folder:
            words = [word.replace("{}", f"{folder}/result") for word in arguments.split()]
            command = [sys.executable, "-m", "app.cli", *words]
            answer = subprocess.run([sys.executable, "-c", _MEASURE, *command], cwd=_ROOT, capture_output=True,
                                    text=True, check=True)
    return float(answer.stdout.split()[-1])


def report(quick: bool, tell: Callable[[str], None]) -> str:
    """Return the table."""
    rows = []
    for name, arguments in COMMANDS[:2] if quick else COMMANDS:
        tell(name)
        rows.append([name, "", f"{of_command(arguments):.0f}"])
    return table("Memory: largest resident set of a new process", ["command", "", "peak MB"], rows)
