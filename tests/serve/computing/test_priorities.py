"""Long-computing threads give way to the event loop and to computations that have just started."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterator

import pytest
import waiting

from app.serve.computing import priorities
from app.serve.computing.cpu_time import CpuTime
from app.serve.computing.latest_wins import LatestWins
from app.serve.computing.priorities import begin, has_lower_priority, lower_priority
from app.serve.computing.turns import TurnFlag, Turns
from app.serve.computing.worker_pools import WorkerPool

linux = pytest.mark.skipif(sys.platform != "linux", reason="other systems have one niceness for the whole process")


def niceness() -> int:
    return os.getpriority(os.PRIO_PROCESS, threading.get_native_id())


def computes(slot: TurnFlag, seconds: float) -> Iterator[int]:
    """Yield the niceness after this much processor time, which ends with a pause."""
    began = time.thread_time()
    while time.thread_time() - began < seconds:
        pass
    slot.pause()
    yield niceness()


def is_lowered() -> bool:
    """Return whether this thread has a lower priority after asking for one."""
    lower_priority()
    return has_lower_priority()


def in_turns(seconds: float) -> int:
    slot = TurnFlag(CpuTime(), Turns(2))
    return next(slot.in_turns(computes(slot, seconds)))


def busy_until_told(pool: WorkerPool) -> threading.Event:
    """Occupy a thread of the pool; once the event is set, that thread lowers its priority and ends."""
    begun, go = threading.Event(), threading.Event()

    def work() -> None:
        begun.set()
        assert go.wait(60.0)
        lower_priority()

    pool.submit(work)
    assert begun.wait(60.0)
    return go


@linux
def test_only_long_work_lowers_its_priority_and_its_thread_takes_no_further_work() -> None:
    pool, usual = WorkerPool("test", 1), niceness()
    assert pool.submit(in_turns, 0.0).result(60.0) == usual
    first = pool.submit(threading.get_native_id).result(60.0)
    assert pool.submit(in_turns, 0.1).result(60.0) > usual
    after = pool.submit(lambda: (threading.get_native_id(), niceness()))  # waits for the only thread, which then ends
    assert after.result(60.0)[0] != first and after.result(60.0)[1] == usual
    waiting.until(lambda: pool.busy_threads == 0)  # the thread that has ended does not count either
    assert pool.queued == 0


@linux
def test_work_waiting_for_a_thread_that_ends_is_done_in_its_order() -> None:
    pool, done = WorkerPool("test", 1), list[int]()
    go = busy_until_told(pool)
    given = [pool.submit(done.append, number) for number in range(5)]
    last = pool.submit(niceness)
    assert pool.queued == 6
    go.set()
    for one in given:
        one.result(60.0)
    assert done == [0, 1, 2, 3, 4] and pool.queued == 0
    assert last.result(60.0) == niceness()  # its thread was started by one that gave way


@linux
def test_the_next_picture_of_a_visitor_does_not_give_way_with_the_last_one() -> None:
    found: list[int] = []
    jobs = LatestWins(found.append, lambda error: pytest.fail(str(error)))

    def work(before: Callable[[], None]) -> Callable[[TurnFlag], Iterator[int]]:
        def results(_: TurnFlag) -> Iterator[int]:
            yield niceness()
            before()

        return results

    for _ in range(3):
        jobs.submit(work(lower_priority))
        end = time.monotonic() + 60.0
        while jobs.busy:
            assert time.monotonic() < end
            time.sleep(0.001)
    assert found == [niceness()] * 3


def test_the_thread_of_the_event_loop_never_gives_way() -> None:
    assert threading.current_thread() is threading.main_thread()
    before = niceness() if sys.platform == "linux" else 0
    lower_priority()
    assert not has_lower_priority() and (sys.platform != "linux" or niceness() == before)


class Failing(threading.Thread):
    """A thread that the system refuses to start."""

    def start(self) -> None:
        """Fail as `Thread.start` does."""
        raise RuntimeError("can't start new thread")


@linux
def test_a_thread_that_cannot_be_started_is_an_error_and_the_next_one_starts() -> None:
    def starts() -> tuple[str, int]:
        lower_priority()
        try:
            begin(Failing())
        except RuntimeError as problem:
            said = str(problem)
        found = list[int]()
        thread = threading.Thread(target=lambda: found.append(niceness()))
        begin(thread)
        thread.join(60)
        return said, found[0]

    assert WorkerPool("test", 1).submit(starts).result(60.0) == ("can't start new thread", niceness())


@linux
def test_the_priority_stays_where_nothing_could_start_threads_of_usual_priority(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(priorities, "_STARTER", priorities._Starter())
    pool = WorkerPool("test", 1)
    assert pool.submit(int).result(60.0) == 0
    with monkeypatch.context() as full:
        full.setattr(threading.Thread, "start", Failing.start)
        assert pool.submit(is_lowered).result(60.0) is False
    assert pool.submit(is_lowered).result(60.0) is True


@linux
def test_work_behind_a_thread_of_lower_priority_is_done_by_it_where_no_other_can_be_started(monkeypatch: pytest.MonkeyPatch) -> None:
    pool = WorkerPool("test", 1)
    go = busy_until_told(pool)
    last = pool.submit(threading.get_native_id)
    monkeypatch.setattr("app.serve.computing.worker_pools.begin", lambda thread: Failing().start())
    go.set()
    assert last.result(60.0) > 0
    waiting.until(lambda: pool.busy_threads == 0)
    assert pool.queued == 0
