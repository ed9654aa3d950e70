"""Work that is given to a queue has a thread while there is one, and a visitor's computations go on after a failure."""

from __future__ import annotations

import threading

import pytest
import waiting

from app.serve.computing import queues
from app.serve.computing.queues import LatestWins, Queue

pytestmark = pytest.mark.quick


def test_work_does_not_wait_for_a_thread_that_has_just_been_given_other_work() -> None:
    """In 300 tries: a thread that had taken work and was not yet counted as busy kept the next waiting behind it."""
    queue = Queue("tested", 4)
    for _ in range(300):
        go_on, done = threading.Event(), threading.Event()
        first = queue.submit(go_on.wait, 120)
        queue.submit(done.set)
        assert done.wait(60), "it waits for the first, which takes long"
        go_on.set()
        assert first.result(60)


def test_what_waits_and_what_is_under_way_is_counted() -> None:
    queue, go_on = Queue("tested", 2), threading.Event()
    ended = [queue.submit(go_on.wait, 120) for _ in range(5)]
    assert (queue.busy_threads, queue.waiting) == (2, 3)
    go_on.set()
    assert all(one.result(20) for one in ended)
    assert queue.waiting == 0


def test_an_owner_beyond_its_share_waits_behind_others() -> None:
    """Two pieces of work of one visitor at a time: the third begins when one of them has ended, and not before."""
    queue, go_on, order = Queue("tested", 4, share=2), [threading.Event() for _ in range(4)], list[str]()

    def work(name: str, until: threading.Event) -> None:
        order.append(name)
        assert until.wait(120)

    mine = [queue.submit(work, name, until, owner="me") for name, until in zip("abc", go_on, strict=False)]
    other = queue.submit(work, "another's", go_on[3], owner="another")
    waiting.until(lambda: len(order) == 3)
    assert set(order) == {"a", "b", "another's"} and queue.busy_threads == 3
    go_on[1].set()
    waiting.until(lambda: len(order) == 4)
    assert order[-1] == "c" and not mine[0].done()
    for one in go_on:
        one.set()
    for future in (*mine, other):
        future.result(60)
    waiting.until(lambda: queue.busy_threads == 0)
    assert not queue._taken and not queue._held, "nothing of a visitor is kept"


def test_work_that_fails_gives_its_share_back() -> None:
    queue = Queue("tested", 1, share=1)
    failed = queue.submit(int, "no number", owner="me")
    assert queue.submit(int, "7", owner="me").result(60) == 7
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
    queue, go_on, owner = Queue("tested", 4, share=1), threading.Event(), object()
    ended = [queue.submit(go_on.wait, 120, owner=owner) for _ in range(3)]
    assert (queue.busy_threads, queue.waiting, queue.held) == (1, 0, 2)
    go_on.set()
    assert all(one.result(20) for one in ended)
    assert queue.held == 0


def test_all_queues_are_in_the_metrics() -> None:
    assert set(queues.QUEUES) == {one for one in vars(queues).values() if isinstance(one, Queue)}
