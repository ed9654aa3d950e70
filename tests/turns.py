"""A dashboard's turns in tests: they are taken when the test says so."""

from __future__ import annotations

import time
from collections.abc import Callable


class Turns:
    """What waits for the document's turn, in order; a dashboard of a test appends to `turns` from any thread."""

    def __init__(self) -> None:
        self.turns: list[Callable[[], None]] = []

    def work_off(self, until: Callable[[], bool]) -> None:
        """Take turns until something holds."""
        end = time.monotonic() + 20
        while not until():
            assert time.monotonic() < end, "did not come"
            while self.turns:
                self.turns.pop(0)()
            time.sleep(0.002)
