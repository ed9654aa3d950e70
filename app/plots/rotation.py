"""The convergence of a rotation number's weighted average with the length of the record."""

from __future__ import annotations

from bokeh.models import ColumnDataSource, HoverTool
from bokeh.plotting import figure

from granchain_core import RotationNumber

from .theme import Theme
from .themed import apply_theme, empty_figure, themed


def rotation(result: RotationNumber, theme: Theme) -> figure:
    """Draw the largest difference between three halves of the record over its length, both logarithmic."""
    states, values, differences = result.convergence.T if result.value is not None else ([], [], [])
    source = ColumnDataSource({"states": states, "value": values, "difference": differences}, name="convergence")
    plot = empty_figure(name="rotation", min_border=4, x_axis_type="log", y_axis_type="log")
    themed(plot.line("states", "difference", source=source, line_width=1.4), line_color="accent")
    dots = plot.scatter("states", "difference", source=source, size=8)
    themed(dots, fill_color="accent", line_color="accent")
    plot.add_tools(HoverTool(renderers=[dots], tooltips=[
        ("states on one curve", "@states{0}"), ("rotation number", "@value{0.000000000000}"),
        ("difference", "@difference{0.0e+0}")]))
    plot.xaxis.axis_label, plot.yaxis.axis_label = "states on one curve", "difference of halves of the record"
    plot.title.text = result.summary()[0]
    return apply_theme(plot, theme)
