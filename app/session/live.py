"""The live run, which continues while knobs move, with one step for each painted picture."""

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

#: Viewing time covered by the first step of a run or after a pause [s]: two frames of a screen.
_FIRST_STEP = 0.03
#: Longest viewing time covered by one step [s]: the run must not jump after its tab was hidden.
_LONGEST_STEP = 0.1
#: Longest computing time that one step aims at [s].
_LONGEST_COMPUTING = 0.1


@dataclass(frozen=True)
class LiveStep:
    """One step of the live run: the last few periods, the newest samples as a run, drive periods since the start."""

    frames: Frames
    run: Run
    periods: float


class LiveRun:
    """One chain that keeps running, from rest or from `start`.

    The first step makes the chain, because this may compile or load kernels, for which the event loop has no time. A
    worker thread calls `step` and `advance`, and reads `scene`, which has the knobs of the next sample. The page uses
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
        #: When the last step started to compute, on the clock of `time.perf_counter` [s]; None after a pause.
        self._last: float | None = None
        #: Samples that are due by the viewing time but not computed yet; the fraction is kept.
        self._samples_due = 0.0
        #: Largest number of samples of the next step, so that it computes for about `_LONGEST_COMPUTING`.
        self._most_samples = self.samples
        #: Samples computed since the start or the last reset.
        self._samples_shown = 0
        self._runs: deque[Run] = deque()

    def change(self, scene: Scene) -> None:
        """Apply new knobs before the next sample."""
        with self._lock:
            self.scene = self._new_scene = scene

    def reset(self) -> None:
        """Return to rest before the next sample."""
        with self._lock:
            self._reset = True

    def hold(self) -> None:
        """Stop the clock until the next step, so that no viewing time passes."""
        self._last = None

    def close(self) -> None:
        """End the computation under way, because the session has ended."""
        self.flag.set()

    def step(self, periods_per_second: float) -> LiveStep:
        """Advance by the viewing time since the last step; in slow motion, wait for the next sample.

        Viewing time that a step cannot cover is dropped: time beyond `_LONGEST_STEP`, and time that would take longer
        to compute than `_LONGEST_COMPUTING`. The run is then slower than the chosen speed, but never lags behind its
        knobs.
        """
        rate = periods_per_second * self.samples
        now = time.perf_counter()
        elapsed = _FIRST_STEP if self._last is None else min(now - self._last, _LONGEST_STEP)
        self._samples_due = min(self._samples_due, 1.0) + elapsed * rate
        if self._samples_due < 1.0:
            with self.flag.released():
                time.sleep((1.0 - self._samples_due) / rate)
            self._samples_due = 1.0
        self._last = time.perf_counter()
        return self.advance(min(int(self._samples_due), self._most_samples))

    def window_run(self) -> Run | None:
        """Return the periods on the screen as one run, to be saved."""
        return joined(list(self._runs)) if self._runs else None

    def advance(self, samples: int) -> LiveStep:
        """Advance by `samples`, and return the step with the new window."""
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
            self._samples_shown = 0
        self._samples_due = max(0.0, self._samples_due - samples)
        began = time.thread_time()
        run = chain.advance(samples)
        self._most_samples = max(1, int(samples * _LONGEST_COMPUTING / max(time.thread_time() - began, 1e-6)))
        self._samples_shown += samples
        self._remember(run)
        return LiveStep(self._window.add(run), run, self._samples_shown / self.samples)

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
