"""The figure of a hard case: granchain's result and a naive solver's on the same axes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Legend, LegendItem
from bokeh.plotting import figure

from granchain_core.hard_cases import Picture

from .theme import Theme
from .themed import apply_theme, empty_figure, themed

_LOGARITHM = ", log10"
#: Figures with at most this many points have a dot at each point.
_MOST_DOTS = 70
#: Height of the drawing [px].
_HEIGHT = 250
#: Height of a line in the legend [px].
_LEGEND_LINE = 24
_STYLES: dict[str, list[dict[str, Any]]] = {
    "ours": [{"colour": "ink", "width": 2.6, "dash": []}, {"colour": "ink", "width": 2.6, "dash": [14, 5]}],
    "naive": [{"colour": "naive", "width": 2.2, "dash": [7, 4]}, {"colour": "second", "width": 2.2, "dash": [2, 4]}],
}
_TRUTH = {"colour": "steel", "width": 5.0, "dash": []}


def check(data: Picture, theme: Theme) -> figure:
    """Draw the traces of a hard case: granchain's in ink, naive ones dashed and in colour, the true one broad and grey.

    Nothing is drawn where a trace is NaN. A trace that ends before the figure does has a cross at its end.
    """
    labels = [trace.label for trace in data.traces]
    x_label, x_log, x = _axis(data.x_label, data.x)
    drawn = [_axis(data.y_label, trace.values) for trace in data.traces]
    y_label, y_log, _ = drawn[0]
    plot = empty_figure(name="check", sizing_mode="stretch_width", height=_HEIGHT + _LEGEND_LINE * len(labels),
                        title=y_label, x_axis_type="log" if x_log else "linear",
                        y_axis_type="log" if y_log else "linear")
    plot.xaxis.axis_label = x_label
    plot.x_range.range_padding = 0.02
    source = ColumnDataSource({"x": x, **{str(i): y for i, (_, _, y) in enumerate(drawn)}})
    items = []
    for i, (label, style) in enumerate(zip(labels, _styles(labels), strict=True)):
        line = plot.line("x", str(i), source=source, line_dash=style["dash"], line_cap="round", name=label)
        items.append(LegendItem(label=label, renderers=[themed(line, line_color=style["colour"],
                                                               line_width=style["width"])]))
        plot.add_tools(HoverTool(renderers=[line], tooltips=[
            ("", label), (x_label, "@x{0.[0000]}" if not x_log else "@x{0.0e}"),
            (y_label, f"@{{{i}}}{{0.000e}}")]))
        _points(plot, source, i, style)
    plot.add_layout(Legend(items=items, click_policy="hide", padding=0, margin=4, glyph_width=44), "below")
    for axis in (plot.xaxis[0], plot.yaxis[0]):
        axis.ticker.desired_num_ticks = 5
    return apply_theme(plot, theme)


def _axis(label: str, values: np.ndarray) -> tuple[str, bool, np.ndarray]:
    """Return the label, whether the axis is logarithmic, and the numbers, also if their logarithms are given."""
    if label.endswith(_LOGARITHM):
        return label.removesuffix(_LOGARITHM), True, 10.0 ** values
    return label, False, np.asarray(values, dtype=np.float32)


def _styles(labels: Sequence[str]) -> list[dict[str, Any]]:
    """Return the style of each line. If no label names granchain, all lines are granchain's."""
    named = any(label.startswith("granchain") for label in labels)
    used = {"ours": 0, "naive": 0}
    styles = []
    for label in labels:
        if label == "true":
            styles.append(_TRUTH)
            continue
        group = "ours" if not named or label.startswith("granchain") else "naive"
        styles.append(_STYLES[group][used[group] % len(_STYLES[group])])
        used[group] += 1
    return styles


def _points(plot: figure, source: ColumnDataSource, number: int, style: dict[str, Any]) -> None:
    """Draw dots if there are few points, and a cross at the last point of a trace that breaks off."""
    x, y = (np.asarray(source.data[name]) for name in ("x", str(number)))
    if len(x) <= _MOST_DOTS:
        themed(plot.scatter("x", str(number), source=source, size=5, line_color=None), fill_color=style["colour"])
    known = np.flatnonzero(np.isfinite(y))
    if len(known) and known[-1] < len(y) - 1:
        themed(plot.scatter([float(x[known[-1]])], [float(y[known[-1]])], marker="x", size=12),
               line_color=style["colour"], line_width=style["width"])
