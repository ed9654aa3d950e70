"""Counts from many threads, and how long computations wait before they begin."""

from __future__ import annotations

import threading

from app.serve.computing.cpu_time import CpuTime
from app.serve.computing.turns import FairScheduler
from app.serve.monitoring.metrics import Metrics
from granchain_core import Stop


def test_every_count_of_every_thread_is_kept() -> None:
    metrics = Metrics()
    threads = [threading.Thread(target=lambda: [metrics.count("cancelled") for _ in range(1000)]) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert metrics.cancelled == 8000 and "granchain_cancelled_total 8000\n" in metrics.text()


def test_the_wait_before_computations_begin_is_averaged_over_ten_seconds() -> None:
    now = [0.0]
    turns = FairScheduler(1, lambda: now[0])
    assert turns.wait == 0.0
    first = turns.begin(CpuTime(), Stop())
    now[0] = 1.0
    turns.end(first)
    turns.begin(CpuTime(), Stop(), is_new=False)  # what makes a picture better may wait
    assert turns.wait == 0.0
    turns._waits.append((now[0], 1.5))
    assert turns.wait == 0.75
    now[0] = 10.5
    assert turns.wait == 1.5
    now[0] = 12.0
    assert turns.wait == 0.0
