"""Elements that several figures share: panels in rows, measured points, small legends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.layouts import gridplot
from bokeh.models import ColumnDataSource, HoverTool, LayoutDOM, Whisker
from bokeh.plotting import figure

from granchain_core.experiment import Measured

from ..measured import measured_over
from ..theme import Theme
from ..themed import themed


def grid(rows: Sequence[Sequence[figure]]) -> LayoutDOM:
    """Arrange panels in rows that fill the available room; the wheel scrolls the page until its tool is chosen."""
    for row in rows:
        for plot in row:
            plot.toolbar.active_scroll = None
    return gridplot([list(row) for row in rows], sizing_mode="stretch_both", toolbar_location="right",
                    toolbar_options={"logo": None, "autohide": True}, merge_tools=True)


def fewer(values: np.ndarray, part: float = 2e-4) -> np.ndarray:
    """Return indices of equally spaced samples, without those on a straight line to within `part` of the range."""
    kept = np.ones(len(values), dtype=bool)
    limit = part * float(np.ptp(values)) if len(values) else 0.0
    for step in (1, 2, 4, 8, 16):
        middle = np.arange(step, len(values) - step, 2 * step)
        straight = np.abs(values[middle] - 0.5 * (values[middle - step] + values[middle + step])) <= limit
        until = np.concatenate([[0], np.cumsum(kept)])
        alone = until[middle + step] - until[middle - step + 1] == 1
        kept[middle[straight & alone]] = False
    return np.flatnonzero(kept)


def inside_legend(plot: figure, theme: Theme, location: str = "top_right") -> None:
    """Put a small legend inside the frame; a click on an entry hides its line."""
    for legend in plot.legend:
        legend.update(location=location, padding=2, margin=4, spacing=0, label_height=14, glyph_height=14,
                      background_fill_alpha=0.8, click_policy="hide",
                      label_text_font_size=theme.smallest_figure_text)


def hollow_points(plot: figure, x: Any, y: Any, error: Any, words: str, hover: Sequence[tuple[str, str]]) -> None:
    """Draw measured points with the source "measured": hollow, thin, in front, with bars if there are errors."""
    data = {"x": x, "y": y}
    if error is not None:
        data |= {"low": y - error, "high": y + error}
    source = ColumnDataSource(data, name="measured")
    if error is not None:
        bars = Whisker(base="x", upper="high", lower="low", source=source, level="annotation", upper_head=None,
                       lower_head=None)
        plot.add_layout(themed(bars, line_color="ink", line_width=1.2))
    dots = plot.scatter("x", "y", source=source, size=8, fill_color=None, level="annotation", legend_label=words)
    themed(dots, line_color="ink", line_width=1.2)
    plot.add_tools(HoverTool(renderers=[dots], tooltips=[("", words), *hover]))


def measured_curve(plot: figure, measured: Measured | None, unit: float) -> None:
    """Draw a user's measured curve, if there is one, over a computed curve whose forces are in `unit` newtons."""
    if measured is not None:
        measured_over(plot, measured, unit)
