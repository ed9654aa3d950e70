"""The distance between an observer and its chain over time, on a logarithmic axis, and the rate that |μ| predicts."""

from __future__ import annotations

import math
from collections.abc import Sequence

from bokeh.models import ColumnDataSource, DataRange1d, HoverTool, Range1d
from bokeh.plotting import figure

from .theme import Theme
from .themed import apply_theme, empty_figure, themed

#: Drive periods shown at once; panning shows the earlier periods that are kept.
SHOWN_PERIODS = 60
#: The lower end of the axis of distances.
_SMALLEST_DISTANCE = 1e-13
#: Its upper end.
_LARGEST_DISTANCE = 30.0
#: Drive periods after which a prediction is no longer drawn.
_LONGEST_PREDICTION = 10_000.0


def observer(period: Sequence[float], distance: Sequence[float], prediction: Sequence[tuple[float, float]],
             theme: Theme, compact: bool = False) -> figure:
    """Draw the distance |y − x| at `period`, and a straight line through the points of `prediction`.

    The sources are named "distance" and "prediction"; a page adds points to them while the chains move.
    """
    follow = DataRange1d(follow="end", follow_interval=SHOWN_PERIODS, default_span=SHOWN_PERIODS / 3,
                         range_padding=0.0)
    plot = empty_figure(name="observer", y_axis_type="log", x_range=follow,
                        y_range=Range1d(_SMALLEST_DISTANCE, _LARGEST_DISTANCE), active_scroll=None,
                        toolbar_location=None if compact else "right", min_border=4)
    measured = ColumnDataSource({"period": list(period), "distance": list(distance)}, name="distance")
    expected = ColumnDataSource({"period": [p for p, _ in prediction], "distance": [d for _, d in prediction]},
                                name="prediction")
    before = plot.line("period", "distance", source=expected, line_dash=[9, 5], legend_label="predicted by |μ|")
    line = plot.line("period", "distance", source=measured, legend_label="measured")
    follow.renderers = [line]
    themed(before, line_color="accent", line_width=2.6)
    themed(line, line_color="ink", line_width=2.4)
    plot.add_tools(HoverTool(renderers=[line], mode="vline", tooltips=[
        ("drive period", "@period{0.00}"), ("distance |y − x|", "@distance{0.00e}")]))
    plot.legend.update(location="bottom_left", orientation="horizontal", padding=2, visible=not compact)
    if not compact:
        plot.xaxis.axis_label, plot.yaxis.axis_label = "drive periods", "distance |y − x| over A₀"
    plot.yaxis.ticker.desired_num_ticks = 5
    plot.yaxis.ticker.num_minor_ticks = 0
    return apply_theme(plot, theme)


def prediction(period: float, distance: float, factor: float | None) -> list[tuple[float, float]]:
    """Return a straight line on the logarithmic axis from a measured point, with this factor per drive period.

    It ends where distances are too large or too small to follow it. It is empty if there is no prediction.
    """
    if factor is None or factor <= 0.0 or distance < _SMALLEST_DISTANCE:
        return []
    slope = math.log10(factor)
    limit = 0.0 if slope > 0.0 else -12.0
    left = (limit - math.log10(distance)) / slope if slope != 0.0 else _LONGEST_PREDICTION
    if left <= 0.0:
        return []
    left = min(left, _LONGEST_PREDICTION)
    return [(period, distance), (period + left, distance * 10.0 ** (slope * left))]
