"""Figure 11: multipliers of chain and observer, and the displacement of their first beads over time."""

from __future__ import annotations

import numpy as np
from bokeh.models import HoverTool, LayoutDOM, Range1d
from bokeh.plotting import figure

from granchain_core.paper import CoupledRow, Observers

from ..multipliers import multipliers
from ..theme import Theme
from ..themed import apply_theme, empty_figure, themed
from .panels import grid


def observers(shown: Observers, theme: Theme) -> LayoutDOM:
    """Draw a row for each κ: the plane of multipliers, bead 1 of the chain, bead 1 of the observer."""
    values = np.concatenate([bead for part in shown.parts for bead in part.first_beads]) * 1e6
    room = 0.06 * float(np.ptp(values))
    across = Range1d(float(values.min()) - room, float(values.max()) + room)
    return grid([_row(part, "abc" if number == 0 else "def", across, theme) for number, part in enumerate(shown.parts)])


def _row(part: CoupledRow, letters: str, across: Range1d, theme: Theme) -> list[figure]:
    orbit = part.twin.orbit
    assert orbit is not None  # figure 11 shows periodic orbits
    plane = multipliers(orbit, theme)
    plane.title.text = f"({letters[0]}) κ = {part.kappa:.3g}, {part.frequency:g} Hz: {len(part.outside)} outside"
    panels = [plane]
    for letter, words, role, bead in zip(letters[1:], ("chain", "observer"), ("accent", "second"), part.first_beads,
                                         strict=True):
        plot = empty_figure(name=f"{words} {part.kappa:g}", y_range=across, min_border=4)
        line = plot.line(1e3 * part.twin.time, 1e6 * bead)
        themed(line, line_color=role, line_width=1.6)
        plot.add_tools(HoverTool(renderers=[line], mode="vline", tooltips=[("time", "@x{0.00} ms"),
                                                                           ("displacement", "@y{0.000} µm")]))
        plot.title.text = f"({letter}) bead 1 of the {words}"
        plot.xaxis.axis_label, plot.yaxis.axis_label = "time (ms)", "displacement (µm)"
        plot.x_range.range_padding = 0.0
        panels.append(apply_theme(plot, theme))
    return panels
