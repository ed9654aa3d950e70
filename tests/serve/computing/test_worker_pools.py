"""Work submitted to a pool gets a thread if one is free, and a session's computations continue after a failure."""

from __future__ import annotations

import gc
import threading
import time
import weakref
from collections.abc import Callable
from concurrent.futures import Future

import pytest
import waiting

from app.serve.computing import worker_pools
from app.serve.computing.latest_wins import LatestWins, _Alarms
from app.serve.computing.worker_pools import WorkerPool

pytestmark = pytest.mark.quick


def test_work_does_not_wait_for_a_thread_that_has_just_been_given_other_work() -> None:
    """In 300 tries: a thread that had taken work but did not count as busy yet kept the next work waiting behind it."""
    pool = WorkerPool("tested", 4)
    for _ in range(300):
        go_on, done = threading.Event(), threading.Event()
        first = pool.submit(go_on.wait, 120)
        pool.submit(done.set)
        assert done.wait(60), "it waits for the first, which takes long"
        go_on.set()
        assert first.result(60)


def test_waiting_and_running_work_is_counted() -> None:
    pool, go_on = WorkerPool("tested", 2), threading.Event()
    ended = [pool.submit(go_on.wait, 120) for _ in range(5)]
    assert (pool.busy_threads, pool.queued) == (2, 3)
    go_on.set()
    assert all(one.result(20) for one in ended)
    assert pool.queued == 0


@pytest.mark.parametrize("limit", [None, 1])
def test_cancelled_work_that_has_not_begun_is_not_done_and_not_kept(limit: int | None) -> None:
    """Otherwise, 50 uploads that replace each other would stay in memory until a thread is free."""
    class File:
        """An object that the work would use."""

    pool, go_on, done, owner = WorkerPool("tested", 1, per_owner_limit=limit), threading.Event(), list[object](), object()
    first = pool.submit(go_on.wait, 120, owner=owner)
    files = [File() for _ in range(50)]
    kept = weakref.WeakSet(files)
    futures = [pool.submit(done.append, one, owner=owner) for one in files]
    del files
    assert len(kept) == 50
    assert all(one.cancel() for one in futures[:49])
    gc.collect()
    assert len(kept) == 1
    assert limit is None or pool.held == 1
    go_on.set()
    futures[49].result(60)
    assert len(done) == 1 and first.result(60)
    waiting.until(lambda: pool.busy_threads == 0)
    assert not pool._taken and not pool._held and pool.queued == 0


@pytest.mark.parametrize("limit", [None, 1])
def test_work_that_is_cancelled_as_a_thread_takes_it_is_left_alone(limit: int | None, caplog: pytest.LogCaptureFixture,
                                                                   monkeypatch: pytest.MonkeyPatch) -> None:
    """The thread intervenes between a cancellation's two steps: setting the future's state, calling its callbacks."""
    pool, go_on, taken = WorkerPool("tested", 1, per_owner_limit=limit), threading.Event(), threading.Event()

    def after_the_thread(_: object) -> None:
        go_on.set()
        assert pool.submit(taken.set).result(60) is None, "the only thread has passed the cancelled work"

    class Told(Future[object]):
        """A future that notifies the thread before it notifies the pool."""

        def add_done_callback(self, fn: Callable[[Future[object]], object]) -> None:
            super().add_done_callback(after_the_thread)
            super().add_done_callback(fn)

    first, owner = pool.submit(go_on.wait, 120), object()
    with monkeypatch.context() as patch:
        patch.setattr(worker_pools, "Future", Told)
        second = pool.submit(pytest.fail, "it was cancelled", owner=owner)
    assert second.cancel() and first.result(60) and taken.is_set()
    assert caplog.records == [] and not pool._taken and not pool._held


def test_an_owner_beyond_its_limit_waits_behind_others() -> None:
    """One owner has two pieces of work at a time: the third starts when one of them has ended, and not before."""
    pool, go_on, order = WorkerPool("tested", 4, per_owner_limit=2), [threading.Event() for _ in range(4)], list[str]()

    def work(name: str, until: threading.Event) -> None:
        order.append(name)
        assert until.wait(120)

    mine = [pool.submit(work, name, until, owner="me") for name, until in zip("abc", go_on, strict=False)]
    other = pool.submit(work, "another's", go_on[3], owner="another")
    waiting.until(lambda: len(order) == 3)
    assert set(order) == {"a", "b", "another's"} and pool.busy_threads == 3
    go_on[1].set()
    waiting.until(lambda: len(order) == 4)
    assert order[-1] == "c" and not mine[0].done()
    for one in go_on:
        one.set()
    for future in (*mine, other):
        future.result(60)
    waiting.until(lambda: pool.busy_threads == 0)
    assert pool.held == 0


class Owner:
    """The owner of work."""


def test_a_pool_keeps_no_owner_whose_work_has_ended() -> None:
    """This includes an owner whose work was held back."""
    pool, owner = WorkerPool("tested", 1, per_owner_limit=1), Owner()
    given = [pool.submit(time.sleep, 0.0, owner=owner) for _ in range(3)]
    for future in given:
        future.result(60)
    kept = weakref.ref(owner)
    del owner
    waiting.until(lambda: kept() is None)


def test_work_that_fails_counts_to_no_limit_any_more() -> None:
    pool = WorkerPool("tested", 1, per_owner_limit=1)
    failed = pool.submit(int, "no number", owner="me")
    assert pool.submit(int, "7", owner="me").result(60) == 7
    assert isinstance(failed.exception(60), ValueError)


def test_after_a_failure_that_cannot_be_reported_the_next_picture_comes() -> None:
    came = threading.Event()

    def fail(error: Exception) -> None:
        raise RuntimeError("the page is gone") from error

    def broken(_: object) -> object:
        raise ValueError

    jobs = LatestWins(lambda _: came.set(), fail)
    jobs.submit(broken)  # type: ignore[arg-type]
    waiting.until(lambda: not jobs.busy)
    jobs.submit(lambda _: iter([1]))
    assert came.wait(20)


def test_work_beyond_a_share_is_counted_as_held() -> None:
    pool, go_on, owner = WorkerPool("tested", 4, per_owner_limit=1), threading.Event(), object()
    ended = [pool.submit(go_on.wait, 120, owner=owner) for _ in range(3)]
    assert (pool.busy_threads, pool.queued, pool.held) == (1, 0, 2)
    go_on.set()
    assert all(one.result(20) for one in ended)
    assert pool.held == 0


def test_all_pools_are_in_the_metrics() -> None:
    assert set(worker_pools.POOLS) == {one for one in vars(worker_pools).values() if isinstance(one, WorkerPool)}


class NoThreads:
    """A system that refuses new threads while `full`."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, full: bool = True) -> None:
        self.full = full
        start = threading.Thread.start

        def started(thread: threading.Thread) -> None:
            if self.full:
                raise RuntimeError("can't start new thread")
            start(thread)

        monkeypatch.setattr(threading.Thread, "start", started)


@pytest.mark.parametrize("limit", [None, 1])
def test_a_pool_that_could_not_start_its_first_thread_does_the_next_work(limit: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    pool, system, owner = WorkerPool("tested", 1, per_owner_limit=limit), NoThreads(monkeypatch), object()
    with pytest.raises(RuntimeError, match="new thread"):
        pool.submit(int, owner=owner)
    assert (pool.queued, pool.held, pool.busy_threads) == (0, 0, 0)
    system.full = False
    assert pool.submit(int, owner=owner).result(60) == 0
    waiting.until(lambda: pool.busy_threads == 0)


def test_where_no_other_thread_can_be_started_the_threads_there_are_do_all_work(monkeypatch: pytest.MonkeyPatch) -> None:
    pool, go_on, system = WorkerPool("tested", 3), threading.Event(), NoThreads(monkeypatch, full=False)
    first = pool.submit(go_on.wait, 120)
    system.full = True
    others = [pool.submit(int) for _ in range(3)]
    assert (pool.busy_threads, pool.queued) == (1, 3)
    go_on.set()
    assert first.result(60) and [one.result(60) for one in others] == [0, 0, 0]
    waiting.until(lambda: pool.busy_threads == 0)
    assert pool.queued == 0


def test_a_session_whose_thread_could_not_be_started_gets_its_next_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    found = list[object]()
    monkeypatch.setattr("app.serve.computing.latest_wins.SESSION_WORK", WorkerPool("tested", 2))
    jobs, system = LatestWins(found.append, lambda error: pytest.fail(str(error))), NoThreads(monkeypatch)
    with pytest.raises(RuntimeError, match="new thread"):
        jobs.submit(lambda _: iter(["lost"]))
    assert not jobs.busy
    system.full = False
    jobs.submit(lambda _: iter(["next"]))
    waiting.until(lambda: found == ["next"])


def test_an_alarm_whose_thread_could_not_be_started_rings_with_the_next_one(monkeypatch: pytest.MonkeyPatch) -> None:
    later, rung, system = _Alarms(), list[int](), NoThreads(monkeypatch)
    later(0.0, rung.append, 1)
    system.full = False
    later(0.0, rung.append, 2)
    waiting.until(lambda: rung == [1, 2])
