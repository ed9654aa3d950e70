"""A command in a process of its own whose descendants can be found even in other process groups. Linux only."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import uuid
from contextlib import suppress
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Every process that a command starts inherits this variable.
_MARK = "GRANCHAIN_STARTED_BY"
#: Time after which a command that has not ended counts as hung [s].
HANGS = 20.0


class Command:
    """`granchain WORDS` in a session of its own, as from a terminal."""

    def __init__(self, *words: str, program: tuple[str, ...] = ("-m", "app.cli"), folder: Path | None = None,
                 **environment: str) -> None:
        self.mark = uuid.uuid4().hex
        surroundings = {**os.environ, "PYTHONPATH": str(ROOT), _MARK: self.mark, **environment}
        self.process = subprocess.Popen(
            [sys.executable, *program, *words], cwd=ROOT if folder is None else folder, env=surroundings, text=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
            preexec_fn=_hear_interrupts)
        self.out = self.err = ""

    def send(self, number: signal.Signals, to_all: bool = False) -> None:
        """Send a signal to the process or, as a terminal does, to its whole group."""
        if to_all:
            os.killpg(self.process.pid, number)
        else:
            self.process.send_signal(number)

    def listening(self) -> bool:
        """Return whether its entry has taken over the signals; Python itself does not catch SIGTERM."""
        try:
            status = Path(f"/proc/{self.process.pid}/status").read_text()
        except OSError:
            return False
        return bool(int(status.split("SigCgt:")[1].split()[0], 16) >> signal.SIGTERM - 1 & 1)

    def end(self, timeout: float = HANGS) -> int | None:
        """Wait for the exit status; if the process has not ended by then, kill it and return None."""
        try:
            self.out, self.err = self.process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            self.kill()
            return None
        return self.process.returncode

    def left(self, within: float = 3.0) -> list[int]:
        """Return the processes it started that still exist after `within` seconds; wait no longer than needed."""
        until = time.monotonic() + within
        while (found := self.descendants()) and time.monotonic() < until:
            time.sleep(0.02)
        return found

    def descendants(self) -> list[int]:
        """Return all processes with its mark except itself."""
        mark = f"{_MARK}={self.mark}".encode()
        found = []
        for folder in Path("/proc").iterdir():
            if folder.name.isdigit() and int(folder.name) != self.process.pid:
                try:
                    if mark in (folder / "environ").read_bytes().split(b"\0"):
                        found.append(int(folder.name))
                except OSError:  # the process has just ended, or is another user's
                    continue
        return found

    def processor_time(self) -> float:
        """Return the processor time of it and its descendants so far [s], without ended ones not waited for."""
        used = 0
        for pid in [self.process.pid, *self.descendants()]:
            with suppress(OSError):  # it has just ended
                used += sum(map(int, Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:15]))
        return used / os.sysconf("SC_CLK_TCK")

    def kill(self) -> None:
        """End it and everything it started."""
        for pid in [self.process.pid, *self.descendants()]:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                continue
        self.out, self.err = self.process.communicate()


def _hear_interrupts() -> None:
    """Restore the handling of interrupts, which a shell's background jobs and therefore their children ignore."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
