"""A stop flag with a time limit, so that one slow setting does not delay the others."""

from __future__ import annotations

import threading
import time

from ..execution.stop import Stop

#: Time between two checks of the outer flag and the clock [s].
_LOOK = 0.01


class Limited:
    """`with Limited(stop, seconds) as limit:` gives `limit.stop`, raised with `stop` or after `seconds`.

    Afterwards `stop` tells the two apart: it is set if the computation was cancelled, and not if it was only too slow.
    """

    def __init__(self, stop: Stop, seconds: float) -> None:
        self.stop = Stop()
        self._outer = stop
        self._seconds = seconds
        self._done = threading.Event()
        self._watcher = threading.Thread(target=self._watch, name="limit", daemon=True)

    def __enter__(self) -> Limited:
        self._end = time.monotonic() + self._seconds
        self._watcher.start()
        return self

    def __exit__(self, *problem: object) -> None:
        self._done.set()
        self._watcher.join()

    def _watch(self) -> None:
        while not self._done.wait(_LOOK):
            if self._outer or time.monotonic() > self._end:
                self.stop.set()
                return
