"""The processor time that sessions have used lately, by which turns are given (turns.py)."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

#: Time in which half of what a session has used is forgotten [s].
_HALF_LIFE = 5.0


class CpuTime:
    """The processor time that one session has used lately [s]."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._used, self._at = clock, 0.0, clock()

    @property
    def used(self) -> float:
        """The time used [s]; half of it is forgotten every five seconds."""
        return self._used * math.exp2((self._at - self._clock()) / _HALF_LIFE)

    def charge(self, seconds: float) -> None:
        """Add processor time [s]."""
        self._used, self._at = self.used + seconds, self._clock()


class SharedCpuTime(CpuTime):
    """Sessions that wait for one picture: they share its cost, and their rank is that of the one that used least."""

    def __init__(self) -> None:
        super().__init__()
        self.members: list[CpuTime] = []

    @property
    def used(self) -> float:
        """The least time that any member has used [s]."""
        return min((member.used for member in list(self.members)), default=math.inf)

    def charge(self, seconds: float) -> None:
        """Charge each member an equal part."""
        members = list(self.members)
        for member in members:
            member.charge(seconds / len(members))
