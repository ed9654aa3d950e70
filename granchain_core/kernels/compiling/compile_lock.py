"""A lock with which one process compiles a kernel while others that need it wait and then load it.

Without it, the workers of a map or of the tests, and the processes of a server, would each compile the same kernel, at
ten seconds of processor time apiece. The lock is on a file next to the kernel's own. The operating system releases it
when its process ends, however it ends. Where file locks are not available (other systems, some network disks), every
process compiles.
"""

from __future__ import annotations

import contextlib
import os
import time
from pathlib import Path

from .cache_folder import FILE_RIGHTS, FOLDER_RIGHTS

try:
    import fcntl
except ImportError:  # not a POSIX system
    fcntl = None  # type: ignore[assignment]

#: Longest wait for another process [s]: a kernel takes ten seconds to compile, fifty on a busy machine. A process that
#: is stuck must not hold up the others any longer.
PATIENCE = 120.0
#: Seconds between two attempts.
_INTERVAL = 0.05


class CompileLock:
    """The right to compile one kernel, whose compiled code is stored at `path`."""

    def __init__(self, path: Path) -> None:
        self._path = path.with_suffix(".lock")
        self._file: int | None = None

    @property
    def held(self) -> bool:
        """Whether this process has the lock."""
        return self._file is not None

    def acquire(self, patience: float = PATIENCE) -> None:
        """Wait for the lock, for `patience` [s] at most.

        The caller must then look for the kernel again, whether or not it got the lock: another process may have
        compiled it in the meantime. That can happen even without a wait, between the caller's last look and this call.
        """
        if fcntl is None or self.held:
            return
        ends = time.monotonic() + patience
        try:
            self._path.parent.mkdir(mode=FOLDER_RIGHTS, parents=True, exist_ok=True)
            file = os.open(self._path, os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, FILE_RIGHTS)
        except OSError:
            return
        try:
            while time.monotonic() <= ends:
                try:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                except BlockingIOError:
                    time.sleep(_INTERVAL)
                else:
                    self._file = file
                    return
        except OSError:  # no file locks available
            pass
        finally:
            if not self.held:
                os.close(file)

    def release(self) -> None:
        """Release the lock; call this after the kernel has been written.

        Waiting processes have the same file open, so they do not need its name to continue and look for the kernel. A
        process that comes later makes a new file, so two processes may hold the lock of one kernel. Both then find the
        kernel, which was written earlier; if it could not be written, both compile it.
        """
        if self._file is not None:
            with contextlib.suppress(OSError):
                self._path.unlink(missing_ok=True)
            os.close(self._file)
            self._file = None
