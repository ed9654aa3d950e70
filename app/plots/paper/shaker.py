"""Figure 5: amplitude of the shaker's velocity and of its displacement over the frequency."""

from __future__ import annotations

from bokeh.models import HoverTool, LayoutDOM

from granchain_core.paper import ShakerAmplitude

from ..axes import knob_scale
from ..theme import Theme
from ..themed import apply_theme, empty_figure, themed
from .panels import grid, hollow_points, inside_legend

_DASHES = ("dashed", "solid", "dotted")


def shaker(shown: ShakerAmplitude, theme: Theme) -> LayoutDOM:
    """Draw (a) V0 in mm/s and (b) A0 in µm: a line for every amplitude and a band between the outer two."""
    panels = []
    for name, label, unit in (("velocity", "velocity amplitude V0 (mm/s)", 1e3),
                              ("displacement", "displacement amplitude A0 (µm)", 1e6)):
        plot = empty_figure(name=name, min_border=4)
        lines = [(a, (shown.velocity(a) if name == "velocity" else 0.0 * shown.frequency + a) * unit)
                 for a in shown.amplitudes]
        band = plot.varea(shown.frequency, lines[0][1], lines[-1][1], fill_alpha=0.15)
        themed(band, fill_color="drive")
        for (a, values), dash in zip(lines, _DASHES, strict=True):
            line = plot.line(shown.frequency, values, line_dash=dash, legend_label=f"A0 = {1e6 * a:g} µm")
            themed(line, line_color="drive", line_width=2.0)
            plot.add_tools(HoverTool(renderers=[line], tooltips=[
                ("A0", f"{1e6 * a:g} µm"), ("frequency", "@x{0} Hz"), (label, "@y{0.00}")]))
        if shown.measured is not None:
            hollow_points(plot, shown.measured.frequency, unit * getattr(shown.measured, name), None,
                          shown.measured.word, [("frequency", "@x{0.0} Hz"), (label, "@y{0.000}")])
        plot.xaxis.axis_label, plot.yaxis.axis_label = knob_scale("f").label, label
        plot.y_range.start = 0
        plot.title.text = "(a) V0 = 2πf A0" if name == "velocity" else "(b) A0 = V0/(2πf)"
        inside_legend(plot, theme, "top_left" if name == "velocity" else "bottom_left")
        panels.append(apply_theme(plot, theme))
        inside_legend(plot, theme, "top_left" if name == "velocity" else "bottom_left")
    return grid([panels])
