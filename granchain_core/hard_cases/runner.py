"""Execution of the table in two processes, the longest cases first."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, as_completed
from concurrent.futures.process import BrokenProcessPool

from ..errors import ComputationError
from ..execution.child_processes import pool, starting
from ..execution.cores import usable_cores
from .case import Check, run_case
from .table import CASES


def _run(name: str, quick: bool) -> list[Check]:
    return run_case(next(case for case in CASES if case.name == name), quick)


def run_cases(quick: bool, workers: int | None = None) -> Iterator[tuple[str, list[Check]]]:
    """Yield case names with their rows as they finish; closing the generator cancels cases that have not started.

    Processes are used because much of the oracles is Python code, which only one thread at a time can run. Raises
    `ComputationError` if a process is ended from outside.
    """
    count = workers or min(2, usable_cores())
    processes = pool(count)
    try:
        with starting():
            running: dict[Future[list[Check]], str] = {processes.submit(_run, case.name, quick): case.name
                                                       for case in CASES}
        for done in as_completed(running):
            yield running[done], done.result()
    except BrokenProcessPool:
        raise ComputationError("A process that ran hard cases was ended from outside, perhaps for its memory; run the "
                               "check again.", "worker-failed") from None
    finally:
        processes.shutdown(wait=False, cancel_futures=True)


def in_order(rows: dict[str, list[Check]]) -> list[Check]:
    """Return all rows in the order of the table."""
    return [row for case in CASES for row in rows.get(case.name, ())]
