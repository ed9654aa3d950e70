"""Figures 6 and 9: the rig's curves with stated or measured values, next to force trains at 60 Hz."""

from __future__ import annotations

import math

from bokeh.layouts import row
from bokeh.models import ColumnDataSource, HoverTool, LayoutDOM, Span
from bokeh.plotting import figure

from granchain_core import Curve
from granchain_core.paper import RigCurves, RigResponse, Trains

from ..axes import knob_scale
from ..curve import FORCES, forces_in_words
from ..regimes import REGIME_MARKS, regime_key
from ..theme import Theme
from ..themed import apply_theme, empty_figure, themed
from .panels import inside_legend, measured_curve
from .trains import trains

_DASHES: tuple[str | list[int], ...] = ("solid", [8, 3], [3, 3], [10, 3, 2, 3])
_COLOURS = ("output", "input", "second", "naive")


def response(shown: RigResponse, theme: Theme) -> LayoutDOM:
    """Draw curves on the left and force trains on the right."""
    return row([_curves(shown.curves, theme), trains(Trains((shown.column,)), theme)], sizing_mode="stretch_both")


def _curves(shown: RigCurves, theme: Theme) -> figure:
    plot = empty_figure(name="curves", min_border=4)
    for swept, dash, role in zip(shown.curves, _DASHES, _COLOURS, strict=False):
        _curve(plot, swept, dash, role, marked=len(shown.curves) == 1)
    high = max(p.max_output_force_elastic for swept in shown.curves for p in swept.points
               if math.isfinite(p.max_output_force_elastic))
    if shown.measured is not None:
        high = max(high, float(shown.measured.force.max()))
    for feature in shown.features:
        line = Span(location=feature.frequency, dimension="height", line_dash=[2, 4])
        plot.add_layout(themed(line, line_color="drive" if feature.is_resonance else "soft", line_width=1.8))
    stated = ColumnDataSource({
        "x": [f.frequency for f in shown.features], "y": [1.36 * high] * len(shown.features),
        "words": [f"{f.frequency:g} Hz, {f.kind}" for f in shown.features],
        "source": [f.source for f in shown.features]}, name="stated")
    themed(plot.text("x", "y", text="words", source=stated, angle=-math.pi / 2,
                     text_baseline="bottom", text_align="left", x_offset=3), text_color="soft",
           text_font_size="smallest_figure_text")
    if shown.states:
        _states(plot, shown)
    measured_curve(plot, shown.measured, 1.0)
    plot.y_range.update(start=0, end=1.38 * high)
    plot.xaxis.axis_label, plot.yaxis.axis_label = knob_scale("f").label, "largest elastic output force (N)"
    plot.title.text = "(a) lines: model (5) from rest; upright: what the text states"
    apply_theme(plot, theme)
    inside_legend(plot, theme, "top_left")
    return plot


def _curve(plot: figure, swept: Curve, dash: str | list[int], role: str, marked: bool) -> None:
    """Draw a curve; points that are not periodic are always marked, the others only if `marked`."""
    points = [p for p in swept.points if math.isfinite(p.max_output_force_elastic)]
    keys = [regime_key(p.regime.name, p.regime.period) for p in points]
    source = ColumnDataSource({
        "x": [p.frequency for p in points], "y": [p.max_output_force_elastic for p in points],
        "marker": [REGIME_MARKS[key][0] for key in keys],
        "colour": [REGIME_MARKS[key][1] for key in keys], "regime": keys,
        "sentence": [p.regime.sentence for p in points],
        "size": [REGIME_MARKS[key][2] + 1 if marked or not p.regime.period else 0
                 for key, p in zip(keys, points, strict=True)], **forces_in_words(points)})
    words = f"A0 = {1e6 * swept.scene.A0:g} µm"
    line = plot.line("x", "y", source=source, line_dash=dash, legend_label=words)
    themed(line, line_color=role, line_width=1.8)
    marks = plot.scatter("x", "y", source=source, marker="marker", size="size", fill_color="colour",
                         line_color="colour", line_width=1.5, **({"legend_group": "regime"} if marked else {}))
    plot.add_tools(HoverTool(renderers=[marks if marked else line], tooltips=[
        ("", words), ("drive frequency", "@x{0.0} Hz"), *FORCES, ("motion", "@sentence")]))


def _states(plot: figure, shown: RigCurves) -> None:
    """Draw a ring for each preset of figure 12, at the frequency that the paper gives."""
    source = ColumnDataSource({
        "x": [named for named, _ in shown.states], "y": [s.run.max_output_force_elastic for _, s in shown.states],
        "words": [f"{1e6 * s.run.scene.A0:g} µm" + ("" if s.run.scene.f == named else f" at {s.run.scene.f:g} Hz")
                  for named, s in shown.states]}, name="states")
    rings = plot.scatter("x", "y", source=source, size=15, fill_color=None, legend_label="figure 12's states")
    themed(rings, line_color="ink", line_width=2.4)
    themed(plot.text("x", "y", text="words", source=source, x_offset=11, text_baseline="middle",
                     text_font_style="bold"), text_color="ink", text_font_size="smallest_figure_text")
