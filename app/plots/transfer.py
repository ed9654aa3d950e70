"""The transfer from the input to the output force: gain and phase over the frequency."""

from __future__ import annotations

from typing import Any

from bokeh.layouts import column
from bokeh.models import ColumnDataSource, HoverTool, LayoutDOM
from bokeh.plotting import figure

from granchain_core import BadInput, Transfer

from ..format import prefixed
from .theme import Theme
from .themed import apply_theme, empty_figure, themed


def transfer(result: Transfer, theme: Theme) -> LayoutDOM:
    """Draw gain above phase, with a point for each line at which the input force is not negligible.

    Raise `BadInput` if the input force has no such line.
    """
    if not len(result.frequency):
        raise BadInput("The input force has no lines, so there is no transfer.")
    hertz, letter = prefixed(float(result.frequency.max()))
    source = ColumnDataSource({"frequency": result.frequency / hertz, "gain": result.gain, "phase": result.phase},
                              name="lines")
    gain = _panel(source, "gain", f"@frequency{{0.0000}} {letter}Hz", "gain |H|", y_axis_type="log")
    phase = _panel(source, "phase", f"@frequency{{0.0000}} {letter}Hz", "phase (rad)", x_range=gain.x_range)
    phase.xaxis.axis_label = f"frequency ({letter}Hz)"
    return column([apply_theme(gain, theme), apply_theme(phase, theme)], sizing_mode="stretch_both")


def _panel(source: ColumnDataSource, name: str, where: str, label: str, **options: Any) -> figure:
    plot = empty_figure(name=name, min_border=4, **options)
    dots = themed(plot.scatter("frequency", name, source=source, size=7, line_color=None), fill_color="output")
    plot.add_tools(HoverTool(renderers=[dots], tooltips=[("frequency", where), (label, f"@{name}{{0.0000}}")]))
    plot.yaxis.axis_label = label
    return plot
