"""Wait for an expected event, with a generous time limit: no test depends on speed."""

from __future__ import annotations

import time
from collections.abc import Callable


def until(holds: Callable[[], object], seconds: float = 60.0, pause: Callable[[], object] = lambda: time.sleep(0.002)) -> None:
    """Call `pause` until `holds()` is true."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "did not come"
        pause()
