"""Turns to compute, given by *least attained service* with a time slice; the docstring of `Turns` has the rule.

Kernels run without the GIL, so about as many computations run at once as there are cores. A computation is new until it
has its first result or has taken long; from then on, it is a refinement.
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple, TypeVar

from granchain_core.execution.cores import usable_cores
from granchain_core.execution.stop import Stop

from .cpu_time import CpuTime
from .priorities import lower_priority

Result = TypeVar("Result")

#: Processor time after which a computation is no longer new, even without a result [s]. A first picture of ten beads
#: takes a tenth of it.
_NEW_CPU_TIME = 0.03
#: Time for which a turn is kept although others are waiting [s]. Passing it on at every pause would cost too much: each
#: handover to another thread waits for the GIL several times.
_TIME_SLICE = 0.02
#: Largest number of new computations whose waits are averaged.
_MOST_WAITS = 200
#: Period over which the waits are averaged [s].
_WAITS_WINDOW = 10.0
#: Wait after which a refinement gets a turn even if new computations use all cores [s].
_LONGEST_WAIT = 0.5
#: Interval at which a waiting thread checks whether a computation may begin [s]: nothing notifies it when a turn has
#: become too old, or a wait too long. The interval is multiplied by the number of waiting computations.
_CHECK_INTERVAL = 0.05
#: Largest factor by which this interval is multiplied.
_LONGEST_CHECK_MULTIPLE = 20
#: Age after which a turn no longer keeps others waiting [s], since not every computation can pause.
_LONGEST_TURN = 0.1


class _Priority(NamedTuple):
    """Sort key of waiting computations: new before refinements, long waits first, then least processor time."""

    is_refinement: bool
    waited_little: bool
    used: float


class _Turn:
    """A thread that waits for a turn or has one.

    `at` is the time at which the wait or the turn began. `is_new` says whether the computation is new.
    """

    def __init__(self, cpu_time: CpuTime, stop: Stop, is_new: bool, at: float) -> None:
        self.cpu_time, self.stop, self.is_new, self.at = cpu_time, stop, is_new, at
        self.granted = threading.Event()

    def priority(self, now: float) -> _Priority:
        """Return the sort key of this thread among the waiting threads."""
        return _Priority(not self.is_new, now - self.at < _LONGEST_WAIT, self.cpu_time.used)


class Turns:
    """Gives turns to waiting computations.

    *Who is next.* New computations go before refinements. Among equals, those that have waited for `_LONGEST_WAIT` go
    first, followed by the session that has recently used the least processor time.

    *When.* A new computation gets a turn while fewer than `at_once` new computations have one, whatever else computes.
    A refinement gets a turn while fewer than `at_once` computations of both kinds have one. A refinement that has
    waited for `_LONGEST_WAIT` gets a turn while fewer than `at_once` refinements have one, so there can briefly be
    `2 * at_once` turns. Only turns younger than `_LONGEST_TURN` count.

    *How long.* A new computation is short and keeps its turn. A refinement gives up its turn at the first pause after
    its time slice at which `should_yield` returns True.
    """

    def __init__(self, at_once: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._at_once, self._clock = at_once, clock
        self._lock = threading.Lock()
        self._running: set[_Turn] = set()
        self._waiting: list[_Turn] = []
        self._waits: deque[tuple[float, float]] = deque(maxlen=_MOST_WAITS)
        self._checked_at = -math.inf

    @property
    def wait(self) -> float:
        """Mean recent wait of new computations [s]."""
        since = self._clock() - _WAITS_WINDOW
        waits = [wait for at, wait in list(self._waits) if at > since]
        return sum(waits) / len(waits) if waits else 0.0

    @property
    def waiting(self) -> int:
        """Number of computations waiting for a turn."""
        return len(self._waiting)

    @property
    def running(self) -> int:
        """Number of computations that have a turn."""
        return len(self._running)

    def begin(self, cpu_time: CpuTime, stop: Stop, is_new: bool = True) -> _Turn:
        """Wait for a turn or until the stop flag is set, and return the turn."""
        mine = _Turn(cpu_time, stop, is_new, self._clock())
        with self._lock:
            self._waiting.append(mine)
            self._grant()
        # One waiting thread checks for all of them; more checks would take the GIL from the event loop.
        while not mine.granted.wait(_CHECK_INTERVAL * min(len(self._waiting), _LONGEST_CHECK_MULTIPLE)):
            if stop:
                self.stopped(stop)
            elif self._clock() - self._checked_at >= _CHECK_INTERVAL:
                with self._lock:
                    self._grant()
        return mine

    def stopped(self, stop: Stop) -> None:
        """Release the thread that waits with this stop flag, because the flag has been set."""
        with self._lock:
            for turn in [turn for turn in self._waiting if turn.stop is stop]:
                self._waiting.remove(turn)
                turn.granted.set()

    def end(self, turn: _Turn) -> None:
        """End a turn."""
        with self._lock:
            self._running.discard(turn)
            self._grant()

    def became_refinement(self, turn: _Turn) -> None:
        """Treat the computation as a refinement from now on, to make room for a new one."""
        if turn.is_new:
            with self._lock:
                turn.is_new = False
                self._grant()

    def should_yield(self, turn: _Turn) -> bool:
        """Return whether a computation must give up its turn; a new computation keeps its turn.

        A refinement must give up its turn if a waiting computation has a higher priority. It must also do so if more
        than `at_once` computations have a turn and its session has used the most processor time of them.
        """
        with self._lock:
            now = self._clock()
            if turn.is_new or now - turn.at < _TIME_SLICE:
                return False
            mine = _Priority(is_refinement=True, waited_little=True, used=turn.cpu_time.used)
            if any(other.priority(now) < mine for other in self._waiting):
                return True
            too_many = len(self._running) - self._at_once
            more = sum(other.cpu_time.used > turn.cpu_time.used for other in self._running if not other.is_new)
            return more < too_many

    def _grant(self) -> None:
        """Give turns in order of priority; called with the lock held."""
        self._checked_at = now = self._clock()
        # Usually there is no room, and checking that is cheaper than sorting.
        if not any(self._has_room(turn, now) for turn in self._waiting):
            return
        for turn in sorted(self._waiting, key=lambda turn: turn.priority(now)):
            if not self._has_room(turn, now):
                continue
            if turn.is_new:
                self._waits.append((now, now - turn.at))
            self._waiting.remove(turn)
            self._running.add(turn)
            turn.at = now
            turn.granted.set()

    def _has_room(self, turn: _Turn, now: float) -> bool:
        """Return whether this turn could begin in addition to the turns that are held."""
        are_new = [other.is_new for other in self._running if now - other.at < _LONGEST_TURN]
        if turn.is_new:
            return sum(are_new) < self._at_once
        waited = now - turn.at >= _LONGEST_WAIT and are_new.count(False) < self._at_once
        return len(are_new) < self._at_once or waited


#: A turn for each core, and at least two: on a single core, two computations share it.
TURNS = Turns(max(2, usable_cores()))


class Flag(Stop):
    """A stop flag that calls `on_set` in the thread that sets it, in order to wake a waiting thread."""

    __slots__ = ("on_set",)

    def __init__(self) -> None:
        super().__init__()
        self.on_set: Callable[[], None] | None = None

    def set(self) -> None:
        """Set the flag: the computation should end."""
        super().set()
        if self.on_set is not None:
            self.on_set()


class TurnFlag(Flag):
    """The stop flag of a picture's computation, which takes turns with other computations."""

    __slots__ = ("_began", "_spent", "_turn", "_turns", "cpu_time", "waited")

    def __init__(self, cpu_time: CpuTime, turns: Turns = TURNS) -> None:
        super().__init__()
        self.cpu_time = cpu_time
        self._turns = turns
        self._turn: _Turn | None = None
        self._began = self._spent = 0.0
        #: Time for which its thread has waited for turns [s].
        self.waited = 0.0

    @property
    def is_new(self) -> bool:
        """Whether the computation is new: it has no result yet, and has not taken long."""
        return self._spent < _NEW_CPU_TIME

    def set(self) -> None:
        """Set the flag, which also ends a wait for a turn."""
        super().set()
        self._turns.stopped(self)

    def pause(self) -> None:
        """Give up the turn, between two parts of the computation, if another session is due."""
        if self._turn is None:
            return
        self._charge()
        self._lower_priority()
        if not self.is_new:
            self._turns.became_refinement(self._turn)
        if self._turns.should_yield(self._turn):
            self._release()
            self._enter()

    @contextmanager
    def held(self, is_new: bool = False) -> Iterator[None]:
        """Wait for a turn and hold it. With `is_new`, another computation begins with this flag."""
        if is_new:
            self._spent = 0.0
        self._enter()
        try:
            yield
        finally:
            self._charge()
            self._release()

    @contextmanager
    def released(self) -> Iterator[None]:
        """Give up the turn while this thread waits for something else."""
        if self._turn is None:
            yield
            return
        self._charge()
        self._release()
        try:
            yield
        finally:
            self._enter()

    def in_turns(self, results: Iterable[Result]) -> Iterator[Result]:
        """Yield the results, each computed while a turn is held."""
        remaining = iter(results)
        while True:
            with self.held():
                try:
                    result = next(remaining)
                except StopIteration:
                    return
            self._spent = math.inf
            yield result

    def _lower_priority(self) -> None:
        """Lower the priority of this thread, unless its computation is new."""
        if not self.is_new:
            lower_priority()

    def _enter(self) -> None:
        self._lower_priority()
        asked_at = time.monotonic()
        self._turn = self._turns.begin(self.cpu_time, self, self.is_new)
        self.waited += time.monotonic() - asked_at
        self._began = time.thread_time()

    def _release(self) -> None:
        turn, self._turn = self._turn, None
        if turn is not None:
            self._turns.end(turn)

    def _charge(self) -> None:
        now = time.thread_time()
        self.cpu_time.charge(now - self._began)
        self._spent += now - self._began
        self._began = now
