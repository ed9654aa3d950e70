"""The figure of a hard case: axes, lines, gaps and marks."""

from __future__ import annotations

import numpy as np
import pytest
from bokeh.models import GlyphRenderer, Legend, LogScale

from app.plots.check import check
from app.plots.theme import THEMES
from app.plots.themed import apply_theme
from granchain_core.hard_cases import Picture, Trace

LIGHT = THEMES["light"]


def lines(plot: object) -> dict[str, GlyphRenderer]:
    """Return the lines by their labels."""
    return {one.name: one for one in plot.renderers if one.name}  # type: ignore[attr-defined]


def test_a_trace_keeps_its_gap_and_one_that_breaks_off_has_a_cross_there() -> None:
    plot = check(Picture(np.arange(3), "drive periods", "force in N", (
        Trace("granchain", np.array([1.0, np.nan, 3.0])), Trace("naive", np.array([1.0, 2.5, np.nan])))), LIGHT)
    data = lines(plot)["granchain"].data_source.data
    np.testing.assert_array_equal(data["x"], [0, 1, 2])
    np.testing.assert_array_equal(data["0"], np.array([1, np.nan, 3], dtype=np.float32))
    (cross,) = [one for one in plot.renderers if getattr(one.glyph, "marker", "") == "x"]
    assert cross.data_source.data == {"x": [1.0], "y": [2.5]}
    assert plot.title.text == "force in N" and plot.xaxis[0].axis_label == "drive periods"
    assert [item.label.value for item in plot.select_one(Legend).items] == ["granchain", "naive"]


def test_a_logarithm_is_drawn_as_the_number_it_is_of() -> None:
    plot = check(Picture(np.array([0.0, 1.0]), "steps, log10", "error, log10", (
        Trace("granchain", np.array([-8.0, -12.0])),)), LIGHT)
    assert isinstance(plot.x_scale, LogScale) and isinstance(plot.y_scale, LogScale)
    assert (plot.xaxis[0].axis_label, plot.title.text) == ("steps", "error")
    data = lines(plot)["granchain"].data_source.data
    np.testing.assert_allclose(data["x"], [1.0, 10.0])
    np.testing.assert_allclose(data["0"], [1e-8, 1e-12])


@pytest.mark.parametrize("name", THEMES)
def test_a_theme_is_the_same_whether_drawn_in_it_or_applied_later(name: str) -> None:
    picture = Picture(np.arange(3), "t", "F", tuple(
        Trace(label, np.arange(3.0)) for label in ("true", "granchain", "granchain, coarse", "Euler", "leapfrog")))

    def seen(plot: object) -> list[object]:
        return [(one.glyph.line_color, one.glyph.line_width, tuple(one.glyph.line_dash)) for one in lines(plot).values()]

    theme = THEMES[name]
    drawn = seen(check(picture, theme))
    assert drawn == seen(apply_theme(check(picture, LIGHT), theme))
    assert len(set(drawn)) == 5
    assert drawn[1][0] == theme.ink and drawn[1][1] == 2.6 * theme.line_scale  # type: ignore[index]
