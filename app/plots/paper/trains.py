"""Figures 6b, 7, 9b, 10 and 12: the shaker's velocity, input force and output force, with a column per frequency."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, LayoutDOM, LinearAxis, Range1d
from bokeh.plotting import figure

from granchain_core.paper import Column, Trains
from granchain_core.paper.results import SHOWN

from ..force_lines import MEASURED
from ..theme import Theme
from ..themed import apply_theme, empty_figure, themed
from .panels import fewer, grid, inside_legend

_MS = 1e3
_ROWS = (("velocity", "shaker velocity (mm/s)", 1e3, "drive"), ("input_force", "input force (N)", 1.0, "input"),
         ("output_force", "output force (N)", 1.0, "output"))


def trains(shown: Trains, theme: Theme) -> LayoutDOM:
    """Draw the panels, whose rows share a force axis; model (3) and measured series are drawn over model (5)."""
    time = Range1d(0.0, _MS * SHOWN)
    rows = []
    for name, label, unit, role in _ROWS:
        forces = Range1d(*_limits(shown, name, unit))
        panels = []
        for number, column in enumerate(shown.columns):
            plot = empty_figure(name=f"{name} at {column.named:g} Hz", x_range=time, y_range=forces, min_border=3)
            _line(plot, column.time, unit * getattr(column, name), role, "model (5)", label)
            if name == "velocity":
                _velocity(plot, column, number == len(shown.columns) - 1)
                plot.title.text = _heading(column)
            if name == "output_force" and column.observer_time is not None:
                _line(plot, column.observer_time, column.observer, "second", f"model (3), {column.observer_words}",
                      label, [6, 3])
            measured = None if column.measured is None else getattr(column.measured, name)
            if column.measured is not None and measured is not None:
                _line(plot, column.measured.time, unit * measured, MEASURED.role, column.measured.word, label,
                      width=MEASURED.width)
            if number == 0:
                plot.yaxis[0].axis_label = label
            if name == "output_force":
                plot.xaxis.axis_label = "time (ms)"
            apply_theme(plot, theme)
            inside_legend(plot, theme)
            for legend in plot.legend:
                legend.visible = len(legend.items) > 1
            panels.append(plot)
        rows.append(panels)
    return grid(rows)


def _heading(column: Column) -> str:
    scene = column.found.run.scene
    regime = column.found.regime
    kind = f"period {regime.period}" if regime.period else regime.name
    named = "" if scene.f == column.named else f", model at {scene.f:g} Hz"
    return f"{column.named:g} Hz{named}, {1e6 * scene.A0:g} µm, {kind}"


def _limits(shown: Trains, name: str, unit: float) -> tuple[float, float]:
    """Return the range of a row over all its columns."""
    every = [unit * getattr(column, name) for column in shown.columns]
    every += [unit * values for column in shown.columns if column.measured is not None
              if (values := getattr(column.measured, name)) is not None and len(values)]
    if name == "output_force":
        every += [column.observer for column in shown.columns if column.observer is not None]
    low, high = (float(pick([float(pick(v)) for v in every])) for pick in (np.min, np.max))
    room = 0.08 * (high - low)
    lines = 1 + (2 if name == "velocity" else 0) + any(column.measured is not None for column in shown.columns)
    lines += any(column.observer is not None and name == "output_force" for column in shown.columns)
    return low - room, high + 2.0 * lines * room  # with room for a legend of `lines` lines


def _line(plot: figure, time: Any, values: Any, role: str, words: str, label: str, dash: list[int] | None = None,
          width: float = 1.8) -> None:
    kept = fewer(np.asarray(values))
    source = ColumnDataSource({"time": np.asarray(_MS * time[kept], dtype=np.float32),
                               "value": np.asarray(values[kept], dtype=np.float32)}, name=words.split(",")[0])
    line = plot.line("time", "value", source=source, line_dash=dash or "solid", legend_label=words)
    themed(line, line_color=role, line_width=width)
    plot.add_tools(HoverTool(renderers=[line], mode="vline", tooltips=[
        ("", words), ("time", "@time{0.000} ms"), (label, "@value{0.000}")]))


def _velocity(plot: figure, column: Column, last: bool) -> None:
    """Draw the contact of driver and bead 1 on its own axis, and the paper's shaker if it ran at another frequency."""
    scene = column.found.run.scene
    plot.extra_y_ranges = {"contact": Range1d(-0.3, 3.2)}
    if last:
        plot.add_layout(LinearAxis(y_range_name="contact", ticker=[0, 1], axis_label="contact",
                                   axis_line_color=None, major_tick_line_color=None, minor_tick_line_color=None,
                                   axis_label_text_font_style="normal"), "right")
    changes = np.flatnonzero(np.diff(column.contact)) + 1
    kept = np.concatenate([[0], changes, [len(column.time) - 1]])
    step = plot.step(_MS * column.time[kept], column.contact[kept], mode="after", y_range_name="contact",
                     legend_label="driver touches bead 1")
    themed(step, line_color="output", line_width=1.6)
    if scene.f != column.named:
        amplitude = scene.A0 * scene.f / column.named
        velocity = 2.0 * math.pi * column.named * amplitude * np.cos(2.0 * math.pi * column.named * column.time)
        _line(plot, column.time, 1e3 * velocity, "soft", f"a shaker at {column.named:g} Hz with {1e6 * amplitude:g} µm",
              "velocity", [2, 3], 1.2)
