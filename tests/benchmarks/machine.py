"""The machine: processor and versions, pinning to one core, and timings that are robust against other work."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import statistics
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

#: Load up to which the machine counts as idle.
IDLE_LOAD = 0.5
#: The cores that this process was allowed to use when it was first pinned.
_allowed: set[int] = set()
PACKAGES = ("numpy", "numba", "scipy", "numbalsoda", "CyRK", "heyoka", "jax", "diffrax")


@dataclass(frozen=True)
class Timed:
    """Times of repeated runs: median [s], shortest [s], and their number."""

    median: float
    least: float
    repeats: int


def timed(work: Callable[[], Any], seconds: float = 0.3, most: int = 15) -> Timed:
    """Time `work` repeatedly for at least `seconds`, and three times unless this would take three times as long."""
    times: list[float] = []
    while len(times) < most and (sum(times) < seconds or len(times) < 3) and sum(times) < 3.0 * seconds:
        began = time.perf_counter()
        work()
        times.append(time.perf_counter() - began)
    return Timed(statistics.median(times), min(times), len(times))


def pin(core: int | None = None) -> int | None:
    """Pin this process to one core, by default the last one, and return it; None if the system cannot do this."""
    if not hasattr(os, "sched_setaffinity"):
        return None
    _allowed.update(os.sched_getaffinity(0) if not _allowed else ())
    core = max(os.sched_getaffinity(0)) if core is None else core
    os.sched_setaffinity(0, {core})
    return core


def unpin() -> int:
    """Undo the pinning and return the number of cores that the process may use."""
    if _allowed:
        os.sched_setaffinity(0, _allowed)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def processor() -> str:
    """Return the processor's name."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def has_flag(flag: str) -> bool:
    """Return whether the processor reports this instruction set."""
    try:
        return f" {flag} " in Path("/proc/cpuinfo").read_text().replace("\n", " ")
    except OSError:
        return False


def versions() -> dict[str, str]:
    """Return the versions of everything that is timed; missing packages are "absent"."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            found[package] = "absent"
    try:
        answer = subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=True)
        found["gcc"] = answer.stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        found["gcc"] = "absent"
    return found


def commit() -> str:
    """Return the commit that is measured, with a plus if the tree differs from it."""
    try:
        answer = subprocess.run(["git", "describe", "--always", "--dirty=+"], capture_output=True, text=True, check=True,
                                cwd=Path(__file__).parent)
        return answer.stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "of an unknown commit"


def peak_megabytes() -> float:
    """Return this process's largest resident memory so far [MB]; `ru_maxrss` would be inherited from the parent."""
    try:
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024
    except OSError:
        pass
    return float("nan")


def load() -> str:
    """Return the load; times measured next to other work are upper bounds, and the text says so."""
    if not hasattr(os, "getloadavg"):
        return "unknown"
    average = os.getloadavg()[0]
    return f"{average:.1f}" + (" (!: beside other work, times are upper bounds)" if average > IDLE_LOAD else "")
