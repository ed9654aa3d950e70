"""The bifurcation diagram: a bead's displacement once a drive period, over a knob."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool
from bokeh.plotting import figure

from granchain_core import BifurcationDiagram

from ..format import prefixed
from .axes import knob_scale
from .regimes import REGIME_MARKS, regime_key
from .theme import Theme
from .themed import apply_theme, empty_figure


def bifurcation_diagram(diagram: BifurcationDiagram, bead: int, theme: Theme) -> figure:
    """Draw the displacements of a bead (1 to N) at drive phase 0, coloured by the regime of the motion."""
    values, states = diagram.cloud(bead)
    axis = knob_scale(diagram.knob, values.tolist())
    factor, letter = prefixed(float(np.abs(states).max(initial=0.0)) or 1.0)
    kept = [point for point in diagram.points if not point.failure]
    keys = [regime_key(point.regime.name, point.regime.period) for point in kept for _ in point.strobes]
    source = ColumnDataSource(name="strobes", data={
        "value": values / axis.factor, "state": states / factor, "regime": keys,
        "colour": [REGIME_MARKS[key][1] for key in keys]})
    plot = empty_figure(name="strobes", min_border=4)
    dots = plot.scatter("value", "state", source=source, size=3, fill_color="colour", line_color=None,
                        legend_group="regime")
    plot.add_tools(HoverTool(renderers=[dots], tooltips=[
        (axis.title, f"@value{{0.0000}} {axis.unit}"), ("displacement", f"@state{{0.0000}} {letter}m"),
        ("motion", "@regime")]))
    plot.xaxis.axis_label = axis.label
    plot.yaxis.axis_label = f"displacement of bead {bead} at drive phase 0 ({letter}m)"
    for legend in plot.legend:
        legend.update(orientation="horizontal", padding=0, margin=2, ncols=4)
    if plot.legend:
        plot.add_layout(plot.legend[0], "below")
    return apply_theme(plot, theme)
