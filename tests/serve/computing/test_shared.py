"""Requests shared by several visitors are computed once, kept in bounded memory, and stopped when nobody needs them."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Iterator
from typing import Any

import pytest
from waiting import until

from app.serve.computing.cpu_time import CpuTime
from app.serve.computing.latest_wins import LatestWins
from app.serve.computing.shared import Shared
from app.serve.computing.turns import Flag, TurnFlag
from app.serve.computing.worker_pools import WorkerPool
from granchain_core import Cancelled, OverBudget

pytestmark = pytest.mark.quick


class Work:
    """A computation of three results that advances when the test says so."""

    def __init__(self) -> None:
        self.begun, self.go, self.stops = 0, threading.Semaphore(0), []

    def __call__(self, stop: TurnFlag) -> Iterator[int]:
        """Yield 1, 2, 3."""
        self.begun += 1
        self.stops.append(stop)
        for number in (1, 2, 3):
            while not self.go.acquire(timeout=0.01):
                stop.check()
            yield number


def shared(memory: int = 1000) -> Shared[int]:
    """Return a store in which each result takes 10 bytes and a computation's last result is kept."""
    return Shared(WorkerPool("test", 20), memory, lambda _: 10, lambda items: items[-1:])


def follower(one: Shared[int], key: str | None, work: Work, found: list[Any], stop: Flag | None = None) -> threading.Thread:
    """Return a visitor in its own thread."""

    def follow() -> None:
        try:
            found.extend(one.follow(key, work, Flag() if stop is None else stop, CpuTime()))
        except (Cancelled, ZeroDivisionError) as problem:
            found.append(type(problem))

    thread = threading.Thread(target=follow, daemon=True)
    thread.start()
    return thread


def test_equal_requests_cost_one_computation() -> None:
    one, work, found = shared(), Work(), [[] for _ in range(30)]
    threads = [follower(one, "key", work, seen) for seen in found]
    until(lambda: one.hits + one.misses == 30)
    work.go.release(3)
    for thread in threads:
        thread.join(20)
    assert work.begun == 1 and found == [[1, 2, 3]] * 30
    later: list[int] = []
    follower(one, "key", work, later).join(20)
    assert work.begun == 1 and later == [3]


def test_the_cache_is_bounded_and_drops_its_oldest_entry() -> None:
    one, work = shared(memory=25), Work()
    for key in ("a", "b", "a", "c", "a", "b"):
        work.go.release(3)
        follower(one, key, work, []).join(20)
        assert one.used <= 25
        work.go = threading.Semaphore(0)
    assert work.begun == 4  # b was dropped for c, a was not


def test_a_shared_computation_ends_with_its_last_visitor() -> None:
    one, work, first, second = shared(), Work(), Flag(), Flag()
    seen: list[list[Any]] = [[], []]
    threads = [follower(one, "key", work, seen[0], first), follower(one, "key", work, seen[1], second)]
    until(lambda: one.hits == 1 and work.begun == 1)
    first.set()
    threads[0].join(20)
    assert seen[0] == [Cancelled] and not work.stops[0]
    work.go.release(1)
    until(lambda: seen[1] == [1])
    second.set()
    threads[1].join(20)
    until(lambda: bool(work.stops[0]))
    work.go.release(9)  # cancelled computations may have consumed some
    follower(one, "key", work, []).join(20)
    assert work.begun == 2  # a cancelled computation does not count as a result


def test_an_error_reaches_all_visitors_and_is_not_cached() -> None:
    one = shared()

    def fails(stop: TurnFlag) -> Iterator[int]:
        raise ZeroDivisionError
        yield 1

    for _ in range(2):
        found: list[Any] = []
        follower(one, "key", fails, found).join(20)  # type: ignore[arg-type]
        assert found == [ZeroDivisionError]


@pytest.mark.parametrize("error", [ZeroDivisionError("1/0"), OverBudget("It takes too long.", 3.0, 1.0), OSError(2, "no such file")])
def test_each_session_raises_an_error_of_its_own(error: Exception) -> None:
    """The traceback of one session has no frames of another."""
    one, go, caught = shared(), threading.Event(), list[Exception]()

    def fails(_: TurnFlag) -> Iterator[int]:
        assert go.wait(20)
        raise error
        yield 1

    def follow() -> None:
        try:
            list(one.follow("key", fails, Flag(), CpuTime()))
        except Exception as problem:
            caught.append(problem)

    threads = [threading.Thread(target=follow, daemon=True) for _ in range(4)]
    for thread in threads:
        thread.start()
    until(lambda: one.hits + one.misses == 4)
    go.set()
    for thread in threads:
        thread.join(20)
    assert [(type(own), str(own), vars(own)) for own in caught] == 4 * [(type(error), str(error), vars(error))]
    assert len(set(map(id, caught))) == 4 and len({len(traceback.extract_tb(own.__traceback__)) for own in caught}) == 1


def test_a_first_result_that_takes_long_gives_way_to_a_newer_request(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.serve.computing.latest_wins._FIRST_RESULT_TIME", 0.05)
    delivered: list[object] = []
    jobs = LatestWins(delivered.append, delivered.append)
    begun = threading.Event()

    def endless(stop: TurnFlag) -> Iterator[object]:
        begun.set()
        while True:
            stop.check()
        yield "never"

    jobs.submit(endless)
    assert begun.wait(20)
    jobs.submit(lambda _: iter(["new"]))
    until(lambda: delivered == ["new"])


def test_nothing_is_delivered_to_a_visitor_who_left() -> None:
    delivered: list[object] = []
    jobs = LatestWins(delivered.append, delivered.append)
    gone, went_on = threading.Event(), threading.Event()

    def work(stop: TurnFlag) -> Iterator[object]:
        assert gone.wait(20)
        yield "late"
        went_on.set()

    jobs.submit(work)
    jobs.close()
    gone.set()
    until(lambda: not jobs.busy)
    assert delivered == [] and not went_on.is_set()


def test_a_computation_whose_thread_could_not_be_started_is_not_under_way(monkeypatch: pytest.MonkeyPatch) -> None:
    one = shared()
    with monkeypatch.context() as full:
        full.setattr("app.serve.computing.worker_pools.begin", fails)
        with pytest.raises(RuntimeError, match="new thread"):
            next(one.follow("key", lambda _: iter([1]), Flag(), CpuTime()))
    assert (one.hits, one.misses) == (0, 0)
    assert list(one.follow("key", lambda _: iter([2]), Flag(), CpuTime())) == [2]


def fails(_: threading.Thread) -> None:
    raise RuntimeError("can't start new thread")
