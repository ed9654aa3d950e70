"""The pace of a live run: the samples computed per step, and the viewing time dropped."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from app.serve.computing.cpu_time import CpuTime
from app.session import live as live_module
from app.session.live import _LONGEST_COMPUTING, _LONGEST_STEP, LiveRun
from granchain_core import LiveChain, Run, scene


class Clock:
    """A clock that only the test advances; each sample of the chain takes `cost` seconds to compute."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, cost: float = 0.0) -> None:
        self.now = self.computed = 100.0
        self.slept: list[float] = []
        self.samples: list[int] = []
        monkeypatch.setattr(live_module, "time", SimpleNamespace(
            perf_counter=lambda: self.now, thread_time=lambda: self.computed, sleep=self.sleep))

        def advance(chain: LiveChain, samples: int, _is: object = LiveChain.advance) -> Run:
            self.samples.append(samples)
            self.computed += samples * cost
            return _is(chain, samples)  # type: ignore[operator]

        monkeypatch.setattr(LiveChain, "advance", advance)

    def sleep(self, seconds: float) -> None:
        """Advance the clock."""
        self.slept.append(seconds)
        self.now += seconds


def short_run() -> LiveRun:
    """Return a live run of a chain of two beads."""
    return LiveRun(scene("sec2").evolve(N=2), CpuTime())


def test_viewing_time_that_a_step_cannot_make_up_for_is_dropped(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, run = Clock(monkeypatch), short_run()
    run.step(1.0)
    clock.now += 10.0
    run.step(1.0)
    most = _LONGEST_STEP * run.samples
    assert most <= clock.samples[1] + 1 and clock.samples[1] <= most + 1
    clock.now += 0.05
    run.step(1.0)
    assert clock.samples[2] <= 0.05 * run.samples + 1  # nothing of the ten seconds is made up for later


def test_no_viewing_time_passes_while_the_clock_is_held(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, run = Clock(monkeypatch), short_run()
    run.step(1.0)
    run.hold()
    clock.now += 10.0
    run.step(1.0)
    assert clock.samples[1] <= clock.samples[0] + 1


def test_a_chain_that_computes_slowly_takes_fewer_samples_and_owes_none(monkeypatch: pytest.MonkeyPatch) -> None:
    cost = 0.02
    clock, run = Clock(monkeypatch, cost), short_run()
    for _ in range(6):
        run.step(1.0)
        clock.now += 1.0
    most = round(_LONGEST_COMPUTING / cost)
    assert _LONGEST_STEP * run.samples > most
    assert set(clock.samples[1:]) <= {most - 1, most} and not clock.slept
    assert run._samples_due <= 1.0 + _LONGEST_STEP * run.samples - (most - 1)


def test_slow_motion_waits_for_the_next_sample(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, run = Clock(monkeypatch), short_run()
    for _ in range(3):
        run.step(0.05)
    assert clock.samples == [1, 1, 1] and len(clock.slept) == 3
    assert clock.slept[1] == pytest.approx(1.0 / (0.05 * run.samples))
