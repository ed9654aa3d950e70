"""The operating system's figures for this process, under the names that clients of Prometheus share."""

from __future__ import annotations

import os
import resource
import sys
import threading
import time
from pathlib import Path

#: The folders in which Linux describes this process and the machine; other systems have no such folders.
_PROCESS, _MACHINE = Path("/proc/self"), Path("/proc")
#: The folder of the open descriptors on systems without /proc, such as macOS.
_DESCRIPTORS = Path("/dev/fd")
#: Field of /proc/self/stat, counted from the one after the name, with the start of the process in clock ticks.
_START_FIELD = 19
#: The start time if the system does not report it: this module is imported within the first seconds [s].
_IMPORTED_AT = time.time()


def resident_memory() -> float:
    """Return the resident memory [bytes]; on a system that does not report it, the largest since the start."""
    try:
        return float((_PROCESS / "statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return float(most if sys.platform == "darwin" else 1024 * most)


def os_threads() -> float:
    """Return the number of operating-system threads; on a system that does not count them, of Python's threads."""
    try:
        status = (_PROCESS / "status").read_text()
    except OSError:
        return float(threading.active_count())
    return float(status.partition("\nThreads:")[2].split()[0])


def cpu_seconds() -> float:
    """Return the processor time of all threads since the start, user and system [s]."""
    return time.process_time()


def start_time() -> float:
    """Return when the process started, in seconds since 1970."""
    try:
        ticks = float((_PROCESS / "stat").read_text().rpartition(")")[2].split()[_START_FIELD])
        booted = float((_MACHINE / "stat").read_text().partition("\nbtime ")[2].split()[0])
    except OSError:
        return _IMPORTED_AT
    return booted + ticks / os.sysconf("SC_CLK_TCK")


def open_descriptors() -> float:
    """Return the number of open file descriptors, sockets included; NaN on a system that does not list them."""
    for folder in (_PROCESS / "fd", _DESCRIPTORS):
        try:
            return float(len(os.listdir(folder)) - 1)  # one of them belongs to the listing itself
        except OSError:
            continue
    return float("nan")


def most_descriptors() -> float:
    """Return the largest number of open file descriptors that the system allows."""
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return float("inf") if most == resource.RLIM_INFINITY else float(most)
