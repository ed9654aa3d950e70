"""What the time pictures and the curve have in common: quiet Bokeh figures with exact borders."""

from __future__ import annotations

from typing import Any

import panel as pn
from bokeh.models import Plot
from bokeh.plotting import figure

from ..pictures.theme import THEMES

TOP, BOTTOM, LEFT, GAP = 78, 82, 60, 6
"""Borders in pixels, the same for all time pictures, so that one cursor and the chain fit them exactly."""

DRIVE, INPUT, OUTPUT = THEMES["light"].drive, THEMES["light"].input, THEMES["light"].output
"""The colours that mean one thing everywhere, in every theme."""


def quiet_figure(left: int, right: int, **options: Any) -> figure:
    """A figure without toolbar that fills its cell; its colours come from the page's CSS."""
    plot = figure(
        sizing_mode="stretch_both", toolbar_location=None, tools="", background_fill_color=None,
        border_fill_color=None, outline_line_color=None, min_border_left=left, min_border_right=right,
        min_border_top=TOP, min_border_bottom=BOTTOM, output_backend="canvas", **options,
    )
    plot.grid.grid_line_alpha = 1.0
    for axis in (*plot.xaxis, *plot.yaxis):
        quiet_axis(axis)
    return plot


def quiet_axis(axis: Any, colour: str | None = None) -> None:
    """No tick marks, no lines, large upright labels; the label in `colour` when it names a quantity."""
    axis.axis_line_color = None
    axis.major_tick_line_color = None
    axis.minor_tick_line_color = None
    axis.axis_label_text_font_style = "bold" if colour else "normal"
    axis.axis_label_text_font_size = "14px"
    axis.major_label_text_font_size = "13px"
    axis.axis_label_standoff = 2
    axis.major_label_standoff = 2
    if colour:
        axis.css_variables = {"--bk-axis-label-text-color": colour}


def pane(plot: Plot) -> pn.pane.Bokeh:
    """The figure as a root of the page."""
    return pn.pane.Bokeh(plot, sizing_mode="stretch_both", margin=0)
