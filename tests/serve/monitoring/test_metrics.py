"""Counts from many threads, and how long computations wait before they begin."""

from __future__ import annotations

import re
import threading

from app import server
from app.serve.computing.cpu_time import CpuTime
from app.serve.computing.queues import LONG, QUEUES
from app.serve.computing.turns import TURNS, FairScheduler
from app.serve.monitoring.metrics import METRICS, Metrics
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


def shown(name: str) -> float:
    """A number of `/metrics`."""
    server._count_what_is_shared()
    found = re.search(rf"^granchain_{re.escape(name)} (\S+)$", METRICS.text(), re.MULTILINE)
    assert found is not None
    return float(found[1])


def test_each_queue_has_its_own_gauges() -> None:
    for queue in QUEUES:
        assert shown(f'queue_busy{{queue="{queue.name}"}}') == queue.busy_threads
        assert shown(f'queue_waiting{{queue="{queue.name}"}}') == queue.waiting + queue.held


def test_long_work_counts_as_computing_and_what_its_owner_has_beyond_a_share_as_waiting() -> None:
    go_on, owner = threading.Event(), object()
    waiting, computing = shown("queue"), shown("computing")
    ended = [LONG.submit(go_on.wait, 120, owner=owner) for _ in range(3)]
    assert (shown("queue") - waiting, shown("computing") - computing) == (1, 2)
    go_on.set()
    assert all(one.result(20) for one in ended)


def test_a_computation_that_waits_for_a_turn_does_not_count_as_computing() -> None:
    computing, waiting = shown("computing"), shown("queue")
    held = [TURNS.begin(CpuTime(), Stop(), is_new=False) for _ in range(TURNS._at_once)]
    stop = Stop()
    thread = threading.Thread(target=TURNS.begin, args=(CpuTime(), stop, False))
    try:
        with TURNS._lock:  # no check may grant a turn before the numbers are read
            now = TURNS._clock()
            for turn in held:
                turn.at = now + 60.0
        thread.start()
        while not TURNS.waiting:
            thread.join(0.001)
        assert (shown("computing") - computing, shown("queue") - waiting, shown("turns_waiting")) == (len(held), 1, 1)
    finally:
        for turn in held:
            TURNS.end(turn)
        thread.join(20)
