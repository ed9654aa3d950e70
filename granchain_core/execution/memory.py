"""The memory that this process may use."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

#: The control groups of the system (cgroup v2), and the file that names this process's own group.
_GROUPS, _OWN_GROUP = Path("/sys/fs/cgroup"), Path("/proc/self/cgroup")


def usable_memory() -> int | None:
    """Return the bytes of this machine's memory, or a smaller limit of a container or service; None if unknown."""
    return min((*_physical(), *_limits()), default=None)


def _physical() -> Iterator[int]:
    """Yield the bytes of the machine's memory, unless the system does not say."""
    try:
        yield os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return


def _limits() -> Iterator[int]:
    """Yield the limits of the outermost group, which a container has, and of the process's own, which a service has."""
    for group in (_GROUPS, _GROUPS / _own_group()):
        try:
            yield int((group / "memory.max").read_text(encoding="ascii"))
        except (OSError, ValueError):  # no such file, or "max"
            continue


def _own_group() -> str:
    """Return the path of the process's group below `_GROUPS`, or "" if it is unknown."""
    try:
        return _OWN_GROUP.read_text(encoding="utf-8").rpartition("::/")[2].strip()
    except OSError:
        return ""
