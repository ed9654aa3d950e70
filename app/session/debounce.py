"""Debouncing: an action is called once nothing has moved for a while."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .host import Caller


class Debounce:
    """Calls an action with the document locked, a quiet time after the last `start`."""

    def __init__(self, host: Caller, seconds: float) -> None:
        self._host = host
        self._seconds = seconds
        self._last = 0
        self.pending = False

    def start(self, action: Callable[..., None], *args: Any) -> None:
        """Call `action` after the quiet time, instead of any action that was started before."""
        self._last += 1
        self.pending = True
        self._host.call_later(self._seconds, self._run, self._last, action, args)

    def cancel(self) -> None:
        """Forget the waiting action."""
        self._last += 1
        self.pending = False

    def _run(self, number: int, action: Callable[..., None], args: tuple[Any, ...]) -> None:
        if number == self._last:
            self.pending = False
            action(*args)
