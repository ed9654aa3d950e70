"""The line of a curve is interrupted between motions whose maxima are not comparable, wherever the curve is drawn."""

from __future__ import annotations

import math

import pytest
from bokeh.models import ColumnDataSource, Line

from app.curve.view import CurveFigure
from app.plots.branches import BranchRows
from app.plots.curve import curve_columns, line_pieces
from granchain_core import CurvePoint, scene
from granchain_core.results.forces import ForceErrors
from granchain_core.results.regime import Regime
from granchain_core.scene.state import rest

REGIMES = {
    "periodic": Regime("periodic", 1, None, None, 9), "chaotic": Regime("chaotic", None, None, None, 9, (0.1, 0.01)),
    "quasi-periodic": Regime("quasi-periodic", None, None, None, 9, (0.0, 0.01)), "unsettled": Regime.unsettled(9)}
NAMES = ["periodic", "periodic", "chaotic", "unsettled", "periodic", "periodic", "quasi-periodic", "chaotic"]
#: Pieces of the line, by the places of the points.
PIECES = [[0, 1], [2, 3], [4, 5], [6, 7]]
FORCES = [1.0, 1.0, math.nan, 1.0, 1.0, math.nan, 1.0, 1.0, math.nan, 1.0, 1.0]


def points(names: list[str]) -> list[CurvePoint]:
    """Return points with equal forces and these regimes."""
    return [CurvePoint(100.0 + 10.0 * i, 1.0, 1.0, 1.0, REGIMES[name], ForceErrors(), rest(scene("sec2")))
            for i, name in enumerate(names)]


def test_the_line_is_broken_where_maxima_are_not_comparable() -> None:
    assert line_pieces(points(NAMES)) == PIECES
    assert line_pieces([]) == []
    columns = curve_columns(points(NAMES), 1.0)
    assert columns["force"] == pytest.approx(FORCES, nan_ok=True)
    assert {len(column) for column in columns.values()} == {len(FORCES)}


def lines_of(figure: CurveFigure) -> list[ColumnDataSource]:
    """Return the sources of a figure's lines that are not empty."""
    sources = [r.data_source for r in figure.figure.renderers if isinstance(r.glyph, Line)]
    return [source for source in sources if len(source.data["force"])]


def test_the_page_and_its_grey_copies_break_the_line() -> None:
    page = CurveFigure(lambda _: None)
    page.add("rest", points(NAMES), covers_range=False)
    page.begin(["rest"])
    page.pinned_curves([points(NAMES)])
    grey, pinned = lines_of(page)
    assert [math.isnan(force) for force in grey.data["force"]] == [math.isnan(force) for force in FORCES]
    assert [math.isnan(force) for force in pinned.data["force"]] == [math.isnan(force) for force in FORCES]


def test_the_curve_behind_branches_is_broken_at_the_same_places() -> None:
    shown = BranchRows().curve(points(NAMES))
    assert shown is not None
    assert [x for _, _, x, _ in shown["pieces"]] == [[100.0 + 10.0 * i for i in piece] for piece in PIECES[::2]]
