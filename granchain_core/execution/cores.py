"""The number of processors that this process may use."""

from __future__ import annotations

import math
import os
from pathlib import Path

#: File with the processor time that a container may use per period, and that period, both in microseconds (cgroup v2).
_QUOTA = Path("/sys/fs/cgroup/cpu.max")


def usable_cores() -> int:
    """Return how many processors this process may use: those of its affinity, up to its container's quota, rounded up.

    At least 1.
    """
    affinity = getattr(os, "sched_getaffinity", None)
    count = len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    return max(1, min(count, _quota() or count))


def _quota() -> int | None:
    """Return the number of processors that the container's quota allows; None without a quota."""
    try:
        most, period = _QUOTA.read_text(encoding="ascii").split()
        return None if most == "max" else math.ceil(int(most) / int(period))
    except (OSError, ValueError, ZeroDivisionError):
        return None
