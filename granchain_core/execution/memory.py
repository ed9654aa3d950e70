"""The memory that this process may use."""

from __future__ import annotations

import os
from pathlib import Path

#: File with the bytes of memory that a container may use (cgroup v2), or "max".
_LIMIT = Path("/sys/fs/cgroup/memory.max")


def usable_memory() -> int | None:
    """Return the bytes of this machine's memory, or those of its container's limit if smaller; None if unknown."""
    known = [size for size in (_physical(), _limit()) if size is not None]
    return min(known, default=None)


def _physical() -> int | None:
    """Return the bytes of the machine's memory; None where the system does not say."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None


def _limit() -> int | None:
    """Return the bytes that the container may use; None without a limit."""
    try:
        return int(_LIMIT.read_text(encoding="ascii"))
    except (OSError, ValueError):
        return None
