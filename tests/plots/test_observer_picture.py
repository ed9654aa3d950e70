"""The figure of an observer's distance over time, with the straight line that a multiplier predicts."""

from __future__ import annotations

import pytest

from app.plots.observer import observer, prediction
from app.plots.theme import THEMES


@pytest.mark.parametrize(("distance", "factor", "end"), [
    (1e-3, 0.1, (13.0, 1e-12)),  # nine decades, one per period
    (1e-3, 10.0, (7.0, 1.0)),
    (1e-3, 0.1**0.5, (22.0, 1e-12)),
])
def test_a_prediction_ends_where_distances_do_not_follow_it(distance: float, factor: float,
                                                            end: tuple[float, float]) -> None:
    start, last = prediction(4.0, distance, factor)
    assert start == (4.0, distance) and last == pytest.approx(end, rel=1e-9)


@pytest.mark.parametrize(("distance", "factor"), [(1e-3, None), (1e-3, 0.0), (1e-14, 0.5), (2.0, 1.5), (1e-12, 0.5)])
def test_nothing_is_predicted_without_a_factor_or_beyond_the_limits(distance: float, factor: float | None) -> None:
    assert prediction(4.0, distance, factor) == []


def test_a_factor_of_one_is_a_level_line() -> None:
    (_, first), (_, last) = prediction(4.0, 1e-3, 1.0)
    assert first == last


@pytest.mark.parametrize("compact", [False, True])
def test_sources_are_found_by_name_and_titles_have_room_only_in_the_large_figure(compact: bool) -> None:
    plot = observer([0.0, 1.0], [1e-3, 1e-4], [(0.0, 1e-3), (9.0, 1e-12)], THEMES["dark"], compact)
    assert plot.select_one({"name": "distance"}).data == {"period": [0.0, 1.0], "distance": [1e-3, 1e-4]}
    assert plot.select_one({"name": "prediction"}).data["period"] == [0.0, 9.0]
    assert (plot.yaxis[0].axis_label is None) == compact
    assert plot.background_fill_color == THEMES["dark"].card
