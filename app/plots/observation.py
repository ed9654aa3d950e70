"""An observation: the measured input force, the computed output force and, if there is one, the measured one."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool
from bokeh.plotting import figure

from granchain_core.observers import Observation

from ..format import prefixed
from .axes import force_scale
from .force_lines import INPUT, MEASURED, OUTPUT
from .theme import Theme
from .themed import apply_theme, empty_figure, themed


def observation(result: Observation, theme: Theme) -> figure:
    """Draw the input force, the computed output force and, if it was measured, the measured one over time."""
    measured = result.record.output
    forces = [result.input_force, result.output_force, *([] if measured is None else [measured])]
    scale = force_scale("force", max(float(np.nanmax(np.abs(force))) for force in forces))
    second, letter = prefixed(float(np.abs(result.time).max()))
    plot = empty_figure(name="observation", min_border=4)
    columns = {"time": result.time / second, "input": forces[0] / scale.factor, "output": forces[1] / scale.factor}
    lines = [("input", "input force, given", INPUT.role, 1.8), ("output", "output force, computed", OUTPUT.role, 2.4)]
    if measured is not None:
        columns["measured"] = measured / scale.factor
        lines.append(("measured", "output force, measured", MEASURED.role, MEASURED.width))
    source = ColumnDataSource(columns, name="forces")
    for name, words, role, width in lines:
        line = plot.line("time", name, source=source, legend_label=words)
        themed(line, line_color=role, line_width=width)
        plot.add_tools(HoverTool(renderers=[line], mode="vline", tooltips=[
            ("time", f"@time{{0.0000}} {letter}s"), (words, f"@{name}{{0.0000}} {scale.unit}")]))
    plot.title.text = (f"relative error {result.integration_error:.0e} of integration, "
                       f"{result.interpolation_error:.0e} between samples")
    plot.x_range.range_padding = 0.0
    plot.xaxis.axis_label, plot.yaxis.axis_label = f"time ({letter}s)", scale.label
    plot.legend.update(orientation="horizontal", padding=1, margin=2, click_policy="hide")
    plot.add_layout(plot.legend[0], "above")
    return apply_theme(plot, theme)
