"""Kill one command repeatedly."""

from __future__ import annotations

import random
import shutil
import signal
import subprocess
import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from .finished import differing, finished_in
from .processes import HANGS, Command

#: The commands; each takes a few seconds with compiled kernels.
COMMANDS = {
    "run": ("run", "sec2", "--periods", "3000", "--record", "5", "--samples", "16"),
    "curve": ("curve", "sec2", "--from", "300", "--to", "1500", "--points", "50", "--start", "up"),
    "branch": ("branch", "sec2", "--set", "f=1550", "--knob", "f", "--from", "400", "--to", "2200", "--period", "1", "--both"),
    "map": ("map", "sec2", "--x", "f=300:1500:12", "--y", "A0=2e-7:4e-6:12:log"),
}
_STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGKILL: -signal.SIGKILL}
#: Time in which a signalled command has to end [s].
_PROMISED = 3.0


@dataclass
class Counts:
    """Counts of kills, faults, kept points and completed results."""

    kills: Counter[signal.Signals] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    kept: int = 0
    completed: int = 0
    slowest: float = 0.0

    _FAULTS = ("traceback", "wrong status", "more than 3 s", "hang", "child left", "points lost", "wrong numbers")

    @classmethod
    def header(cls) -> str:
        """Return the head of the table."""
        names = ("command", "SIGINT", "SIGTERM", "SIGKILL", "results completed", "points kept", "slowest end", *cls._FAULTS)
        return f"| {' | '.join(names)} |\n|{'---|' * len(names)}"

    def row(self, name: str) -> str:
        """Return a row of the table."""
        kills = [self.kills[number] for number in _STATUS]
        cells = (name, *kills, self.completed, self.kept, f"{self.slowest:.2f} s", *(self.faults[f] for f in self._FAULTS))
        return f"| {' | '.join(map(str, cells))} |"

    def fault(self, kind: str, about: str) -> None:
        """Count a fault and print it."""
        self.faults[kind] += 1
        print(f"{kind}: {about}", flush=True)


def trial(name: str, count: int, rng: random.Random, folder: Path, minutes: float) -> Counts:
    """Kill a command `count` times, or for at most `minutes`; everything it writes is in `folder`."""
    counts, until = Counts(), time.monotonic() + 60.0 * minutes
    whole, takes = folder / "whole.h5", 0.0
    for _ in range(2):  # the first may compile
        began = time.monotonic()
        undisturbed = Command(*COMMANDS[name], "--out", str(whole))
        if undisturbed.end(timeout=600.0) != 0:
            raise RuntimeError(f"{name} fails without being disturbed: {undisturbed.err}")
        takes = time.monotonic() - began
    out = folder / "out.h5"
    there = finished_in(name, out)
    while sum(counts.kills.values()) < count and time.monotonic() < until:
        command = Command(*COMMANDS[name], "--out", str(out), "--resume")
        with suppress(subprocess.TimeoutExpired):
            command.process.wait(rng.uniform(0.0, takes))
        number = rng.choice(list(_STATUS))
        _kill(command, number, rng, counts)
        now = finished_in(name, out)
        if there - now:
            counts.fault("points lost", f"{len(there - now)} of {len(there)}")
        counts.kept += len(now - there)
        there = now
        if command.process.returncode == 0:
            counts.completed += 1
            if wrong := differing(whole, out):
                counts.fault("wrong numbers", wrong)
            _remove(out)
            there = set()
    return counts


def _kill(command: Command, number: signal.Signals, rng: random.Random, counts: Counts) -> None:
    """Send the signal and check how the process ends; a process that has already ended does not count as killed."""
    began = time.monotonic()
    alive = command.process.poll() is None
    if alive:
        command.send(number, to_all=number is signal.SIGINT and rng.random() < 0.5)
        counts.kills[number] += 1
    status = command.end()
    took = time.monotonic() - began
    said = f"{number.name}, status {status}, {took:.1f} s: {command.err[-600:]!r}"
    if status is None:
        counts.fault("hang", f"more than {HANGS:g} s, {said}")
    elif status not in (0, _STATUS[number]):
        counts.fault("wrong status", said)
    if alive and number is not signal.SIGKILL:
        counts.slowest = max(counts.slowest, took)
        if took > _PROMISED:
            counts.fault("more than 3 s", said)
    if "Traceback" in command.err or "Exception ignored" in command.err:
        counts.fault("traceback", said)
    if command.left():
        counts.fault("child left", said)
        command.kill()


def _remove(out: Path) -> None:
    out.unlink(missing_ok=True)
    shutil.rmtree(f"{out}.blocks", ignore_errors=True)
