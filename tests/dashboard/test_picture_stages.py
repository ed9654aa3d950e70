"""The stages of a picture's time, from the request to the screen."""

from __future__ import annotations

import logging
from types import SimpleNamespace

import pytest
from headless_dashboard import Dashboard

from app.serve.monitoring import picture_stages
from app.serve.monitoring.metrics import METRICS, STAGES, Metrics
from app.serve.monitoring.picture_stages import PictureStages
from granchain_core import scene


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The clock that stages read [s]."""
    now = [100.0]
    monkeypatch.setattr(picture_stages, "time", SimpleNamespace(monotonic=lambda: now[0]))
    return now


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, float]]:
    """The stages of every picture that was painted."""
    pictures: list[dict[str, float]] = []
    monkeypatch.setattr(METRICS, "picture_painted", lambda seconds: pictures.append(dict(seconds)))
    return pictures


def after(clock: list[float], stages: PictureStages, **seconds: float) -> None:
    """End each stage after this many seconds."""
    for stage, duration in seconds.items():
        clock[0] += duration
        stages.end(stage)


def test_the_stages_of_a_picture_add_up_to_its_time(clock: list[float], counted: list[dict[str, float]]) -> None:
    stages = PictureStages()
    after(clock, stages, turn=0.125, kernels=0.5)
    stages.turn_wait = 0.25
    clock[0] += 1.0
    stages.computed()
    after(clock, stages, prepare=0.0625, loop=0.125, pace=0.25)
    clock[0] += 0.5
    stages.painted(125.0)
    assert counted == [{"turn": 0.375, "kernels": 0.5, "compute": 0.75, "prepare": 0.0625, "loop": 0.125, "pace": 0.25,
                        "travel": 0.375, "paint": 0.125}]
    assert set(counted[0]) == set(STAGES) and sum(counted[0].values()) == clock[0] - 100.0


@pytest.mark.parametrize(("took", "paint"), [
    (None, None), ("12", None), (True, None), (float("nan"), None), (float("inf"), None), (-5.0, 0.0), (1e30, 0.5), (250, 0.25)])
def test_the_time_that_a_browser_states_is_not_trusted(took: object, paint: float | None, clock: list[float],
                                                       counted: list[dict[str, float]]) -> None:
    stages = PictureStages()
    clock[0] += 0.5
    stages.painted(took)
    assert counted[0].get("paint") == paint and sum(counted[0].values()) == 0.5


def test_the_log_says_of_a_slow_picture_which_stage_took_longest(clock: list[float], counted: list[dict[str, float]],
                                                                 caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "granchain")
    for wait in (0.5, 1.25):
        stages = PictureStages()
        after(clock, stages, turn=wait, compute=0.25)
        stages.painted(None)
    assert [record.getMessage() for record in caplog.records] == ["a picture took 1.50 s: turn 1.25 s, compute 0.25 s"]


def test_metrics_have_a_histogram_of_each_stage() -> None:
    metrics = Metrics()
    metrics.picture_painted({"turn": 0.03, "paint": 20.0})
    text = metrics.text()
    assert 'granchain_picture_stage_seconds_bucket{stage="turn",le="0.025"} 0\n' in text
    assert 'granchain_picture_stage_seconds_bucket{stage="turn",le="0.05"} 1\n' in text
    assert 'granchain_picture_stage_seconds_sum{stage="paint"} 20\n' in text
    assert {f'granchain_picture_stage_seconds_count{{stage="{stage}"}}' for stage in STAGES} <= {
        line.rpartition(" ")[0] for line in text.splitlines()}


def test_a_picture_on_the_screen_has_all_stages_and_is_counted_once(dashboard: Dashboard,
                                                                    counted: list[dict[str, float]]) -> None:
    session, pictures = dashboard.session, dashboard.pictures
    session.scene = scene("sec2").evolve(N=2, f=2000.0)
    pictures.compute()
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    assert counted == [], "no picture is on the screen"
    for _ in range(2):
        dashboard.receive({"do": "painted", "number": 1, "took": 0.0})
    (stages,) = counted
    assert set(stages) == set(STAGES) and min(stages.values()) >= 0.0


def test_only_the_first_step_of_a_live_run_after_a_moved_knob_has_stages(dashboard: Dashboard,
                                                                         counted: list[dict[str, float]]) -> None:
    session, pictures = dashboard.session, dashboard.pictures
    session.set_mode("live")
    session.playing = False
    pictures.begin_live()
    session.change("f", 2100.0)
    pictures.compute()
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    pictures.advance(3)
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    for number in (1, 2):
        dashboard.receive({"do": "painted", "number": number, "took": 0.0})
    assert [set(stages) for stages in counted] == [set(STAGES)]


def test_a_picture_whose_window_was_hidden_is_not_counted(dashboard: Dashboard, counted: list[dict[str, float]]) -> None:
    """It is painted when the window is shown again, which says nothing about the server."""
    session, pictures = dashboard.session, dashboard.pictures
    session.scene = scene("sec2").evolve(N=2, f=2000.0)
    pictures.compute()
    dashboard.run_callbacks_until(lambda: not (pictures.busy or dashboard.callbacks))
    dashboard.receive({"do": "window-shown"})
    dashboard.receive({"do": "painted", "number": 1, "took": 0.0})
    assert counted == []
