"""Run hard cases in a separate process: their oracles are plain Python, which would block the server."""

from __future__ import annotations

import os
from collections.abc import Iterator
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess

from granchain_core import Cancelled
from granchain_core.execution.child_processes import end_with_parent, starting
from granchain_core.execution.stop import Stop
from granchain_core.hard_cases import CASES, Case, Check, Picture, run_case

#: Interval between checks of the stop flag while the process of a case is working [s].
_STOP_CHECK_INTERVAL = 0.05


#: Niceness of the process: the page's pictures come first when cores are scarce.
_NICENESS = 5


class Ended(Exception):
    """The process ended without an answer, through a fault of its own or from outside."""


def case_of(name: object) -> Case | None:
    """Return the case of this name; None if there is none."""
    return next((case for case in CASES if case.name == name), None)


def serve_cases(connection: Connection) -> None:
    """Run in the process: answer each name with the rows of the quick form, then with the picture or None."""
    end_with_parent(os.getppid())
    if hasattr(os, "nice"):
        os.nice(_NICENESS)
    while True:
        name = connection.recv()
        case = case_of(name)
        if case is None:
            raise LookupError(name)
        connection.send(run_case(case, quick=True))
        connection.send(None if case.picture is None else case.picture())


class CaseProcess:
    """A process, started for the first case; `close` may be called at any time, from any thread."""

    def __init__(self) -> None:
        self._process: BaseProcess | None = None
        self._connection: Connection | None = None

    def measure(self, case: Case, stop: Stop) -> Iterator[list[Check] | Picture | None]:
        """Yield the rows, then the picture or None. Raise `Cancelled` if stopped, `Ended` if the process has ended."""
        if stop:
            raise Cancelled
        connection = self._connection or self._begin()
        try:
            connection.send(case.name)
            for _ in range(2):
                while not connection.poll(_STOP_CHECK_INTERVAL):
                    if stop:
                        raise Cancelled
                yield connection.recv()
        except (EOFError, OSError) as gone:
            self.close()
            self._connection = None
            raise (Cancelled() if stop else Ended()) from gone
        finally:
            if stop:
                self.close()

    def close(self) -> None:
        """End the process, whatever it is doing."""
        if self._process is not None:
            self._process.kill()

    def _begin(self) -> Connection:
        context = get_context("spawn")
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=serve_cases, args=(theirs,), name="hard cases", daemon=True)
        with starting():
            self._process.start()
        theirs.close()  # so that the process has the only copy of its end, and recv() here fails when it dies
        return self._connection
