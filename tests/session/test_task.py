"""Background work of a page: results that arrive, results dropped after a cancellation, and reports of failures."""

from __future__ import annotations

import gc
import re
import threading
import time
import weakref
from collections.abc import Callable
from functools import partial
from itertools import count

import pytest
from host import FakeHost

from app.serve.computing.worker_pools import WorkerPool
from app.serve.monitoring.faults import with_fault_id
from app.session.task import Job, Task, report_nothing
from granchain_core import BadInput, Cancelled, ComputationError, scene


class SayingHost(FakeHost):
    """A host that records the messages of a task's page."""

    def __init__(self) -> None:
        super().__init__()
        self.said: list[tuple[str, str]] = []

    def say(self, status: str, sentence: str) -> None:
        """Record a status and a sentence."""
        self.said.append((status, sentence))


@pytest.fixture
def host() -> SayingHost:
    """A host that has received no messages."""
    return SayingHost()


@pytest.fixture
def task(host: SayingHost) -> Task:
    """A task with its own pool."""
    return Task(host, WorkerPool("test", 1), host.say, "The measurement")


#: The sentence about an error in granchain itself.
FAULT = "The measurement failed because of an error in granchain (ZeroDivisionError); please report it."


def failing(error: Exception) -> Callable[[Job], None]:
    """Return work that ends with this error."""
    def work(_: Job) -> None:
        raise error
    return work


def test_messages_of_work_arrive_before_its_end(host: SayingHost, task: Task) -> None:
    task.start(lambda job: job.report("measuring"))
    assert task.running
    host.run_callbacks_until(lambda: not task.running)
    assert host.said == [("measuring", ""), ("done", "")]


def test_a_task_ends_when_the_visitor_leaves(host: SayingHost, task: Task) -> None:
    """No page has to take care of that, and nothing is computed in vain."""
    begun, ended = threading.Event(), threading.Event()

    def work(job: Job) -> None:
        begun.set()
        while not job.stop:
            time.sleep(0.001)
        ended.set()

    task.start(work)
    assert begun.wait(20.0)
    host.leave()
    assert ended.wait(20.0) and not task.running
    host.call_waiting()
    assert host.said == []


@pytest.mark.parametrize(("error", "sentence", "told"), [
    (ComputationError("Bead 3 is not finite.", "not-finite"), "Bead 3 is not finite.", False),
    (BadInput("f must be positive."), "f must be positive.", False),
    (ZeroDivisionError("1/0"), FAULT, True)])
def test_a_failure_is_shown_and_a_fault_is_reported_to_the_host(error: Exception, sentence: str, told: bool, host: SayingHost,
                                                          task: Task) -> None:
    task.start(failing(error))
    host.run_callbacks_until(lambda: not task.running and not host.callbacks)
    ids = host.fault_ids + [fault for _, fault in host.failed_computations]
    assert host.said == [("failed", with_fault_id(sentence, ids[0]) if ids else sentence)]
    assert host.faults == ([(error, "")] if told else []) and host.failures == []
    assert [problem for problem, _ in host.failed_computations] == ([error] if isinstance(error, ComputationError) else [])


def test_a_task_whose_thread_cannot_be_started_fails_and_the_next_one_runs(host: SayingHost, task: Task,
                                                                           monkeypatch: pytest.MonkeyPatch) -> None:
    def start(_: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    with monkeypatch.context() as full:
        full.setattr("app.serve.computing.worker_pools.begin", start)
        task.start(lambda job: None)
    host.run_callbacks_until(lambda: not task.running)
    ((status, sentence),) = host.said
    assert status == "failed" and "(RuntimeError); please report it. (fault" in sentence and len(host.faults) == 1
    task.start(lambda job: None)
    host.run_callbacks_until(lambda: not task.running)
    assert host.said[1:] == [("done", "")]


def test_a_failure_without_a_place_on_the_page_goes_to_the_host(host: SayingHost) -> None:
    problem = BadInput("f must be positive.")
    task = Task(host, WorkerPool("test", 1), host.say, report_to_host=True)
    task.start(failing(problem))
    host.run_callbacks_until(lambda: not task.running)
    assert host.failures == [problem]
    fault = ZeroDivisionError("1/0")
    task = Task(host, WorkerPool("test", 1), report_nothing, "The measurement", report_to_host=True)
    task.start(failing(fault))
    host.run_callbacks_until(lambda: bool(host.faults))
    assert host.faults == [(fault, FAULT)] and host.failures == [problem]
    assert re.fullmatch("[0-9a-f]{12}", host.fault_ids[0])


def test_nothing_of_cancelled_work_arrives(host: SayingHost, task: Task) -> None:
    entered, leave = threading.Event(), threading.Event()

    def work(job: Job) -> None:
        job.report("measuring")
        entered.set()
        assert leave.wait(20)
        assert job.stop
        job.report("computing")

    task.start(work)
    assert entered.wait(20)
    assert task.cancel() and not task.running
    assert not task.cancel(), "there is nothing to cancel any more"
    leave.set()
    task.start(lambda job: None)
    host.run_callbacks_until(lambda: not task.running)
    assert host.said == [("done", "")]


def test_cancelled_work_is_no_failure(host: SayingHost, task: Task) -> None:
    def work(job: Job) -> None:
        while not job.stop:
            time.sleep(0.002)
        raise Cancelled

    task.start(work)
    task.start(lambda job: None)
    host.run_callbacks_until(lambda: not task.running)
    assert host.said == [("done", "")] and host.failures == []


def test_work_that_is_cancelled_before_its_turn_is_not_begun(host: SayingHost) -> None:
    pool, leave = WorkerPool("test", 1), threading.Event()
    pool.submit(leave.wait, 20)
    task = Task(host, pool, host.say)
    task.start(failing(AssertionError("begun")))
    task.cancel()
    leave.set()
    assert pool.submit(lambda: True).result(20)
    host.run_callbacks_until(lambda: not host.callbacks)
    assert host.said == [] and host.failures == []


@pytest.mark.parametrize("limit", [None, 1])
def test_a_task_started_repeatedly_is_kept_once(limit: int | None, host: SayingHost) -> None:
    """If a visitor uploads file after file while all threads are busy, only the last one waits."""
    class File:
        """An uploaded file."""

    pool, leave = WorkerPool("test", 1, per_owner_limit=limit), threading.Event()
    pool.submit(leave.wait, 120)

    def read_file(file: File, _: Job) -> None:
        read.append(type(file).__name__)

    task, files = Task(host, pool, host.say), [File() for _ in range(50)]
    kept, read = weakref.WeakSet(files), list[str]()
    while files:
        one = files.pop()
        task.start(partial(read_file, one))
    del one
    gc.collect()
    assert len(kept) == 1 and pool.queued + pool.held <= (50 if limit is None else 2)
    leave.set()
    host.run_callbacks_until(lambda: not task.running)
    assert read == ["File"] and host.said == [("done", "")]


def test_work_gives_way_to_a_moving_knob(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first three checks find a picture still awaited; at the fourth, it is there."""
    looks = count(1)
    monkeypatch.setattr(SayingHost, "awaiting_picture", property(lambda _: next(looks) < 4))
    host = SayingHost()
    task = Task(host, WorkerPool("test", 1), host.say)
    task.start(lambda job: job.give_way())
    host.run_callbacks_until(lambda: not task.running)
    assert next(looks) == 5 and host.said == [("done", "")]


def test_long_pauses_are_checked_ever_more_rarely(host: SayingHost, monkeypatch: pytest.MonkeyPatch) -> None:
    pauses: list[float] = []
    monkeypatch.setattr("app.session.task.time.sleep", pauses.append)
    Job(host, host.say).give_way(lambda: len(pauses) < 7)
    assert pauses == [0.01, 0.02, 0.04, 0.08, 0.16, 0.2, 0.2]


def test_progress_is_reported_in_steps_and_gives_way_before_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    looks, reported = count(), list[float]()
    monkeypatch.setattr(SayingHost, "awaiting_picture", property(lambda _: next(looks) < 0))
    host = SayingHost()
    progress = Job(host, host.say).progress(reported.append, steps=4)
    for i in range(11):
        progress(i / 10)
    host.run_callbacks_until(lambda: not host.callbacks)
    assert reported == [0.3, 0.5, 0.8, 1.0] and next(looks) == 10


def test_compiling_is_reported_and_ends_with_the_job(host: SayingHost, task: Task, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.session.task.COMPILER.has", lambda *_: False)
    monkeypatch.setattr("app.session.task.COMPILER.await_piece", lambda *_: False)
    monkeypatch.setattr("app.session.task.COMPILER.load", lambda *_: pytest.fail("loaded"))
    task.start(lambda job: job.compile(scene("sec2"), "live"))
    host.run_callbacks_until(lambda: host.said == [("compiling", "")])
    assert host.failures == []


def test_a_queue_limits_its_concurrent_work_and_keeps_the_results() -> None:
    pool, entered, leave = WorkerPool("test", 2), threading.Semaphore(0), threading.Event()

    def work(number: int) -> int:
        entered.release()
        assert leave.wait(20)
        return number

    futures = [pool.submit(work, number) for number in range(3)]
    assert entered.acquire(timeout=20) and entered.acquire(timeout=20)
    assert not entered.acquire(timeout=0.1), "the third waits"
    leave.set()
    assert [future.result(20) for future in futures] == [0, 1, 2]
    with pytest.raises(ZeroDivisionError):
        pool.submit(lambda: 1 // 0).result(20)
