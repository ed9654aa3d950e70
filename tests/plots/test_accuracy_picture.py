"""The figure of error against time: points by method, rows without a point, the requested accuracy and the cheapest
row.
"""

from __future__ import annotations

import numpy as np
import pytest
from bokeh.models import ColumnDataSource

from app.plots.accuracy import Annotations, accuracy, marks, points, styles
from app.plots.naive_forces import naive_columns, naive_forces
from app.plots.theme import THEMES
from granchain_core.accuracy import Row, compared_methods

ROWS = [Row("rk4", "1 × the default steps", float("inf"), 0.0, 0, 1.0, "It was not done."),
        Row("dop853", "tolerance 1e-6", float("nan"), 0.1, 5, 1e-6), Row("rk4", "2 × the default steps", 1e-5, 0.001, 7, 2.0),
        Row("euler" if "euler" in compared_methods() else "rk4", "", 40.0, 0.002, 9, 1.0)]


def test_every_method_has_a_mark_of_its_own_without_colour() -> None:
    shown = styles()
    assert list(shown) == list(compared_methods())
    assert len({(one["marker"], str(one["dash"]), one["filled"]) for one in shown.values()}) == len(shown)


def test_rows_without_a_finite_error_have_no_point_and_large_errors_are_at_the_top() -> None:
    columns = points(ROWS)
    assert columns["dop853"]["ms"] == []
    assert columns["rk4"]["ms"][0] == pytest.approx(1.0) and columns["rk4"]["error"][0] == 1e-5
    assert columns["rk4"]["tooltip"][0] == "error 1e-05, 1 ms, 7 evaluations"
    assert max(error for one in columns.values() for error in one["error"]) == 10.0


def test_marks_are_there_only_where_something_is_marked() -> None:
    nothing = marks(Annotations(1e-6), ROWS)
    assert nothing["good"] == {"top": 1e-6} and nothing["asked"]["data"]["words"] == ["asked 1e-6"]
    assert nothing["cheapest"]["data"]["ms"] == nothing["agreement"]["data"]["ms"] == []
    assert not nothing["agreement line"]["visible"]
    all_of_it = marks(Annotations(1e-6, 1e-11, (0.001, 1e-7), (0.004, 1e-8)), ROWS)
    assert all_of_it["agreement line"] == {"location": 1e-11, "visible": True}
    assert all_of_it["cheapest"]["data"] == {"ms": [1.0], "error": [1e-7]}
    assert all_of_it["now"]["data"] == {"ms": [4.0], "error": [1e-8]}


@pytest.mark.parametrize("compact", [False, True])
def test_changing_models_are_named(compact: bool) -> None:
    asked = Annotations(1e-6, 1e-11, (0.001, 1e-7), (0.004, 1e-8))
    plot = accuracy(ROWS, asked, THEMES["projector"], compact)
    for name, columns in points(ROWS).items():
        assert plot.select_one({"name": name, "type": ColumnDataSource}).data == columns
    for name, properties in marks(asked, ROWS).items():
        model = plot.select_one({"name": name})
        for property_, value in properties.items():
            assert getattr(model, property_) == value
    assert (plot.yaxis[0].axis_label is None) == compact


def test_a_naive_force_is_drawn_with_its_difference_or_not_at_all() -> None:
    time, force = np.arange(3.0), np.array([0.0, 1.0, 2.0])
    np.testing.assert_array_equal(naive_columns(time, force, force + 0.5)["difference"], [0.5] * 3)
    both = naive_forces(time, force, None, "ms", "mN", THEMES["light"])
    assert all(len(column) == 0 for column in both.select_one({"name": "naive"}).data.values())
    above, below = both.children
    assert above.x_range is below.x_range and above.yaxis[0].axis_label == "force (mN)"
