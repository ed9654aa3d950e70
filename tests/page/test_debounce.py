"""Work that waits until nothing moves: only the last of several starts is called, and none after a cancel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from app.page.debounce import Debounce


class Clock:
    """A host that keeps what is to be called later."""

    def __init__(self) -> None:
        self.waiting: list[Callable[[], None]] = []

    def call_later(self, seconds: float, action: Callable[..., None], *arguments: Any) -> None:
        """Kept until the test lets the time pass."""
        assert seconds == 0.35
        self.waiting.append(lambda: action(*arguments))

    def pass_time(self) -> None:
        """All quiet times end."""
        waiting, self.waiting = self.waiting, []
        for action in waiting:
            action()


def test_only_the_last_start_is_called() -> None:
    clock, called = Clock(), list[str]()
    quiet = Debounce(clock, 0.35)  # type: ignore[arg-type]
    assert not quiet.pending
    quiet.start(called.append, "first")
    quiet.start(called.append, "second")
    assert quiet.pending and called == []
    clock.pass_time()
    assert not quiet.pending and called == ["second"]


def test_nothing_is_called_after_a_cancel_and_a_new_start_counts() -> None:
    clock, called = Clock(), list[str]()
    quiet = Debounce(clock, 0.35)  # type: ignore[arg-type]
    quiet.start(called.append, "cancelled")
    quiet.cancel()
    assert not quiet.pending
    clock.pass_time()
    assert called == []
    quiet.start(called.append, "new")
    clock.pass_time()
    assert called == ["new"]


def test_an_action_may_start_it_again() -> None:
    clock, called = Clock(), list[int]()
    quiet = Debounce(clock, 0.35)  # type: ignore[arg-type]

    def again(left: int) -> None:
        called.append(left)
        if left:
            quiet.start(again, left - 1)

    quiet.start(again, 2)
    for _ in range(5):
        clock.pass_time()
    assert called == [2, 1, 0] and not quiet.pending
