"""Fair scheduling: the next picture computed is that of the waiting visitor who has used least time.

Kernels run without the interpreter's lock, so as many computations as there are cores go on at once. Each gives its
turn up at its pauses, some hundredths of a second apart, if a visitor waits that has used less. A computation that has
just begun, which is what a visitor sees first, goes before all that only make a picture better; one that has waited for
half a second has the same right.
"""

from __future__ import annotations

import math
import os
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from granchain_core.stop import Stop

Result = TypeVar("Result")

#: Processor time for which a computation has just begun [s]: that of a first picture of some ten beads.
_BEGINNING = 0.03
#: Over how many beginnings, and in which time [s], waits are averaged.
_REMEMBERED, _LATELY = 200, 10.0
#: After so long a wait a computation has the same right as one that has just begun [s].
_LONGEST_WAIT = 0.5

#: Time in which half of what a visitor has used is forgotten [s].
_HALF_LIFE = 5.0
#: A turn that has lasted longer than this does not keep others waiting [s]: not every computation can pause.
_LONGEST_TURN = 0.1


class CpuTime:
    """The processor time that one visitor has used lately [s]."""

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
    """Visitors who wait for the same picture: they share its cost, and queue as the one that has used least."""

    def __init__(self) -> None:
        super().__init__()
        self.members: list[CpuTime] = []

    @property
    def used(self) -> float:
        """The least time that any member has used [s]."""
        return min((member.used for member in list(self.members)), default=math.inf)

    def charge(self, seconds: float) -> None:
        """Each member pays its part."""
        members = list(self.members)
        for member in members:
            member.charge(seconds / len(members))


class _Wait:
    """One thread that waits for its turn."""

    def __init__(self, cpu_time: CpuTime, begins: bool, since: float) -> None:
        self.cpu_time, self.begins, self.since, self.granted = cpu_time, begins, since, threading.Event()

    def rank(self, now: float) -> tuple[bool, float]:
        """Who has the lowest is next."""
        return not self.begins and now - self.since < _LONGEST_WAIT, self.cpu_time.used


class FairScheduler:
    """Who computes now: at most `at_once`; of those that wait, who has used least is next."""

    def __init__(self, at_once: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._at_once, self._clock = at_once, clock
        self._lock = threading.Lock()
        self._running: dict[_Wait, float] = {}
        self._waiting: list[_Wait] = []
        self._waits: deque[tuple[float, float]] = deque(maxlen=_REMEMBERED)

    @property
    def wait(self) -> float:
        """How long a computation waited lately before it could begin, on average [s]."""
        since = self._clock() - _LATELY
        waits = [wait for at, wait in list(self._waits) if at > since]
        return sum(waits) / len(waits) if waits else 0.0

    @property
    def waiting(self) -> int:
        """How many wait for their turn."""
        return len(self._waiting)

    def begin(self, cpu_time: CpuTime, stop: Stop, begins: bool = True) -> object:
        """Wait for a turn, or until the stop flag is set; returns what `end` needs.

        `begins` says whether the computation has just begun.
        """
        mine = _Wait(cpu_time, begins, self._clock())
        with self._lock:
            self._waiting.append(mine)
            self._grant()
        while not mine.granted.wait(0.5 * _LONGEST_TURN):
            with self._lock:
                if stop and mine in self._waiting:
                    self._waiting.remove(mine)
                    break
                self._grant()
        return mine

    def end(self, turn: object) -> None:
        """The turn is over."""
        with self._lock:
            if isinstance(turn, _Wait):
                self._running.pop(turn, None)
            self._grant()

    def should_yield(self, cpu_time: CpuTime, begins: bool = True) -> bool:
        """Whether another waits that has used less, or has just begun while this one has not.

        Or more compute than there are turns, because some turns are old, and this one has used most of all: else what
        has just begun would share the cores with what has long been under way.
        """
        if not self._waiting and len(self._running) <= self._at_once:
            return False
        with self._lock:
            now, mine = self._clock(), (not begins, cpu_time.used)
            if any(other.rank(now) < mine for other in self._waiting):
                return True
            too_many = len(self._running) - self._at_once
            used = sorted((one.cpu_time.used for one in self._running), reverse=True)
            return too_many > 0 and cpu_time.used >= used[too_many - 1] > used[-1]

    def _grant(self) -> None:
        """With the lock held: give free turns to those who have used least."""
        now = self._clock()
        late = now - _LONGEST_TURN
        while self._waiting and sum(began > late for began in self._running.values()) < self._at_once:
            best = min(self._waiting, key=lambda one: one.rank(now))
            self._waiting.remove(best)
            self._running[best] = now
            if best.begins:
                self._waits.append((now, now - best.since))
            best.granted.set()


TURNS = FairScheduler(max(2, os.cpu_count() or 1))


class Flag(Stop):
    """A stop flag that wakes who waits: `on_set` is called in the thread that sets it."""

    __slots__ = ("on_set",)

    def __init__(self) -> None:
        super().__init__()
        self.on_set: Callable[[], None] | None = None

    def set(self) -> None:
        """Ask for the end."""
        super().set()
        if self.on_set is not None:
            self.on_set()


class SchedulerSlot(Flag):
    """The stop flag of a picture's computation, which takes turns with others while it computes."""

    __slots__ = ("_began", "_scheduler", "_spent", "_turn", "cpu_time")

    def __init__(self, cpu_time: CpuTime, scheduler: FairScheduler = TURNS) -> None:
        super().__init__()
        self.cpu_time = cpu_time
        self._scheduler = scheduler
        self._turn: object = None
        self._began = self._spent = 0.0

    @property
    def begins(self) -> bool:
        """Whether the computation has just begun."""
        return self._spent < _BEGINNING

    def pause(self) -> None:
        """Between two parts of the computation: let a visitor go first who has used less."""
        if self._turn is None:
            return
        self._charge()
        if self._scheduler.should_yield(self.cpu_time, self.begins):
            self._leave()
            self._enter()

    @contextmanager
    def held(self, anew: bool = False) -> Iterator[None]:
        """While a turn is held; wait for it first. `anew` where another computation begins with this flag."""
        if anew:
            self._spent = 0.0
        self._enter()
        try:
            yield
        finally:
            self._charge()
            self._leave()

    @contextmanager
    def released(self) -> Iterator[None]:
        """While this thread waits for something else, another has its turn."""
        if self._turn is None:
            yield
            return
        self._charge()
        self._leave()
        try:
            yield
        finally:
            self._enter()

    def in_turns(self, results: Iterable[Result]) -> Iterator[Result]:
        """The results, each computed while a turn is held."""
        found = iter(results)
        while True:
            with self.held():
                try:
                    result = next(found)
                except StopIteration:
                    return
            yield result

    def _enter(self) -> None:
        self._turn = self._scheduler.begin(self.cpu_time, self, self.begins)
        self._began = time.thread_time()

    def _leave(self) -> None:
        turn, self._turn = self._turn, None
        self._scheduler.end(turn)

    def _charge(self) -> None:
        now = time.thread_time()
        self.cpu_time.charge(now - self._began)
        self._spent += now - self._began
        self._began = now
