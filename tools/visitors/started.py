"""A dashboard started for the tool, or one that is already running."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class Started:
    """A server that `with Started(None, log) as server:` starts and ends; `address` names a running one instead."""

    def __init__(self, address: str | None, log: Path) -> None:
        self._log = log
        self.process: subprocess.Popen[bytes] | None = None
        self.address = address or f"http://127.0.0.1:{_free_port()}"
        self._ours = address is None

    def __enter__(self) -> Started:
        if self._ours:
            self._start()
        end = time.monotonic() + 60
        while True:
            try:
                with urllib.request.urlopen(f"{self.address}/liveness", timeout=5):
                    return self
            except OSError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.2)

    def _start(self) -> None:
        with self._log.open("ab") as output:
            self.process = subprocess.Popen([sys.executable, "-m", "app.cli", "serve", "--port", self.address.rpartition(":")[2]],
                                            cwd=ROOT, stdout=output, stderr=output)

    def restart(self) -> None:
        """End the process and start another at the same address; only for a server started here."""
        assert self.process is not None, "a restart needs a server that this tool starts"
        self.process.terminate()
        self.process.wait(timeout=30)
        self._start()

    def __exit__(self, *_: object) -> None:
        if self.process is not None:
            self.process.terminate()
            self.process.wait(timeout=30)
            tracebacks = [line for line in self._log.read_text(errors="replace").splitlines() if "Traceback" in line]
            print(f"tracebacks in the server's log: {len(tracebacks)}", *tracebacks[:10], sep="\n")

    @property
    def number(self) -> int:
        """Id of the process, whose figures are read; only for a server started here."""
        assert self.process is not None, "figures of a process need a server that this tool starts"
        return self.process.pid

    @property
    def processor_time(self) -> float:
        """Processor time used so far [s]."""
        fields = Path(f"/proc/{self.number}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    @property
    def loop_time(self) -> float:
        """Processor time used so far by the thread with the event loop [s], on Linux."""
        words = Path(f"/proc/{self.number}/task/{self.number}/schedstat").read_text().split()
        return int(words[0]) / 1e9


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
