"""The paper's figures: panels, units, regimes and measured points."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from bokeh.models import ColumnDataSource, GridPlot, LayoutDOM, Plot
from bokeh.plotting import figure as Figure

from app.plots.paper import paper_figure, size_of
from app.plots.paper.panels import fewer
from app.plots.theme import THEMES
from granchain_core.experiment import Measured, Series, Shaker
from granchain_core.paper import FIGURES, Given, Result, computations, compute
from granchain_core.paper.peaks_and_valleys import dips, peaks


@cache
def result(number: str) -> Result:
    """Return the result of a figure without data; for speed, figure 9's four curves have only every fifth point."""
    with pytest.MonkeyPatch.context() as patch:
        if number == "9":
            patch.setattr(computations, "RIG_FREQUENCIES", computations.RIG_FREQUENCIES[::5])
        return compute(number)


def plots(drawn: LayoutDOM) -> list[Figure]:
    """Return all panels of a figure."""
    return [drawn] if isinstance(drawn, Plot) else list(drawn.select({"type": Figure}))


def source(drawn: LayoutDOM, name: str) -> dict[str, Any]:
    """Return the data of the source with this name."""
    (found,) = [one for one in drawn.select({"type": ColumnDataSource}) if one.name == name]
    return dict(found.data)


#: Number of panels of each figure, and words in its axis labels.
EXPECTED = {
    "1": (1, "mm"), "2": (1, "largest elastic output force (N)"), "3": (4, "drive u₀ (µm)"), "3a": (2, "time (ms)"),
    "3b": (2, "input force (N)"), "4": (1, "mm"), "5": (2, "velocity amplitude V0 (mm/s)"), "6": (4, "output force (N)"),
    "7": (6, "input force (N)"), "8": (1, "mm"), "9": (4, "drive frequency f (Hz)"), "10": (6, "time (ms)"),
    "11": (6, "displacement (µm)"), "12": (9, "shaker velocity (mm/s)"),
}


@pytest.mark.parametrize("theme", ["light", "dark"])
@pytest.mark.parametrize("number", FIGURES)
def test_every_figure_has_its_panels_with_units_in_the_themes_colours(number: str, theme: str) -> None:
    drawn = paper_figure(result(number), THEMES[theme])
    panels, words = EXPECTED[number]
    assert len(plots(drawn)) == panels
    labels = [axis.axis_label or "" for plot in plots(drawn) for axis in (*plot.xaxis, *plot.yaxis)]
    assert any(words in label for label in labels)
    assert {plot.background_fill_color for plot in plots(drawn)} == {THEMES[theme].card}
    assert min(size_of(result(number))) >= 400


def test_the_rig_is_to_scale() -> None:
    beads = list(result("4").rows())
    assert np.diff([one["centre_m"] for one in beads]) == pytest.approx(np.full(11, 0.0254))
    plot = plots(paper_figure(result("4"), THEMES["light"]))[0]
    assert plot.match_aspect and "k = 32.4 kN/m" in plot.title.text and "k =" not in plots(
        paper_figure(result("1"), THEMES["light"]))[0].title.text


def test_figure_2_names_peaks_and_dips_with_their_regimes() -> None:
    drawn = paper_figure(result("2"), THEMES["light"])
    assert source(drawn, "peaks")["words"] == ["1:1, 340 Hz", "1:2, 620 Hz", "1:3, 1130 Hz", "1:4, 1580 Hz", "1:5, 1940 Hz"]
    assert source(drawn, "dips")["words"] == ["470 Hz", "870 Hz", "1300 Hz", "1700 Hz, quasi-periodic"]
    curve = result("2").curve  # type: ignore[attr-defined]
    assert source(drawn, "rest")["force"][0] == pytest.approx(curve.points[0].max_output_force_elastic)
    assert len(peaks(curve)) == len(dips(curve)) + 1


def test_figure_3_shows_as_many_pushes_as_the_paper_counts() -> None:
    for number, pushes in (("3a", 4), ("3b", 3)):  # in four periods of 1:1, in nine of 1:3
        force = source(paper_figure(result(number), THEMES["light"]), "input force")["force"]
        strong = np.asarray(force) > 0.7 * np.max(force)
        begins = int(strong[0]) + int((strong[1:] & ~strong[:-1]).sum()) - int(strong[0] and strong[-1])
        assert begins == pushes


def test_figure_6_marks_irregular_motions_and_stated_features() -> None:
    drawn = paper_figure(result("6"), THEMES["light"])
    assert source(drawn, "stated")["words"] == ["60 Hz, 1:1 resonance", "90 Hz, 1:1 anti-resonance", "100 Hz, 1:2 resonance"]
    curve = next(dict(one.data) for one in drawn.select({"type": ColumnDataSource}) if "sentence" in one.data)
    assert "chaotic" in curve["regime"] and all(size > 0 for size in curve["size"])


def test_figure_12_shows_the_contact_and_the_shaker_of_the_same_velocity() -> None:
    drawn = paper_figure(result("12"), THEMES["light"])
    model = max(np.max(one.data["value"]) for one in drawn.select({"type": ColumnDataSource}) if one.name == "model (5)" and
                np.min(one.data["value"]) < -3.0)
    shaker = source(drawn, "a shaker at 100 Hz with 6.5 µm")["value"]
    assert np.max(shaker) == pytest.approx(4.084, abs=1e-3) and model == pytest.approx(4.147, abs=1e-3)
    for column in result("12").columns:  # type: ignore[attr-defined]
        assert set(column.contact) == {0, 1}
        assert column.input_force[column.contact == 0].max() < 1e-9 < column.input_force[column.contact == 1].max()


def test_measured_points_are_drawn_hollow_and_in_front() -> None:
    frequency = np.array([60.0, 90.0])
    shaker = paper_figure(compute("5", Given(shaker=Shaker(frequency, np.array([2e-3, 4e-3]), ""))), THEMES["light"])
    found = [one.data for one in shaker.select({"type": ColumnDataSource}) if one.name == "measured"]
    assert sorted(list(one["y"]) for one in found) == [pytest.approx([2.0, 4.0]), pytest.approx([5.305, 7.074], abs=1e-3)]
    curve = result("2")
    few = Measured(frequency, np.array([0.1, 0.2]), np.array([0.01, 0.01]), "")
    with_data = type(curve)(curve.curve, few)  # type: ignore[attr-defined,call-arg]
    drawn = paper_figure(with_data, THEMES["light"])
    assert list(source(drawn, "measured")["high"]) == pytest.approx([0.11, 0.21])
    assert drawn.y_range.end > 1.2
    far = Measured(frequency, np.array([0.1, 9.0]), None, "")
    high = paper_figure(type(curve)(curve.curve, far), THEMES["light"])  # type: ignore[attr-defined,call-arg]
    assert high.y_range.end > 9.0  # measured points must not be outside
    drawings = {type(one.glyph).__name__: one for one in drawn.renderers if one.data_source.name == "measured"}
    assert drawings["Segment"].glyph.line_color == THEMES["light"].ink
    dots = drawings["Scatter"]
    assert dots.glyph.fill_color is None and dots.level == "overlay"


def test_a_measured_series_is_a_line_in_every_row_that_it_has() -> None:
    time = np.arange(0.0, 0.2, 1e-4)
    series = Series(time, np.cos(2 * np.pi * 90 * time) * 4e-3, None, np.abs(np.sin(2 * np.pi * 45 * time)), "")
    drawn = paper_figure(compute("7", Given(series={90.0: series})), THEMES["light"])
    assert isinstance(drawn, GridPlot)
    assert [one.name for one in drawn.select({"type": ColumnDataSource})].count("measured") == 2


def test_points_on_a_straight_line_are_left_out_and_no_others() -> None:
    values = np.concatenate([np.zeros(200), np.sin(np.linspace(0.0, 6.0, 300)), np.zeros(100)])
    kept = fewer(values)
    assert len(kept) < 0.4 * len(values) and kept[0] == 0 and kept[-1] == len(values) - 1
    assert np.abs(np.interp(np.arange(len(values)), kept, values[kept]) - values).max() < 6 * 2e-4 * np.ptp(values)
