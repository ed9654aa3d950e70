"""The style of the figures over time and of the curve: plain Bokeh plots with exact borders."""

from __future__ import annotations

from typing import Any

from bokeh.models import BasicTicker, Grid, LinearAxis, Plot

# Borders [px], the same for all figures over time, so that one cursor and the chain fit them exactly.
TOP = 78
BOTTOM = 82
LEFT = 60
GAP = 6


def bare_plot(borders: tuple[int, int], ticks: tuple[int, int], axes: tuple[str, str | None],
               grids: tuple[int, ...] = (0, 1), **options: Any) -> Plot:
    """Return a plot without a toolbar that fills its cell; its colours come from the page's CSS.

    `borders` are its smallest left and right borders [px], `ticks` the approximate numbers of ticks along x and y,
    `axes` the sides of the axes, and `grids` the dimensions that have grid lines. It is not a `figure`, because
    `bokeh.plotting` makes ranges, scales, axes and glyphs that are replaced or never shown, which takes a fifth of the
    time to open a page.
    """
    plot = Plot(
        sizing_mode="stretch_both", toolbar_location=None, background_fill_color=None, border_fill_color=None,
        outline_line_color=None, min_border_left=borders[0], min_border_right=borders[1], min_border_top=TOP,
        min_border_bottom=BOTTOM, output_backend="canvas", **options,
    )
    for dimension, (side, count) in enumerate(zip(axes, ticks, strict=True)):
        ticker = BasicTicker(desired_num_ticks=count, num_minor_ticks=0)
        if dimension in grids:
            plot.add_layout(Grid(dimension=dimension, ticker=ticker, grid_line_alpha=1.0))
        if side is not None:
            axis = LinearAxis(ticker=ticker)
            bare_axis(axis)
            plot.add_layout(axis, side)
    return plot


def bare_axis(axis: Any, role: str | None = None) -> None:
    """Style an axis: no tick marks or lines, large upright labels; the theme's text colour of `role` for its label."""
    axis.axis_line_color = None
    axis.major_tick_line_color = None
    axis.minor_tick_line_color = None
    axis.axis_label_text_font_style = "bold" if role else "normal"
    axis.axis_label_text_font_size = "14px"
    axis.major_label_text_font_size = "13px"
    axis.axis_label_standoff = 2
    axis.major_label_standoff = 2
    if role:
        axis.css_variables = {"--bk-axis-label-text-color": f"var(--{role}-text)"}
