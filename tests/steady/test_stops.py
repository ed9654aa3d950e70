"""A stop set by another thread ends the computation of steady states at any point."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest
from waiting import until

from granchain_core import CurvePoint, iter_curve, scene
from granchain_core.errors import Cancelled
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine
from granchain_core.steady.batch import jobs_in_batch
from granchain_core.steady.batch.job import LocatedOrbits
from granchain_core.steady.batch.jobs_in_batch import batch_results
from granchain_core.steady.settling import advance


@pytest.mark.parametrize("start", ["up", "down"])
def test_a_stop_ends_a_carried_point_that_would_run_for_ever(start: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With a drive period of ten seconds and no limit of steps, one point takes hours.

    It is given up without a result.
    """
    monkeypatch.setattr(advance, "MOST_SETTLING_STEPS", 10**15)
    stop, called, points = Stop(), list[tuple[Engine, np.ndarray]](), list[CurvePoint]()
    real = Engine.periods

    def periods(engine: Engine, count: int, watch: bool = True) -> tuple[np.ndarray, np.ndarray]:
        called.append((engine, engine.y.copy()))
        return real(engine, count, watch)

    monkeypatch.setattr(Engine, "periods", periods)
    slow = scene("sec2").evolve(N=11)
    work = threading.Thread(target=lambda: points.extend(iter_curve(slow, [0.1, 0.11], start, stop)), daemon=True)
    work.start()
    until(lambda: called and (called[-1][0].y != called[-1][1]).any())  # the kernel is inside its first period
    stop.set()
    work.join(60.0)
    assert not work.is_alive()
    assert points == []


def test_a_stop_between_carried_points_leaves_those_that_are_done() -> None:
    stop, points = Stop(), []
    for point in iter_curve(scene("sec2").evolve(N=2), [1800.0, 2000.0, 2200.0], "up", stop):
        points.append(point.frequency)
        if len(points) == 2:
            stop.set()
    assert points == [1800.0, 2000.0]


def test_a_stop_reaches_the_located_jumps_of_a_batch(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is set when the orbit with located events begins, the last computation of a point whose force jumps."""
    stop, located = Stop(), []

    class Stopped(LocatedOrbits):
        def maxima(self, *words: Any) -> Any:
            located.append(True)
            stop.set()
            return super().maxima(*words)

    monkeypatch.setattr(jobs_in_batch, "LocatedOrbits", Stopped)
    with pytest.raises(Cancelled):
        list(batch_results(iter([scene("sec2").evolve(D=300.0, f=100.0)]), stop))
    assert located == [True]
