"""Timing of a computation without the compilation of kernels, which happens once per machine."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from numba.core import event


class CompilerClock(event.Listener):
    """Counts the seconds that each thread has spent in Numba's compiler, waiting for it, or loading cached code."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        self._clock, self._own = clock, threading.local()

    @property
    def seconds(self) -> float:
        """Seconds of this thread so far."""
        return getattr(self._own, "seconds", 0.0)

    def on_start(self, event: event.Event) -> None:
        """Note that the compiler starts; kernels that call other kernels start it again before it ends."""
        self._own.depth = getattr(self._own, "depth", 0) + 1
        if self._own.depth == 1:
            self._own.began = self._clock()

    def on_end(self, event: event.Event) -> None:
        """Add the time if the outermost call of the compiler ends."""
        self._own.depth -= 1
        if self._own.depth == 0:
            self._own.seconds = self.seconds + self._clock() - self._own.began


COMPILER_CLOCK = CompilerClock()
event.register("numba:compiler_lock", COMPILER_CLOCK)


class Stopwatch:
    """Measures the time of a computation in this thread, without the compilation of kernels at their first use."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter,
                 compiler: CompilerClock = COMPILER_CLOCK) -> None:
        self._clock, self._compiler = clock, compiler
        self._began, self._compiled = clock(), compiler.seconds

    @property
    def seconds(self) -> float:
        """Seconds since the stopwatch was created, without those of the compiler."""
        return self._clock() - self._began - (self._compiler.seconds - self._compiled)
