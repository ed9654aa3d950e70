"""Pictures of fits: the data in front of the model, residuals, and a landscape for every parameter."""

from __future__ import annotations

import numpy as np
import pytest
from bokeh.models import ColumnDataSource, LayoutDOM
from bokeh.plotting import figure

from app.plots.fit import fit as drawn
from app.plots.theme import THEMES
from granchain_core import fit, scene
from granchain_core.experiment import Feature
from granchain_core.fitting import CurveTarget, FeatureTarget, Free, SeriesTarget, virtual_curve, virtual_series

CHAIN = scene("sec2").evolve(N=2, f=2000.0)
DAMPING = [Free("D", 60.0, 200.0)]


def plots(picture: LayoutDOM) -> dict[str, figure]:
    """Return the figures by name."""
    return {one.name: one for one in picture.select({"type": figure})}


def source(plot: figure, name: str) -> dict[str, object]:
    """Return the data of a source."""
    (found,) = [one.data for one in plot.select({"type": ColumnDataSource}) if one.name == name]
    return found


def test_a_curve_with_its_residuals_and_its_landscape() -> None:
    measured = virtual_curve(CHAIN, [1800.0, 2000.0, 2200.0], 0.02, np.random.default_rng(1))
    found = fit(CHAIN, CurveTarget(measured), DAMPING, initial_points=4)
    shown = plots(drawn(found, THEMES["dark"]))
    assert set(shown) == {"data", "residuals", "landscape of D"}
    assert list(source(shown["data"], "measured")["frequency"]) == [1800.0, 2000.0, 2200.0]
    assert "virtual experiment" in [item.label.value for item in shown["data"].legend[0].items]
    assert source(shown["residuals"], "residuals")["residual"] == pytest.approx(found.evaluation.residuals)
    assert "95 %" in shown["landscape of D"].title.text and "degrees of freedom" in shown["data"].title.text
    squares = [glyph for glyph in shown["data"].renderers if getattr(getattr(glyph, "glyph", None), "marker", "") == "square"]
    assert squares and squares[-1].glyph.fill_color is None and squares[-1].level == "overlay"


def test_a_series_shows_both_forces() -> None:
    series = virtual_series(CHAIN, 4, 32, 0.05, np.random.default_rng(1))
    found = fit(CHAIN, SeriesTarget(series, 0.05), DAMPING, initial_points=4, intervals=False)
    shown = plots(drawn(found, THEMES["light"]))
    assert [item.label.value for item in shown["data"].legend[0].items] == ["input force", "output force"]


def test_features_are_drawn_beside_those_of_the_model() -> None:
    found = fit(CHAIN, FeatureTarget([Feature(1500.0, "1:1 resonance", 1, "")], np.linspace(800.0, 2400.0, 9), 50.0), DAMPING,
                initial_points=2, intervals=False)
    shown = plots(drawn(found, THEMES["projector"]))
    assert "stated" in shown["data"].title.text and "D =" in shown["landscape of D"].title.text
