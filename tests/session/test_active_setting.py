"""The setting that the page shows, and its place among the measured rows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.session.active_setting import locate, shown_setting
from granchain_core import scene, settle
from granchain_core.accuracy import Row
from granchain_core.integrate import METHODS, MethodSetting
from granchain_core.steady.settling import advance, recording, refine_orbit


@pytest.mark.parametrize("accuracy", [1e-4, 1e-6, 1e-9])
def test_the_setting_shown_is_at_most_two_refinements_coarser_than_the_one_that_computes(accuracy: float, monkeypatch: pytest.MonkeyPatch) -> None:
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
    setting = shown_setting(shown, picture, live=False)
    same = [computed for computed in used if computed.method == picture.run.cost.method]
    assert setting.method == picture.run.cost.method
    # if the relaxation had to refine, once in the tolerance or twice in the step, the finest setting used is finer
    if METHODS[setting.method].error_control:
        finest = min(computed.tolerance for computed in same)
        assert finest * (1 - 1e-9) <= setting.tolerance <= 64.0 * finest
    else:
        most = max(computed.refine for computed in same)
        assert most / 4.0 <= setting.refine <= most * (1 + 1e-9)


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
