"""Counts from many threads, and the time that computations wait before they start."""

from __future__ import annotations

import re
import threading
from pathlib import Path

import pytest
import waiting

from app import former_names, server
from app.serve.computing.cpu_time import CpuTime
from app.serve.computing.turns import Turns
from app.serve.computing.worker_pools import (
    COMPILATIONS,
    COMPUTING,
    CURVES,
    FILES,
    LOADING,
    PICTURES,
    POOLS,
    SESSION_WORK,
    WorkerPool,
)
from app.serve.monitoring.metrics import COUNTERS, METRICS, Metric, Metrics
from granchain_core import Stop, __version__

ROOT = Path(__file__).parents[3]


def test_every_count_of_every_thread_is_kept() -> None:
    metrics = Metrics()
    threads = [threading.Thread(target=lambda: [metrics.count("cancelled") for _ in range(1000)]) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert metrics.counted["cancelled"] == 8000 and "granchain_cancelled_total 8000\n" in metrics.text()


@pytest.mark.parametrize(("value", "written"), [
    (0, "0"), (1_234_567, "1234567"), (2**53 + 1, str(2**53 + 1)), (123_456_789.0, "123456789"), (0.1, "0.1"),
    (1234.5678901, "1234.5678901"), (float("inf"), "+Inf"), (float("nan"), "NaN")])
def test_numbers_are_written_with_all_digits(value: float, written: str) -> None:
    """A counter rounded to six digits would stand still, then jump."""
    metrics = Metrics()
    metrics.counted["pictures"] = value  # type: ignore[assignment]
    metrics.added = (Metric("memory", "gauge", "Memory.", lambda: {"a": value}, "of"),)
    assert f"\ngranchain_pictures_total {written}\n" in metrics.text() and f'\ngranchain_memory{{of="a"}} {written}\n' in metrics.text()


def test_every_counter_that_is_counted_is_in_the_table_and_every_one_in_the_table_is_counted() -> None:
    """For any other counter, `count` would fail, and in the middle of handling a failure."""
    sources = [path.read_text(encoding="utf-8") for path in (ROOT / "app").rglob("*.py")]
    assert {name for text in sources for name in re.findall(r"METRICS\.count\(([^)]*)\)", text)} == {f'"{name}"' for name in COUNTERS}


def test_names_and_kinds_are_those_of_prometheus() -> None:
    server.add_shared_metrics()
    table = METRICS.table()
    assert len({metric.full_name for metric in table}) == len(table)
    for metric in table:
        assert re.fullmatch("[a-z_]+", metric.name) and metric.help.endswith("."), metric
        assert metric.name.endswith("_total") == (metric.kind == "counter"), metric
        assert isinstance(metric.read(), dict) == bool(metric.label), metric


def waits_beside_another(turns: Turns, now: list[float], seconds: float, is_new: bool = True) -> None:
    """Give one computation a turn at once, and another after it has waited this long."""
    first = turns.begin(CpuTime(), Stop())
    thread = threading.Thread(target=turns.begin, args=(CpuTime(), Stop(), is_new))
    thread.start()
    waiting.until(lambda: turns.waiting == 1, 20)
    now[0] += seconds
    turns.end(first)
    thread.join(20)
    assert not thread.is_alive()


def test_the_wait_before_computations_begin_is_averaged_over_ten_seconds() -> None:
    now = [0.0]
    turns = Turns(1, lambda: now[0])
    assert turns.wait == 0.0
    waits_beside_another(turns, now, 1.5)
    assert turns.wait == 0.75  # the other did not wait
    now[0] = 10.5
    assert turns.wait == 1.5
    now[0] = 12.0
    assert turns.wait == 0.0


def test_the_wait_of_a_refinement_is_not_counted() -> None:
    now = [0.0]
    turns = Turns(1, lambda: now[0])
    waits_beside_another(turns, now, 1.5, is_new=False)
    assert turns.wait == 0.0


def test_the_largest_stall_is_reported_beside_the_mean() -> None:
    metrics = Metrics()
    for lag in (*(0.0 for _ in range(39)), 5.0):
        metrics.lagged(lag)
    assert metrics.event_loop_lag < 0.3 and metrics.busy
    assert "\ngranchain_event_loop_lag_max_seconds 5\n" in metrics.text()
    for _ in range(40):
        metrics.lagged(0.2)
    assert not metrics.busy


def shown(name: str) -> float:
    """Return a number from `/metrics`."""
    server.add_shared_metrics()
    found = re.search(rf"^granchain_{re.escape(name)} (\S+)$", METRICS.text(), re.MULTILINE)
    assert found is not None
    return float(found[1])


def test_each_pool_has_its_own_gauges() -> None:
    for pool in POOLS:
        assert shown(f'pool_busy_threads{{pool="{pool.name}"}}') >= 0.0
        assert shown(f'pool_queued{{pool="{pool.name}"}}') >= 0.0


def test_the_release_that_answers_is_named() -> None:
    assert shown(f'build_info{{version="{__version__}"}}') == 1.0


def test_renamed_metrics_keep_their_former_names_too() -> None:
    server.add_shared_metrics()
    names = {metric.full_name for metric in METRICS.table()}
    assert {row.name for row in former_names.METRICS} <= names and not names & {row.former for row in former_names.METRICS}
    text = METRICS.text()
    for row in former_names.METRICS:
        if not row.label:
            found = [re.search(rf"^{one} (\S+)$", text, re.MULTILINE) for one in (row.name, row.former)]
            assert found[0] is not None and found[1] is not None and found[0][1] == found[1][1], row.former
    for pool in POOLS:
        name = "visitors" if pool is SESSION_WORK else pool.name
        assert f'\ngranchain_queue_busy{{queue="{name}"}} ' in text and f'\ngranchain_queue_waiting{{queue="{name}"}} ' in text


def test_pools_whose_threads_wait_for_others_do_not_count_as_computing() -> None:
    """Threads of PICTURES and SESSION_WORK wait for turns, those of CURVES for CURVE_WORK."""
    assert set(POOLS) - set(COMPUTING) == {SESSION_WORK, PICTURES, CURVES, FILES, LOADING, COMPILATIONS}


def test_long_work_counts_as_computing_and_work_beyond_a_limit_as_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    pool, go_on, owner = WorkerPool("long", 8, per_owner_limit=2), threading.Event(), object()
    for name, value in (("POOLS", (pool,)), ("COMPUTING", (pool,)), ("TURNS", Turns(2))):
        monkeypatch.setattr(server, name, value)
    ended = [pool.submit(go_on.wait, 120, owner=owner) for _ in range(3)]
    assert (shown("computing"), shown("queue")) == (2, 1)
    assert (shown('pool_busy_threads{pool="long"}'), shown('pool_queued{pool="long"}')) == (2, 1)
    assert (shown('queue_busy{queue="long"}'), shown('queue_waiting{queue="long"}')) == (2, 1)
    go_on.set()
    assert all(one.result(20) for one in ended)


def test_a_picture_that_waits_for_a_turn_waits_and_is_not_computing(monkeypatch: pytest.MonkeyPatch) -> None:
    turns, pool, stop = Turns(2, lambda: 0.0), WorkerPool("pictures", 8), Stop()
    for name, value in (("POOLS", (pool,)), ("COMPUTING", ()), ("TURNS", turns)):
        monkeypatch.setattr(server, name, value)
    for _ in range(2):
        turns.begin(CpuTime(), Stop(), is_new=False)
    third = pool.submit(turns.begin, CpuTime(), stop, False)
    waiting.until(lambda: turns.waiting == 1, 20)
    assert (shown("computing"), shown("queue"), shown("turns_waiting")) == (2, 1, 1)
    assert shown('pool_busy_threads{pool="pictures"}') == 1
    stop.set()
    turns.stopped(stop)
    assert third.result(20)
