"""Figure 2: the resonance curve of section 2 with labels at its peaks and dips."""

from __future__ import annotations

from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

from granchain_core.paper import Transmission
from granchain_core.paper.peaks_and_valleys import dips, peaks

from ..axes import force_scale
from ..curve import curve
from ..theme import Theme
from ..themed import apply_theme, themed
from .panels import measured_curve


def transmission(shown: Transmission, theme: Theme) -> figure:
    """Draw the largest elastic output force over the frequency; peaks 1:n and the dips between them have labels."""
    plot = curve([shown.curve], theme, elastic=True)
    largest = max(p.max_output_force_elastic for p in shown.curve.points)
    scale = force_scale("", largest).factor
    for name, points, below in (("peaks", peaks(shown.curve), False), ("dips", dips(shown.curve), True)):
        words = [f"1:{p.regime.period}, {p.frequency:g} Hz" if not below
                 else f"{p.frequency:g} Hz" + ("" if p.regime.period == 1 else f", {p.regime.name}") for p in points]
        source = ColumnDataSource({"x": [p.frequency for p in points], "words": words,
                                   "y": [p.max_output_force_elastic / scale for p in points]}, name=name)
        text = plot.text("x", "y", text="words", source=source, text_align="center",
                         text_baseline="top" if below else "bottom", y_offset=10 if below else -8)
        themed(text, text_color="soft" if below else "ink", text_font_size="small_figure_text")
    measured_curve(plot, shown.measured, scale)
    plot.legend.ncols = 3  # four columns are wider than a phone
    highest = largest if shown.measured is None else max(largest, float(shown.measured.force.max()))
    plot.y_range.update(end=1.12 * highest / scale)
    return apply_theme(plot, theme)
