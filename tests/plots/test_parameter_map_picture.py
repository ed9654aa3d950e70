"""The figure of a parameter map: places of cells, their texts, and how it fills."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from bokeh.models import LogScale

from app.plots.branches import SPECIAL_STYLES
from app.plots.parameter_map import CATEGORIES, category, cell_rows, cell_words, nothing, parameter_map, scale_models
from app.plots.theme import THEMES
from granchain_core import scene
from granchain_core.bifurcation_continuation import BifurcationCurve, BifurcationPoint
from granchain_core.parameter_maps import Axis, Grid, ParameterMap
from granchain_core.parameter_maps.cells import CELL_REGIMES, empty_cells

GRID = Grid(scene("sec2").evolve(N=2), Axis.of("f", [1900.0, 2000.0, 2100.0]), Axis.of("A0", [1e-7, 1e-6, 1e-5]))


def filled(*numbers: int, regime: str = "periodic", period: int = 2, force: float = 0.5) -> ParameterMap:
    """Return a parameter map in which some cells are computed."""
    found = nothing(GRID)
    for number in numbers:
        found.cells[number]["regime"], found.cells[number]["period"] = CELL_REGIMES.index(regime), period
        found.cells[number]["max_output_force"] = force * (1 + number)
    return found


def data(plot: Any, name: str) -> dict[str, list[Any]]:
    """Return the columns of a source."""
    return dict(plot.select_one({"name": name}).data)


def test_cells_meet_half_way_and_coarse_cells_cover_finer_ones() -> None:
    plot = parameter_map(filled(0, 4), THEMES["light"])
    cells = data(plot, "cells")
    assert cells["number"] == [0, 4] and cells["spacing"][0] > 1 == cells["spacing"][1]
    assert (cells["left"], cells["right"]) == ([1850.0, 1950.0], [2150.0, 2050.0])  # evenly spaced
    assert cells["bottom"][1] == pytest.approx(10**-0.5, rel=1e-6) and cells["top"][1] == pytest.approx(10**0.5, rel=1e-6)
    assert cells["own_right"] == [1950.0, 2050.0]
    assert isinstance(plot.y_scale, LogScale) and not isinstance(plot.x_scale, LogScale)
    assert plot.yaxis[0].axis_label == "drive amplitude A₀ (µm)"
    assert (plot.x_range.start, plot.x_range.end) == (1850.0, 2150.0)


def test_bifurcation_curves_are_drawn_over_the_map_in_its_units() -> None:
    points = [BifurcationPoint(1920.0, 1e-6, -1.0 + 0.0j, np.zeros(4)), BifurcationPoint(1980.0, 1e-5, -1.0 + 0.0j, np.zeros(4))]
    plot = parameter_map(filled(0, 4), THEMES["light"], curves=[BifurcationCurve("period_doubling", 1, points)])
    drawn = data(plot, "bifurcation curve")
    assert drawn["x"] == [1920.0, 1980.0] and drawn["y"] == pytest.approx([1.0, 10.0])  # Hz, µm
    assert drawn["tooltip"] == ["period doubling of period 1: f 1920 to 1980 Hz, A0 1e-06 to 1e-05 m, 2 points"] * 2
    assert parameter_map(filled(0), THEMES["light"]).select_one({"name": "bifurcation curve"}) is None


def test_the_marks_on_bifurcation_curves_say_of_which_kind_they_are() -> None:
    """They are the marks of a branch's special points, with a key; a long curve has few of them."""
    points = [BifurcationPoint(1920.0 + i, 1e-6, -1.0 + 0.0j, np.zeros(4)) for i in range(60)]
    curves = [BifurcationCurve(kind, 1, points) for kind in ("fold", "neimark_sacker", "fold")]
    plot = parameter_map(filled(0, 4), THEMES["light"], curves=curves)
    legend = plot.select_one({"name": "bifurcations"})
    assert [item.label.value for item in legend.items] == ["fold", "Neimark–Sacker (torus)"]
    for item, kind in zip(legend.items, ("fold", "neimark_sacker"), strict=True):
        line, marks = item.renderers
        assert not line.glyph.line_dash and marks.glyph.marker == SPECIAL_STYLES[kind]["marker"]
        assert marks.view.filter.indices[0] == 0 and marks.view.filter.indices[-1] == 59 and len(marks.view.filter.indices) == 9


def test_only_computed_cells_are_drawn() -> None:
    plot = parameter_map(nothing(GRID), THEMES["dark"])
    assert data(plot, "cells")["number"] == [] and data(plot, "mark") == {"x": [], "y": []}
    assert scale_models(nothing(GRID).cells[:0]) == {}
    failed = filled(4, regime="failed", period=0)
    failed.cells[4]["max_output_force"] = np.nan
    rows = cell_rows(GRID, failed.cells[[4]])
    assert rows["force"] == [None] and rows["regime"] == ["failed"] and rows["tooltip"] == ["2000 Hz, 1 µm: computation failed"]


@pytest.mark.parametrize(("low", "high", "ticks"), [
    (2e-3, 30.0, [0.01, 0.1, 1.0, 10.0]), (0.05, 3.0, [0.1, 0.3, 1.0, 3.0]), (0.2, 1.0, [0.2, 0.5, 1.0]),
    (0.31, 0.33, [0.31])])
def test_the_scale_of_forces_has_round_ticks(low: float, high: float, ticks: list[float]) -> None:
    cells = filled(4).cells[:2].copy()
    cells["regime"], cells["max_output_force"] = 1, [low, high]
    assert scale_models(cells)["force ticks"]["ticks"] == ticks


def test_the_words_of_a_cell_have_its_error_where_one_is_stated() -> None:
    cell = filled(4).cells[4]
    assert cell_words(GRID, cell) == "2000 Hz, 1 µm: period 2, largest output force 2.5 N, largest observed, no error stated"
    cell["error_estimate"] = 3e-5
    assert cell_words(GRID, cell).endswith("2.500 N, relative error 3e-5")
    cell["regime"], cell["period"], cell["lyapunov"], cell["lyapunov_error"] = CELL_REGIMES.index("chaotic"), 0, 0.21, 0.02
    assert cell_words(GRID, cell).endswith("Lyapunov exponent +0.210 ± 0.020") and ": chaotic," in cell_words(GRID, cell)


def test_every_regime_and_period_has_its_category() -> None:
    cell = empty_cells(GRID)[0]
    told = {}
    for name, period in (("periodic", 1), ("periodic", 4), ("periodic", 5), ("periodic", 16), ("chaotic", 0),
                         ("quasi-periodic", 0), ("unsettled", 0), ("failed", 0)):
        cell["regime"], cell["period"] = CELL_REGIMES.index(name), period
        told[name, period] = category(cell)
    assert told["periodic", 1] == "period 1" and told["periodic", 4] == "period 4"
    assert told["periodic", 5] == told["periodic", 16] == "period 5+"
    assert all(told[name, 0] == name for name in ("chaotic", "quasi-periodic", "unsettled", "failed"))


@pytest.mark.parametrize("shown", ["force", "regime"])
def test_forces_have_a_scale_and_regimes_a_legend_with_a_hatch_for_each(shown: str) -> None:
    plot = parameter_map(filled(0, 4, 8), THEMES["projector"], shown, now=(1950.0, 2e-6))
    seen = {name: plot.select_one({"name": name}).visible for name in ("force", "bar", "regime", "regimes")}
    assert seen == {"force": shown == "force", "bar": shown == "force", "regime": shown == "regime", "regimes": shown == "regime"}
    mapper = plot.select_one({"name": "force colours"})
    assert (mapper.low, mapper.high) == (0.5, 4.5)
    looks = [plot.select_one({"name": f"all {name}"}) for name in CATEGORIES]
    assert len({one.glyph.hatch_pattern for one in looks}) == len(CATEGORIES)  # the hatch alone tells regimes apart
    assert {one.visible for one in looks} == {shown == "regime"}
    assert [item.label.value for item in plot.legend[0].items if item.visible] == ["period 2"]
    assert data(plot, "mark") == {"x": [1950.0], "y": [pytest.approx(2.0)]}
