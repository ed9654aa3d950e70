"""Work shared by threads: every result arrives, and anything that ends a thread ends the iteration."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest

from granchain_core.errors import Cancelled
from granchain_core.execution.stop import Stop
from granchain_core.steady.batch.threads import on_all_cores


def squares(items: Iterator[int]) -> Iterator[int]:
    """Do the work of one thread."""
    for item in items:
        yield item * item


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_every_result_arrives_once(workers: int) -> None:
    results = list(on_all_cores(squares, range(100), Stop(), workers=workers))
    assert sorted(results) == [item * item for item in range(100)]


@pytest.mark.parametrize("kind", [ValueError, SystemExit, KeyboardInterrupt, Cancelled])
def test_an_exception_of_a_thread_is_raised_by_the_caller(kind: type[BaseException]) -> None:
    """This includes exceptions that are not an `Exception`, and an unrequested `Cancelled`, so that the caller never
    waits for a thread that has ended.
    """
    def work(items: Iterator[int]) -> Iterator[int]:
        for item in items:
            if item == 3:
                raise kind("three")
            yield item

    ended, raised = Stop(), list[BaseException]()

    def read() -> None:
        try:
            list(on_all_cores(work, range(10), ended, workers=2))
        except BaseException as problem:
            raised.append(problem)

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    reader.join(60.0)
    assert not reader.is_alive()
    assert [(type(one), one.args) for one in raised] == [(kind, ("three",))] and ended


@pytest.mark.parametrize("asked", ["stop", "ended"])
def test_a_requested_end_raises_no_exception(asked: str) -> None:
    """The work notices the flag before the caller does, and ends with `Cancelled`."""
    ended, stop = Stop(), Stop()

    def work(items: Iterator[int]) -> Iterator[int]:
        for item in items:
            if item == 3:
                (stop if asked == "stop" else ended).set()
                raise Cancelled
            yield item

    results = list(on_all_cores(work, range(6), ended, stop, workers=1))
    assert results == [0, 1, 2][: len(results)] and ended
