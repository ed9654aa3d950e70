"""The processor time that each session has used recently, by which turns are given (turns.py)."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

#: Time after which half of the time that a session has used is forgotten [s].
_HALF_LIFE = 5.0


class CpuTime:
    """The processor time that one session has used recently [s]."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._used, self._at = clock, 0.0, clock()

    @property
    def used(self) -> float:
        """The time used [s]; half of it is forgotten after each `_HALF_LIFE`."""
        return self._used * math.exp2((self._at - self._clock()) / _HALF_LIFE)

    def charge(self, seconds: float) -> None:
        """Add processor time [s]."""
        self._used, self._at = self.used + seconds, self._clock()


class SharedCpuTime(CpuTime):
    """The processor time of a computation that several sessions wait for.

    The sessions share the cost. The computation ranks like the session that has used the least.
    """

    def __init__(self) -> None:
        super().__init__()
        self.members: list[CpuTime] = []

    @property
    def used(self) -> float:
        """The smallest time used by any member [s]."""
        return min((member.used for member in list(self.members)), default=math.inf)

    def charge(self, seconds: float) -> None:
        """Charge every member an equal share."""
        members = list(self.members)
        for member in members:
            member.charge(seconds / len(members))
