"""Debounced work: only the last of several starts is called, and none after a cancellation."""

from __future__ import annotations

from host import FakeHost

from app.session.debounce import Debounce


def test_only_the_last_start_is_called() -> None:
    host, called = FakeHost(), list[str]()
    quiet = Debounce(host, 0.35)
    assert not quiet.pending
    quiet.start(called.append, "first")
    quiet.start(called.append, "second")
    assert quiet.pending and called == []
    host.call_waiting()
    assert not quiet.pending and called == ["second"]


def test_nothing_is_called_after_a_cancel_and_a_new_start_counts() -> None:
    host, called = FakeHost(), list[str]()
    quiet = Debounce(host, 0.35)
    quiet.start(called.append, "cancelled")
    quiet.cancel()
    assert not quiet.pending
    host.call_waiting()
    assert called == []
    quiet.start(called.append, "new")
    host.call_waiting()
    assert called == ["new"]


def test_an_action_may_start_it_again() -> None:
    host, called = FakeHost(), list[int]()
    quiet = Debounce(host, 0.35)

    def again(left: int) -> None:
        called.append(left)
        if left:
            quiet.start(again, left - 1)

    quiet.start(again, 2)
    for _ in range(5):
        host.call_waiting()
    assert called == [2, 1, 0] and not quiet.pending
