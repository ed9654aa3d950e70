"""Passes the reports of a growing curve from the worker thread to the figure."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable

from ..session.host import PageHost
from .computation import Progress

#: Interval between drawings of a growing curve [s]; each draws all its points.
CURVE_EVERY = 0.1


class Reports:
    """Collects reports and hands them to `draw` together, at most once every `CURVE_EVERY` seconds.

    Drawn one by one, the curves of a whole class of students would keep the event loop busy.
    """

    def __init__(self, host: PageHost, draw: Callable[[list[Progress]], None]) -> None:
        self._host = host
        self._draw = draw
        self._lock = threading.Lock()
        self._waiting: list[Progress] = []
        self._drawn = -math.inf

    def add(self, report: Progress) -> None:
        """Add a report; called from the worker thread."""
        with self._lock:
            self._waiting.append(report)
            first = len(self._waiting) == 1
        if first:
            self._host.next_tick(self._hand_over)

    def drop(self) -> None:
        """Forget the reports that have not been drawn."""
        with self._lock:
            self._waiting = []

    def _hand_over(self) -> None:
        """Draw the waiting reports, now or once enough time has passed since the last drawing; document locked."""
        left = self._drawn + CURVE_EVERY - time.monotonic()
        if left > 0.0:
            self._host.call_later(left, self._hand_over)
            return
        self._drawn = time.monotonic()
        with self._lock:
            reports, self._waiting = self._waiting, []
        if reports:  # they may have been dropped
            self._draw(reports)
