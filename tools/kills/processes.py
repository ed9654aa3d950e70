"""A command in a process of its own whose descendants can be found, wherever they have moved to. Linux only."""

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
#: A command that has not ended after this time hangs [s].
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
        """Whether its entry has taken signals over: Python itself does not catch SIGTERM."""
        try:
            status = Path(f"/proc/{self.process.pid}/status").read_text()
        except OSError:
            return False
        return bool(int(status.split("SigCgt:")[1].split()[0], 16) >> signal.SIGTERM - 1 & 1)

    def end(self, timeout: float = HANGS) -> int | None:
        """The exit status, None if the process has not ended by then; it is killed."""
        try:
            self.out, self.err = self.process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            self.kill()
            return None
        return self.process.returncode

    def left(self, within: float = 3.0) -> list[int]:
        """Processes it started that are still there, after at most `within` seconds."""
        until = time.monotonic() + within
        while (found := self.descendants()) and time.monotonic() < until:
            time.sleep(0.02)
        return found

    def descendants(self) -> list[int]:
        """All processes with its mark but itself."""
        mark = f"{_MARK}={self.mark}".encode()
        found = []
        for folder in Path("/proc").iterdir():
            if folder.name.isdigit() and int(folder.name) != self.process.pid:
                try:
                    if mark in (folder / "environ").read_bytes().split(b"\0"):
                        found.append(int(folder.name))
                except OSError:  # it has just ended, or is another user's
                    continue
        return found

    def processor_time(self) -> float:
        """What it and its descendants have used so far [s], without those that have ended and not been waited for."""
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
    """A shell's background jobs ignore interrupts, and their children inherit that."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
