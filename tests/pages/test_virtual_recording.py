"""Virtual experiments that the data tab records of the present scene."""

from __future__ import annotations

import threading
from functools import partial
from typing import Any

import pytest
from data_tab import FILE, after, sent, show
from headless_dashboard import Dashboard

from app.pages.data import page as module
from app.serve.computing.worker_pools import LONG
from granchain_core import settling


def test_a_virtual_experiment_is_recorded_of_the_present_scene_and_says_so(dashboard: Dashboard) -> None:
    show(dashboard)
    assert "virtual experiment, nothing measured" in after(dashboard, {"do": "measurement-virtual"}, "understood")
    dashboard.run_callbacks_until(lambda: "rms" in str(dashboard.views.tabs.state.get("misfit")))


def test_a_virtual_experiment_does_not_delay_files(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    """It settles a chain in a queue where each visitor has a share; two threads read and write everybody's files."""
    threads: dict[str, str] = {}

    def noting(of: str, original: Any, *words: Any, **named: Any) -> Any:
        threads[of] = threading.current_thread().name.split()[0]
        return original(*words, **named)

    for name in ("settling", "read_data"):
        monkeypatch.setattr(module, name, partial(noting, name, getattr(module, name)))
    show(dashboard)
    assert "virtual experiment" in after(dashboard, {"do": "measurement-virtual"}, "understood")
    assert threads == {"settling": "long", "read_data": "files"}


def test_a_virtual_experiment_that_does_not_settle_is_given_up(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "WHOLE_PICTURE", -1.0)
    show(dashboard)
    assert after(dashboard, {"do": "measurement-virtual"}, "understood").endswith("so the virtual experiment was not made.")


def test_a_file_replaces_the_virtual_experiment_under_way(dashboard: Dashboard, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, read = threading.Event(), threading.Event()

    def slow(*words: Any, **named: Any) -> Any:
        begun.set()
        assert read.wait(20)
        return settling(*words, **named)

    monkeypatch.setattr(module, "settling", slow)
    dashboard.receive({"do": "measurement-virtual"})
    assert begun.wait(20)
    assert after(dashboard, sent(FILE), "understood").startswith("mine.csv: ")
    read.set()
    dashboard.run_callbacks_until(lambda: not LONG.busy_threads)
    dashboard.run_callbacks_until(lambda: not dashboard.callbacks)
    assert dashboard.views.tabs.state["understood"].startswith("mine.csv: ")
