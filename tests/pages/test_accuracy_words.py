"""The text of the Accuracy page, without a browser: the current setting, its place among the rows, and the wording."""

from __future__ import annotations

import importlib
import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.format import duration, short_error
from app.pages.accuracy.page import measured_for
from app.pages.accuracy.view import described_methods, described_reference, described_rows, naive_message
from app.plots.theme import THEMES
from app.session.active_setting import locate, shown_setting
from granchain_core import scene, settle
from granchain_core.accuracy import Row, WorkPrecision, compared_methods
from granchain_core.accuracy.naive import naive_comparison
from granchain_core.execution.stop import Stop
from granchain_core.integrate import METHODS, MethodSetting
from granchain_core.steady.settling import advance, recording, refine_orbit


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-9])
def test_the_setting_that_is_told_is_the_one_that_computes(accuracy: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The rule in app/session/active_setting.py agrees with steady/settling/refine_orbit.py: the finest engine of a
    final picture.
    """
    used: list[MethodSetting] = []
    engine = recording.Engine

    def noting(shown: Any, setting: MethodSetting, *rest: Any, **options: Any) -> Any:
        used.append(setting)
        return engine(shown, setting, *rest, **options)

    for module in (advance, refine_orbit, recording):
        monkeypatch.setattr(module, "Engine", noting)
    shown = scene("sec2").evolve(accuracy=accuracy)
    picture = settle(shown)
    told = shown_setting(shown, picture, live=False)
    same = [one for one in used if one.method == picture.run.cost.method]
    assert told.method == picture.run.cost.method
    # if the relaxation had to refine, the real setting is finer by powers of eight, or of two in the step
    if METHODS[told.method].error_control:
        finest = min(one.tolerance for one in same)
        assert finest * (1 - 1e-9) <= told.tolerance <= 64.0 * finest
    else:
        most = max(one.refine for one in same)
        assert most / 4.0 <= told.refine <= most * (1 + 1e-9)


def test_live_and_irregular_pictures_have_the_live_method() -> None:
    shown = scene("sec2")
    assert shown_setting(shown, None, live=True) == MethodSetting("rk4-split", refine=2)


def test_a_setting_between_two_rows_is_found_between_them() -> None:
    rows = [Row("dop853", "", 1e-4, 0.001, 1, value=1e-4), Row("dop853", "", 1e-8, 0.003, 1, value=1e-8),
            Row("dop853", "", float("inf"), 0.0, 0, value=1e-10, failure="no")]
    now = locate(MethodSetting("dop853", tolerance=1e-6), rows)
    assert now is not None
    assert now.error == pytest.approx(1e-6) and now.wall_s == pytest.approx(np.sqrt(3e-6))
    assert locate(MethodSetting("rk4"), rows) is None


def test_a_measurement_belongs_to_all_knobs_but_the_accuracy() -> None:
    shown = scene("sec2")
    assert measured_for(shown) == measured_for(shown.evolve(accuracy=1e-9))
    for change in ({"f": 341.0}, {"D": 99.0}, {"k": 1.0}, {"N": 12}, {"tension": "cut"}, {"wall": "rigid"}):
        assert measured_for(shown) != measured_for(shown.evolve(**change))


def test_every_compared_method_is_described() -> None:
    shown = described_methods()
    assert [one["name"] for one in shown] == list(compared_methods())
    for one in shown:
        assert one["title"] and one["order"] and one["restrictions"] and one["reference"]


def test_failed_rows_keep_their_sentence_and_are_json() -> None:
    rows = [Row("rk4", "1 × the default steps", float("inf"), 0.0, 0, 1.0, "It was not done."),
            Row("dop853", "tolerance 1e-6", float("nan"), 0.1, 5, 1e-6), Row("rk4", "", 1e-5, 0.001, 7, 2.0)]
    shown = json.loads(json.dumps(described_rows(rows), allow_nan=False))
    assert [(one["way"], one["failure"]) for one in shown] == [
        ("rk4", "It was not done."), ("dop853", "Its numbers are not finite.")]


def test_the_reference_is_told_with_its_agreement() -> None:
    found = WorkPrecision(scene("sec2"), "one", "two")
    assert described_reference(found)["agreement_words"] == "The second reference is computed last."
    found.agreement = 7.1e-12
    assert described_reference(found)["agreement_words"] == "Two independent references agree to 7e-12."
    found.agreement = 0.68
    assert "amplifies every error" in described_reference(found)["agreement_words"]
    found.disagreement = "It was not done."
    assert "The second reference failed: It was not done." in described_reference(found)["agreement_words"]


def test_the_forces_are_one_array_in_which_failures_have_no_row() -> None:
    found = naive_comparison(scene("rig"), Stop())
    message = naive_message(found, THEMES["light"])
    rows = message["values"].reshape(-1, message["columns"])
    assert message["values"].dtype == np.float32
    for told, one in zip(message["drawn"], found.lines, strict=True):
        assert (told["row"] < 0) == bool(one.failure)
        if told["row"] > 0:
            assert rows[told["row"]].max() == pytest.approx(one.force.max() / (found.force.max() / rows[1].max()), rel=1e-5)


@pytest.mark.parametrize(("value", "words"), [(1e-6, "1e-6"), (3.16e-7, "3e-7"), (1e-10, "1e-10"), (0.1, "1e-1")])
def test_errors_have_one_figure(value: float, words: str) -> None:
    assert short_error(value) == words


@pytest.mark.parametrize(("value", "words"), [(0.0021, "2.1 ms"), (1.234, "1.23 s"), (4.2e-4, "420 µs"), (0.5, "500 ms")])
def test_durations_have_three_figures(value: float, words: str) -> None:
    assert duration(value) == words


def test_what_a_method_costs_is_the_time_of_its_own_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    """A visitor who computes at the same time does not make a method appear slower."""
    module = importlib.import_module("granchain_core.accuracy.work_precision")
    times = iter((1.0, 1.25))
    monkeypatch.setattr(module.time, "thread_time", lambda: next(times))
    monkeypatch.setattr(module, "Engine", lambda *_, **__: SimpleNamespace(
        record=lambda rows: SimpleNamespace(displacement=np.zeros((rows, 1))), counts=SimpleNamespace(rhs=5)))
    assert module._ours(scene("sec2"), MethodSetting("rk4"), Stop()).seconds == 0.25
