"""Basins of attraction in a plane of starts, coloured by steady state."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool
from bokeh.palettes import Colorblind
from bokeh.plotting import figure

from granchain_core import Basins

from ..format import in_words, prefixed
from .axes import Scale
from .theme import GREY, Theme
from .themed import apply_theme, empty_figure

#: Patterns in addition to the colours, for readers who cannot tell the colours apart.
_HATCHES = (" ", "/", "\\", ".", "+", "x", "o", "-")
_FAILED = "the computation failed or was stopped"


def basins(result: Basins, theme: Theme) -> figure:
    """Draw the plane of starts; it is grey where the computation failed or was stopped."""
    x, y, colours = _axis(*result.x), _axis(*result.y), Colorblind[8]
    columns, rows = np.meshgrid(result.x[1] / x.factor, result.y[1] / y.factor)
    number = result.number.ravel()
    words = [f"{attractor.regime.sentence}; largest output force {in_words(attractor.max_output_force, 'N')}; "
             f"{100.0 * share:.0f} % of the plane"
             for attractor, share in zip(result.attractors, result.shares, strict=True)]
    plot = empty_figure(name="basins", min_border=4)
    plot.grid.visible = False
    width, height = _spacing(result.x[1] / x.factor), _spacing(result.y[1] / y.factor)
    for i in sorted(set(number.tolist())):
        cells = number == i
        source = ColumnDataSource(name=f"basin {i + 1}", data={"x": columns.ravel()[cells], "y": rows.ravel()[cells]})
        colour, hatch, meaning = (colours[i % 8], _HATCHES[i % 8], words[i]) if i >= 0 else (GREY, "x", _FAILED)
        cells = plot.rect("x", "y", width, height, source=source, line_color=None, fill_color=colour,
                          hatch_pattern=hatch, hatch_alpha=0.5, legend_label=meaning)
        plot.add_tools(HoverTool(renderers=[cells], tooltips=[("leads to", meaning)]))
    plot.xaxis.axis_label, plot.yaxis.axis_label = x.label, y.label
    for legend in plot.legend:
        legend.update(padding=0, margin=2)
    plot.add_layout(plot.legend[0], "below")
    return apply_theme(plot, theme)


def _axis(coordinate: str, values: np.ndarray) -> Scale:
    """Return the scale of a coordinate at the start."""
    factor, letter = prefixed(float(np.abs(values).max(initial=0.0)) or 1.0)
    kind, unit = ("displacement", "m") if coordinate[0] == "u" else ("velocity", "m/s")
    return Scale(f"{kind} of bead {coordinate[1:]} at the start", factor, letter + unit)


def _spacing(values: np.ndarray) -> float:
    """Return the width of a cell."""
    return float(np.diff(values).mean()) if len(values) > 1 else 1.0
