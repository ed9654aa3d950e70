"""Figure 3: kinetic energy over bead and time beside the drive's displacement and the force on bead 1."""

from __future__ import annotations

import numpy as np
from bokeh.layouts import row
from bokeh.models import (
    BasicTicker,
    ColorBar,
    ColumnDataSource,
    HoverTool,
    LayoutDOM,
    LinearAxis,
    LinearColorMapper,
    Range1d,
    SingleIntervalTicker,
)
from bokeh.palettes import Inferno256
from bokeh.plotting import figure

from granchain_core import Settled
from granchain_core.paper import EnergyMaps
from granchain_core.paper.results import repeated

from ..theme import Theme, dress, frame, in_theme

_MS, _MICRO = 1e3, 1e6


def energy(shown: EnergyMaps, theme: Theme) -> LayoutDOM:
    """A pair of panels for each orbit, time downwards on both."""
    panels = []
    for found, periods in shown.parts:
        end = periods * _MS / found.run.scene.f
        time = Range1d(end, 0.0)
        panels += [_drive(found, periods, time, theme), _map(found, periods, time, theme)]
    return row(panels, sizing_mode="stretch_both")


def _drive(found: Settled, periods: int, time: Range1d, theme: Theme) -> figure:
    """Displacement in red over the lower axis, force in blue over the upper one."""
    index, seconds = repeated(found.run, periods)
    run = found.run
    plot = frame(name="drive", y_range=time, min_border=4, sizing_mode="stretch_height", width=190,
                 x_range=Range1d(-1.1 * _MICRO * run.scene.A0, 1.1 * _MICRO * run.scene.A0), toolbar_location=None)
    plot.extra_x_ranges = {"force": Range1d(-0.05 * run.max_input_force, 1.05 * run.max_input_force)}
    plot.add_layout(LinearAxis(x_range_name="force", axis_label="input force (N)", axis_line_color=None,
                               major_tick_line_color=None, minor_tick_line_color=None,
                               axis_label_text_font_style="normal"), "above")
    source = ColumnDataSource({"time": _MS * seconds, "displacement": _MICRO * run.drive_displacement[index],
                               "force": run.input_force[index]}, name="drive and force")
    in_theme(plot.line("displacement", "time", source=source), line_color="drive", line_width=1.8)
    in_theme(plot.line("force", "time", source=source, x_range_name="force"), line_color="input", line_width=1.8)
    plot.xaxis[1].axis_label = "displacement (µm)"
    plot.yaxis.axis_label = "time (ms)"
    plot.title.text = {"fig3a": "(a)", "fig3b": "(b)"}[run.scene.name]
    for axis in plot.xaxis:
        axis.ticker = BasicTicker(desired_num_ticks=3)
    return dress(plot, theme)


def _map(found: Settled, periods: int, time: Range1d, theme: Theme) -> figure:
    index, _ = repeated(found.run, periods)
    values = np.asarray(_MICRO * found.run.kinetic_energy[index], dtype=np.float32)
    beads = values.shape[1]
    plot = frame(name="energy", y_range=time, x_range=Range1d(0.5, beads + 0.5), min_border=4)
    plot.grid.visible = False
    plot.yaxis.visible = False
    plot.xaxis.axis_label = "bead"
    plot.xaxis[0].ticker = SingleIntervalTicker(interval=2 if beads > 8 else 1, num_minor_ticks=0)
    colours = LinearColorMapper(palette=list(Inferno256), low=0.0, high=float(values.max()))
    image = plot.image([values], x=0.5, y=0.0, dw=beads, dh=time.start, color_mapper=colours)
    plot.add_tools(HoverTool(renderers=[image], tooltips=[("bead", "$x{0}"), ("time", "$y{0.000} ms"),
                                                          ("kinetic energy", "@image{0.0000} µJ")]))
    bar = ColorBar(color_mapper=colours, width=12, padding=6, ticker=BasicTicker(desired_num_ticks=5),
                   background_fill_color=theme.card, major_label_text_color=theme.ink,
                   major_label_text_font_size=f"{theme.small - 2}px", bar_line_color=None)
    plot.add_layout(bar, "right")
    plot.title.text = f"{found.run.scene.f:g} Hz, period {found.regime.period}: kinetic energy (µJ)"
    return dress(plot, theme)
