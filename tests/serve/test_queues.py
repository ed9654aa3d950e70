"""Work that is given to a queue has a thread while there is one, and a visitor's computations go on after a failure."""

from __future__ import annotations

import threading

from app.serve.queues import LatestWins, Queue


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
    assert (queue.busy, queue.waiting) == (2, 3)
    go_on.set()
    assert all(one.result(20) for one in ended)
    assert queue.waiting == 0


def test_after_a_failure_that_cannot_be_reported_the_next_picture_comes() -> None:
    came = threading.Event()

    def fail(error: Exception) -> None:
        raise RuntimeError("the page is gone") from error

    def broken(_: object) -> object:
        raise ValueError

    jobs = LatestWins(lambda _: came.set(), fail)
    jobs.submit(broken)  # type: ignore[arg-type]
    while jobs.busy:
        pass
    jobs.submit(lambda _: iter([1]))
    assert came.wait(20)
