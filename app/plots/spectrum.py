"""A force's spectrum on a logarithmic axis: the lines of a Fourier series as stems, a windowed record as a curve."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Range1d
from bokeh.plotting import figure

from granchain_core import BadInput, Spectrum

from ..format import prefixed
from .axes import force_scale
from .theme import Theme
from .themed import apply_theme, empty_figure, themed

#: Decades drawn below the largest line.
_DECADES = 6.0


def spectrum(result: Spectrum, theme: Theme) -> figure:
    """Draw amplitudes over frequency, with the aliasing bound, below which lines are not known.

    Raise `BadInput` for a force that is 0 throughout, which has no lines.
    """
    if not result.amplitude.any():
        raise BadInput(f"The {result.force} force is 0 throughout and has no lines.")
    scale = force_scale(f"amplitude of the {result.force} force", float(result.amplitude.max()))
    amplitude, floor = result.amplitude / scale.factor, result.aliasing / scale.factor
    low = max(float(amplitude.max()) * 10.0**-_DECADES, 0.5 * floor)
    drawn = amplitude > low
    known = np.nonzero(amplitude > max(low, floor))[0]
    highest = float(result.frequency[known[-1] if len(known) else -1])
    hertz, letter = prefixed(highest)
    plot = empty_figure(name="spectrum", min_border=4, y_axis_type="log",
                        y_range=Range1d(low, 2.0 * float(amplitude.max())),
                        x_range=Range1d(-0.01 * highest / hertz, 1.05 * highest / hertz))
    source = ColumnDataSource(name="lines", data={"frequency": result.frequency[drawn] / hertz,
                                                  "amplitude": amplitude[drawn],
                                                  "phase": result.phase[drawn], "low": np.full(int(drawn.sum()), low)})
    if result.period:
        stems = plot.segment("frequency", "low", "frequency", "amplitude", source=source)
        themed(stems, line_color="output", line_width=2.4)
    else:
        themed(plot.line("frequency", "amplitude", source=source), line_color="output", line_width=1.6)
    heads = plot.scatter("frequency", "amplitude", source=source, size=5, line_color=None)
    themed(heads, fill_color="output")
    folded = plot.line([0.0, float(result.frequency[-1]) / hertz], [floor] * 2, line_dash=[4, 4], level="underlay",
                       legend_label="aliasing bound")
    themed(folded, line_color="soft", line_width=1.2)
    plot.add_tools(HoverTool(renderers=[heads], tooltips=[
        ("frequency", f"@frequency{{0.0000}} {letter}Hz"), ("amplitude", f"@amplitude{{0.0000}} {scale.unit}"),
        ("phase", "@phase{0.000} rad")]))
    plot.xaxis.axis_label, plot.yaxis.axis_label = f"frequency ({letter}Hz)", scale.label
    return apply_theme(plot, theme)
