"""The number of processors that this process may use."""

from __future__ import annotations

import math
import os
from pathlib import Path

#: Time that the processes of a container may use in each period, and that period, in microseconds (cgroup v2).
_QUOTA = Path("/sys/fs/cgroup/cpu.max")


def usable_cores() -> int:
    """Processors for this process: those of its affinity, but no more than the quota of its container, rounded up.

    At least 1.
    """
    affinity = getattr(os, "sched_getaffinity", None)
    count = len(affinity(0)) if affinity is not None else os.cpu_count() or 1
    return max(1, min(count, _quota() or count))


def _quota() -> int | None:
    """Processors that the container's quota allows; None where there is no quota."""
    try:
        most, period = _QUOTA.read_text(encoding="ascii").split()
        return None if most == "max" else math.ceil(int(most) / int(period))
    except (OSError, ValueError, ZeroDivisionError):
        return None
