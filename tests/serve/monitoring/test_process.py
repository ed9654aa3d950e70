"""Numbers about the process, and their replacements on a system without /proc."""

from __future__ import annotations

import _thread
import math
import os
import re
import sys
import threading
import time
from pathlib import Path

import pytest

from app.serve.monitoring import process
from app.serve.monitoring.metrics import Metrics

linux = pytest.mark.skipif(sys.platform != "linux", reason="there is no /proc")


def shown(name: str) -> float:
    """Return a number from `/metrics`."""
    (found,) = re.findall(rf"^{name} (\S+)$", Metrics().text(), re.MULTILINE)
    return float(found)


@linux
def test_threads_started_outside_python_are_counted() -> None:
    """For example, those of numerical libraries: any program's Prometheus client counts them."""
    before, held = shown("process_threads") - shown("granchain_threads"), _thread.allocate_lock()
    held.acquire()
    _thread.start_new_thread(held.acquire, ())
    try:
        assert shown("process_threads") - shown("granchain_threads") == before + 1
        assert shown("granchain_threads") == threading.active_count()
    finally:
        held.release()


@linux
def test_an_open_file_counts(tmp_path: Path) -> None:
    before = shown("process_open_fds")
    with (tmp_path / "file").open("w"):
        assert shown("process_open_fds") == before + 1
    assert before < shown("process_max_fds")


def test_the_process_began_before_now_and_its_time_passes() -> None:
    began, used = process.start_time(), process.cpu_seconds()
    assert 0.0 < time.time() - began < 86400.0
    assert math.isclose(shown("process_start_time_seconds"), began)
    sum(range(1_000_000))
    assert shown("process_cpu_seconds_total") > used


def test_without_proc_there_are_the_nearest_numbers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    began = process.start_time()
    for name in ("_PROCESS", "_MACHINE", "_DESCRIPTORS"):
        monkeypatch.setattr(process, name, tmp_path / "nothing")
    assert process.os_threads() == threading.active_count()
    assert began <= process.start_time() <= time.time()
    assert process.resident_memory() > 1e6
    assert math.isnan(process.open_descriptors()) and math.isnan(shown("process_open_fds"))
    monkeypatch.setattr(process, "_DESCRIPTORS", Path("/dev/fd"))
    assert os.path.isdir("/dev/fd") == (process.open_descriptors() > 0.0)
