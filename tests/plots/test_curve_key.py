"""The figure of a sweep explains its lines and marks, and no two of them look alike."""

from __future__ import annotations

import numpy as np
import pytest
from bokeh.models import Legend, Line

from app.curve.curve_bar import CHOICES
from app.plots.branches import LINES, SPECIAL_STYLES
from app.plots.curve import CURVE_STYLES, KEY, curve
from app.plots.theme import THEMES
from granchain_core import Curve, CurvePoint, scene
from granchain_core.experiment import read_data
from granchain_core.results.forces import ForceErrors
from granchain_core.results.regime import Regime
from granchain_core.scene.state import rest

CHAIN = scene("sec2")
PERIODS = (1, 2, 1, 7)


def swept(start: str) -> Curve:
    """Return a curve with this start and motions of several periods."""
    points = [CurvePoint(100.0 + i, 1.0, 1.0, 1.0, Regime("periodic", period, None, None, 9), ForceErrors(), rest(CHAIN))
              for i, period in enumerate(PERIODS)]
    return Curve(CHAIN, start, points)


def labels(plot: object, name: str) -> list[str]:
    """Return the entries of a legend."""
    (legend,) = [one for one in plot.select({"type": Legend}) if one.name == name]  # type: ignore[attr-defined]
    return [item.label.value for item in legend.items]


@pytest.mark.parametrize("theme", THEMES)
@pytest.mark.parametrize("starts", [("rest",), ("up", "down"), ("down", "up", "rest"), ("up", "up")])
def test_a_picture_explains_each_line_and_mark_once(starts: tuple[str, ...], theme: str) -> None:
    plot = curve([swept(start) for start in starts], THEMES[theme])
    assert labels(plot, "lines") == [f"{style.words}: {style.line_words}" for start, style in CURVE_STYLES.items() if start in starts]
    assert labels(plot, "regimes") == ["period 1", "period 2", "period 5+"]
    assert not any(line.line_dash for line in plot.select({"type": Line}))


def test_a_measurement_stands_beside_the_lines() -> None:
    plot = curve([swept("up")], THEMES["light"], measured=read_data(b"f [Hz],F [N]\n100,1\n101,1\n"))
    assert labels(plot, "lines") == ["sweep up: broad amber line", "measured"]


def test_a_curve_without_a_point_has_no_key() -> None:
    plot = curve([], THEMES["light"])
    assert not list(plot.select({"type": Legend}))


def test_every_start_looks_different_with_and_without_colour() -> None:
    assert len({style.colour for style in CURVE_STYLES.values()}) == len({style.width for style in CURVE_STYLES.values()}) == 3
    assert len({(style["marker"], style["filled"]) for style in SPECIAL_STYLES.values()}) == len(SPECIAL_STYLES)
    assert LINES["stable"][1] == "solid" != LINES["unstable"][1]
    assert all(style.line_words.lower() in KEY.lower() for style in CURVE_STYLES.values())
    assert [(name, label) for name, label, _ in CHOICES[:3]] == [(name, style.label) for name, style in CURVE_STYLES.items()]


def test_hollow_marks_surround_the_filled_ones_of_the_other_sweep() -> None:
    plot = curve([swept("up"), swept("down")], THEMES["light"])
    up, down = (plot.select_one({"name": name}).data["size"] for name in ("up", "down"))
    assert set(np.array(down) - np.array(up)) == {CURVE_STYLES["down"].larger} and CURVE_STYLES["down"].larger > 2
