"""Forces of naive methods: dashed over the accurate output force, and their difference below."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.layouts import column
from bokeh.models import Column, ColumnDataSource, HoverTool

from .theme import Theme
from .themed import apply_theme, empty_figure, themed


def naive_forces(time: np.ndarray, accurate: np.ndarray, naive: np.ndarray | None, time_unit: str, unit: str,
                 theme: Theme) -> Column:
    """Draw two figures over one time axis: both forces, and their difference on an axis of its own.

    The sources are named "accurate" and "naive", so that a page can show the force computed with other steps.
    """
    sure = ColumnDataSource({"time": time, "force": accurate, "nothing": np.zeros_like(time)}, name="accurate")
    drawn = ColumnDataSource(naive_columns(time, accurate, naive), name="naive")
    above = empty_figure(name="naive forces", min_border=2, toolbar_location="right")
    below = empty_figure(name="difference", x_range=above.x_range, min_border=2, toolbar_location="right", height=150,
                         sizing_mode="stretch_width")
    # without this line, the axis would have no range if the naive force could not be computed
    themed(below.line("time", "nothing", source=sure), line_color="faint", line_width=1.0)
    lines: list[tuple[Any, str, Any, str, float, dict[str, Any]]] = [
        (above, "force", sure, "output", 4.0, {"legend_label": "accurate"}),
        (above, "force", drawn, "naive", 2.4, {"legend_label": "naive", "line_dash": [7, 4]}),
        (below, "difference", drawn, "naive", 1.6, {})]
    for plot, what, source, role, width, options in lines:
        line = themed(plot.line("time", what, source=source, **options), line_color=role, line_width=width)
        plot.add_tools(HoverTool(renderers=[line], mode="vline", tooltips=[
            ("time", f"@time{{0.000}} {time_unit}"),
            (options.get("legend_label", "naive − accurate"), f"@{what}{{0.000e}} {unit}")]))
    above.x_range.update(renderers=[above.renderers[0]], range_padding=0.0)
    above.xaxis.visible = False
    above.yaxis.axis_label = f"force ({unit})"  # the figure is low: a longer title would be cut off
    below.xaxis.axis_label = f"time ({time_unit})"
    below.yaxis.axis_label = f"error\n({unit})"  # in two lines: it is low
    above.legend.update(orientation="horizontal", padding=1, margin=2, click_policy="hide")
    above.add_layout(above.legend[0], "above")
    for plot in (above, below):
        plot.yaxis.ticker.desired_num_ticks = 4 if plot is above else 2
        apply_theme(plot, theme)
    return column(above, below, sizing_mode="stretch_both", spacing=0)


def naive_columns(time: np.ndarray, accurate: np.ndarray, naive: np.ndarray | None) -> dict[str, np.ndarray]:
    """Return the columns of the naive force and of its difference; they are empty if there is no naive force."""
    if naive is None:
        return {"time": time[:0], "force": time[:0], "difference": time[:0]}
    return {"time": time, "force": naive, "difference": naive - accurate}
