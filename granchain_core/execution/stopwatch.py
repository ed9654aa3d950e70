"""The time of a computation without that of compiling kernels, which happens once on a machine."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from numba.core import event


class CompilerClock(event.Listener):
    """Seconds that each thread has spent in Numba's compiler, waiting for it, or loading what it compiled before."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        self._clock, self._own = clock, threading.local()

    @property
    def seconds(self) -> float:
        """Seconds of this thread so far."""
        return getattr(self._own, "seconds", 0.0)

    def on_start(self, event: event.Event) -> None:
        """The compiler starts; kernels that call others start it again meanwhile."""
        self._own.depth = getattr(self._own, "depth", 0) + 1
        if self._own.depth == 1:
            self._own.began = self._clock()

    def on_end(self, event: event.Event) -> None:
        """The compiler is done."""
        self._own.depth -= 1
        if self._own.depth == 0:
            self._own.seconds = self.seconds + self._clock() - self._own.began


COMPILER_CLOCK = CompilerClock()
event.register("numba:compiler_lock", COMPILER_CLOCK)


class Stopwatch:
    """Time of a computation in this thread, without that of compiling kernels at their first use."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter,
                 compiler: CompilerClock = COMPILER_CLOCK) -> None:
        self._clock, self._compiler = clock, compiler
        self._began, self._compiled = clock(), compiler.seconds

    @property
    def seconds(self) -> float:
        """Seconds since the stopwatch was made, without those of the compiler."""
        return self._clock() - self._began - (self._compiler.seconds - self._compiled)
