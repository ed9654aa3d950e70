"""A page's background work: starting it, cancelling it, and handling its failures."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from granchain_core import BadInput, Cancelled, ComputationError, Scene
from granchain_core.execution.stop import Stop

from ..serve.compiling.compiler import COMPILER
from ..serve.computing.turns import Flag
from ..serve.computing.worker_pools import WorkerPool
from ..serve.monitoring.faults import new_fault_id, with_fault_id
from .host import WorkHost
from .progress import Status

#: Time between the first two checks of whether the main picture is done [s]. Long work waits for the picture, so it
#: never competes with a knob.
_PICTURE_CHECK_INTERVAL = 0.01
#: Longest time between two such checks [s].
_LONGEST_CHECK_INTERVAL = 0.2

#: Called with a status and a sentence, which is empty unless the status is "failed".
Report = Callable[[Status, str], None]


def report_nothing(status: Status, sentence: str) -> None:
    """Show no status, for a task that shows only its result and whose failures the host reports."""


class Job:
    """One run of a task; its work uses the job in a worker thread."""

    def __init__(self, host: WorkHost, report: Report) -> None:
        self.stop: Stop = Flag()
        self._host = host
        self._report = report

    def next_tick(self, action: Callable[..., None], *args: Any, **kwargs: Any) -> None:
        """Call `action` with the document locked, unless the job is cancelled by then."""

        def act() -> None:
            if not self.stop:
                action(*args, **kwargs)

        self._host.next_tick(act)

    def report(self, status: Status) -> None:
        """Report the state of the work."""
        self.next_tick(self._report, status, "")

    def compile(self, scene: Scene, *pieces: str) -> None:
        """Wait until these kernels are compiled and loaded; report "compiling" meanwhile. Raises `Cancelled`."""
        for piece in pieces:
            if not COMPILER.has(scene, piece):
                self.report("compiling")
            if not COMPILER.await_piece(scene, piece, self.stop):
                raise Cancelled
            COMPILER.load(scene, piece)

    def give_way(self, waits: Callable[[], bool] | None = None) -> None:
        """Wait while `waits` returns True; without it, while the picture for a moved knob is being computed.

        The longer the wait, the rarer the checks, since each check takes the GIL from all other threads. The thread
        must poll, because `waits` may depend on anything in the page.
        """
        must_wait, pause = waits or (lambda: self._host.awaiting_picture), _PICTURE_CHECK_INTERVAL
        while must_wait() and not self.stop:
            time.sleep(pause)
            pause = min(2.0 * pause, _LONGEST_CHECK_INTERVAL)

    def progress(self, report: Callable[[float], None], steps: int = 50) -> Callable[[float], None]:
        """Return a function that work calls with the fraction done, from 0 to 1; each call gives way to the picture.

        `report` is called with this fraction and the document locked, at most `steps` times.
        """
        reported = 0

        def done_so_far(done: float) -> None:
            nonlocal reported
            if done < 1.0:
                self.give_way()
            if int(steps * done) > reported:
                reported = int(steps * done)
                self.next_tick(report, done)

        return done_so_far


class Task:
    """One kind of background work of a page; a new start replaces the last. The work ends when the session ends.

    `report` is called with the document locked: with "done", with "failed" and a sentence, or with a status that the
    work reports. `title` begins the sentence about a fault. With `report_to_host`, the dashboard shows errors, because
    the page has no place for them. When a knob moves, a page cancels its task or marks the result as out of date;
    `outlives_knobs` says why this task needs neither.
    """

    def __init__(self, host: WorkHost, pool: WorkerPool, report: Report, title: str = "The computation",
                 report_to_host: bool = False, outlives_knobs: str = "") -> None:
        self.outlives_knobs = outlives_knobs
        self._host = host
        self._pool = pool
        self._report = report
        self._title = title
        self._report_to_host = report_to_host
        self._job: Job | None = None
        self._queued: Future[None] | None = None
        host.on_close(self.cancel)

    @property
    def running(self) -> bool:
        """Whether the work is under way or waiting for its turn."""
        return self._job is not None

    def start(self, work: Callable[[Job], None]) -> None:
        """Queue `work`, replacing any work that was started before."""
        self.cancel()
        self._job = job = Job(self._host, self._report)
        try:
            self._queued = self._pool.submit(self._run, work, job, owner=self._host)
        except Exception as error:  # the system allows no more threads
            self._report_fault(job, error)

    def cancel(self) -> bool:
        """Cancel the work under way; return whether there was any. No further result of the work arrives.

        Work that has not begun is dropped with its arguments.
        """
        job, self._job = self._job, None
        queued, self._queued = self._queued, None
        if job is not None:
            job.stop.set()
        if queued is not None:
            queued.cancel()
        return job is not None

    def _run(self, work: Callable[[Job], None], job: Job) -> None:
        """Do the work in a thread of the pool."""
        if job.stop:
            return
        try:
            work(job)
        except Cancelled:
            return
        except BadInput as problem:
            job.next_tick(self._end, "failed", str(problem), problem)
        except ComputationError as problem:
            self._report_failed_computation(job, problem)
        except Exception as error:
            self._report_fault(job, error)
        else:
            job.next_tick(self._end, "done")

    def _report_failed_computation(self, job: Job, problem: ComputationError) -> None:
        """Report a computation that could not be finished; page and log have the same id."""
        if self._report_to_host:
            job.next_tick(self._end, "failed", str(problem), problem)
            return
        fault = new_fault_id()
        job.next_tick(self._end, "failed", with_fault_id(str(problem), fault))
        job.next_tick(self._host.log_failed_computation, problem, fault)

    def _report_fault(self, job: Job, error: Exception) -> None:
        """Report an error of granchain itself, from any thread; page and log have the same id."""
        fault = new_fault_id()
        sentence = f"{self._title} failed because of an error in granchain ({type(error).__name__}); please report it."
        job.next_tick(self._end, "failed", with_fault_id(sentence, fault))
        self._host.next_tick(self._host.report_fault, error, sentence if self._report_to_host else "", fault)

    def _end(self, status: Status, sentence: str = "", problem: Exception | None = None) -> None:
        self._job = None
        self._report(status, sentence)
        if problem is not None and self._report_to_host:
            self._host.show_failure(problem)
