"""The style of the plots over time and of the curve: plain Bokeh plots with exact borders."""

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
    """A plot without toolbar that fills its cell; its colours come from the page's CSS.

    `borders` are its least left and right ones [px], `ticks` about how many there are along x and y, `axes` the places
    of the axes, and `grids` the dimensions across which there are grid lines. It is no `figure`, because
    `bokeh.plotting` makes ranges, scales, axes and glyphs that are replaced or never shown: a fifth of an opening.
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
    """No tick marks, no lines, large upright labels; one that names a quantity has the theme's text colour of its role.
    """
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
