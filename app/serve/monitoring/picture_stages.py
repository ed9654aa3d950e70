"""The time that a picture takes from its request to the screen, stage by stage."""

from __future__ import annotations

import logging
import math
import time

from .metrics import METRICS

log = logging.getLogger("granchain")

#: Time from the request to the screen above which the log lists the stages of a picture [s].
SLOW_PICTURE = 1.0


class PictureStages:
    """The stages of the first picture of one request (`STAGES` in metrics.py), in seconds.

    Only one thread at a time works on a picture, so its stages follow each other: `end` adds the time since the last
    call to a stage. If a session waits for the same picture as another, its whole wait is in the stage "compute".
    """

    __slots__ = ("_began", "_ended", "_seconds", "turn_wait")

    def __init__(self) -> None:
        self._began = self._ended = time.monotonic()
        self._seconds: dict[str, float] = {}
        #: Time for which the computation waited for turns before its first picture [s]; its thread sets it.
        self.turn_wait = 0.0

    @property
    def elapsed(self) -> float:
        """The time since the request [s]."""
        return time.monotonic() - self._began

    def end(self, stage: str) -> float:
        """End a stage; return the time since the end of the previous stage [s]."""
        now = time.monotonic()
        seconds, self._ended = now - self._ended, now
        self._add(stage, seconds)
        return seconds

    def computed(self) -> None:
        """End "compute", because the first picture is ready; the part spent waiting for turns counts as "turn"."""
        waited = min(self.turn_wait, self.end("compute"))
        self._add("turn", waited)
        self._add("compute", -waited)

    def _add(self, stage: str, seconds: float) -> None:
        self._seconds[stage] = self._seconds.get(stage, 0.0) + seconds

    def painted(self, browser_ms: object) -> None:
        """Count the stages of a picture that is on the screen, and log a slow picture.

        `browser_ms` is the time from the browser's script to the screen, as reported by the browser [ms]. It is not
        trusted: a value that is not a finite number is ignored, and one out of range is clipped.
        """
        seconds = self.end("travel")
        if isinstance(browser_ms, (int, float)) and not isinstance(browser_ms, bool) and math.isfinite(browser_ms):
            painting = min(max(0.0, 1e-3 * browser_ms), seconds)
            self._add("paint", painting)
            self._add("travel", -painting)
        METRICS.picture_painted(self._seconds)
        duration = self._ended - self._began
        if duration > SLOW_PICTURE:
            stages = sorted(self._seconds.items(), key=lambda stage: -stage[1])
            log.info("a picture took %.2f s: %s", duration,
                     ", ".join(f"{stage} {seconds:.2f} s" for stage, seconds in stages if seconds >= 0.005))
