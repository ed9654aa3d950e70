"""The live run, which continues while knobs move: one step for each painted picture."""

from __future__ import annotations

import threading
import time
from collections import deque
from dataclasses import dataclass

from granchain_core import LiveChain, Run, Scene, State
from granchain_core.integrate.start import at_phase_0
from granchain_core.runs.live import joined

from ..frames import PERIODS, Frames, LiveWindow, samples_for
from ..serve.computing.cpu_time import CpuTime
from ..serve.computing.turns import TurnFlag

#: Viewing time that the first step of a run, or the first after a pause, makes up for [s]: two frames of a screen.
_FIRST_STEP = 0.03
#: Longest viewing time that one step makes up for [s]: the run does not jump after its tab was hidden.
_LONGEST_STEP = 0.1
#: Intended longest computing time of one step [s].
_LONGEST_COMPUTING = 0.1


@dataclass(frozen=True)
class LiveStep:
    """One step of the live run: the last few periods, the run of the newest samples, drive periods since the start."""

    frames: Frames
    run: Run
    periods: float


class LiveRun:
    """One chain that keeps running, from rest or from `start`.

    The first step makes the chain: this may compile or load kernels, for which the event loop has no time. A worker
    thread calls `step` and `advance`, and reads `scene`, which has the knobs of the next sample. The page uses
    everything else. The run holds its `flag` while it computes.
    """

    def __init__(self, scene: Scene, cpu_time: CpuTime, start: State | None = None) -> None:
        self.scene = scene
        self.samples = samples_for(scene)
        self.flag = TurnFlag(cpu_time)
        self._first = scene, start
        self._chain: LiveChain | None = None
        self._window = LiveWindow(self.samples)
        self._lock = threading.Lock()
        self._new_scene: Scene | None = None
        self._reset = False
        self._last: float | None = None
        self._owed = 0.0
        self._most = self.samples
        self._shown = 0
        self._runs: deque[Run] = deque()

    def change(self, scene: Scene) -> None:
        """Take over new knobs before the next sample."""
        with self._lock:
            self.scene = self._new_scene = scene

    def reset(self) -> None:
        """Return to rest before the next sample."""
        with self._lock:
            self._reset = True

    def hold(self) -> None:
        """Stop the clock until the next step: no viewing time passes."""
        self._last = None

    def close(self) -> None:
        """The session has ended: end the computation under way."""
        self.flag.set()

    def step(self, periods_per_second: float) -> LiveStep:
        """Advance by the viewing time since the last step; in slow motion, wait for the next sample.

        A step computes for about `_LONGEST_COMPUTING` at most, so that a slow chain lags behind the clock and not
        behind its knobs.
        """
        rate = periods_per_second * self.samples
        now = time.perf_counter()
        elapsed = _FIRST_STEP if self._last is None else min(now - self._last, _LONGEST_STEP)
        self._owed = min(self._owed, 1.0) + elapsed * rate
        if self._owed < 1.0:
            with self.flag.released():
                time.sleep((1.0 - self._owed) / rate)
            self._owed = 1.0
        self._last = time.perf_counter()
        return self.advance(min(int(self._owed), self._most))

    def window_run(self) -> Run | None:
        """The periods on the screen as one run, to be saved."""
        return joined(list(self._runs)) if self._runs else None

    def advance(self, samples: int) -> LiveStep:
        """The window after `samples` more samples."""
        chain = self._chain = self._chain or self._made()
        with self._lock:
            scene, self._new_scene = self._new_scene, None
            reset, self._reset = self._reset, False
        if scene is not None:
            chain.change(scene)
        if reset:
            chain.reset()
            self._window = LiveWindow(self.samples)
            self._runs.clear()
            self._shown = 0
        self._owed = max(0.0, self._owed - samples)
        began = time.thread_time()
        run = chain.advance(samples)
        self._most = max(1, int(samples * _LONGEST_COMPUTING / max(time.thread_time() - began, 1e-6)))
        self._shown += samples
        self._remember(run)
        return LiveStep(self._window.add(run), run, self._shown / self.samples)

    def _made(self) -> LiveChain:
        scene, start = self._first
        begin = None if start is None else at_phase_0(scene, start, self.flag)
        return LiveChain(scene, samples=self.samples, start=begin, stop=self.flag)

    def _remember(self, run: Run) -> None:
        if self._runs and self._runs[-1].displacement.shape[1] != run.displacement.shape[1]:
            self._runs.clear()
        self._runs.append(run)
        while sum(len(piece.time) - 1 for piece in self._runs) > PERIODS * self.samples and len(self._runs) > 1:
            self._runs.popleft()
