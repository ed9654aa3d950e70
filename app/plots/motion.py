"""A motion over time, which runs downwards: drive and input force, kinetic energy over the beads, output force.

The arrangement, titles, colours and lines are those of the page's main picture (`force_lines`, `energies`). The page
draws its main picture in app/parts/time_figures, because that follows every knob: its figures are created once and only
get new data, all its axes can change their range, and the chain is above the energies. Here the axes are as long as the
motion needs, and the energies have numbers below, a colour bar and a title.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.layouts import row
from bokeh.models import (
    BasicTicker,
    ColumnDataSource,
    HoverTool,
    LayoutDOM,
    LinearAxis,
    Range1d,
    SingleIntervalTicker,
)
from bokeh.plotting import figure

from granchain_core import Driven, Run
from granchain_core.experiment import Series, compared_forces

from ..format import prefixed
from .energies import bead_interval, energy_bar, energy_hover, energy_mapper
from .force_lines import DRIVE, ELASTIC, INPUT, MEASURED, OUTPUT, LineStyle, columns, force_columns
from .theme import Theme
from .themed import apply_theme, empty_figure, follow_theme, themed

#: Most rows of the energy map, and most points of a line.
_MOST_ROWS = 2000
#: Width of the panels next to the energies [px].
_SIDE_WIDTH = 190

#: A recorded motion of a chain whose driver moved harmonically, or by a signal.
Recorded = Run | Driven
#: A factor in SI and the name of the unit that it represents.
Scaled = tuple[float, str]


@dataclass(frozen=True)
class Units:
    """The units of the axes: time, length, force, energy."""

    time: Scaled
    length: Scaled
    force: Scaled
    energy: Scaled

    @classmethod
    def of(cls, run: Recorded) -> Units:
        """Return units in which the numbers of a run are easy to read."""
        def unit(values: np.ndarray, name: str) -> Scaled:
            factor, letter = prefixed(float(np.abs(values).max()))
            return factor, letter + name

        return cls(unit(run.time, "s"), unit(run.drive_displacement, "m"), unit(run.force[:, [0, -1]], "N"),
                   unit(run.kinetic_energy, "J"))


def motion(run: Recorded, theme: Theme) -> LayoutDOM:
    """Draw a recorded motion, arranged as on the page; a long motion is thinned out evenly."""
    return row(_panels(run, theme), sizing_mode="stretch_both")


def driven(run: Driven, theme: Theme, measured: Series | None = None) -> LayoutDOM:
    """Draw a driven motion, with the measured forces of its series as thin lines over the computed ones."""
    panels = _panels(run, theme)
    if measured is None:
        return row(panels, sizing_mode="stretch_both")
    differences, units = compared_forces(measured, run), Units.of(run)
    for name, plot in (("input_force", panels[0]), ("output_force", panels[2])):
        if name in differences:
            _measured_over(plot, measured, getattr(measured, name), units)
            words = f"thin: {measured.word}"
            plot.title.text = f"{plot.title.text}\n{words}" if plot.title.text else words
            follow_theme(plot, theme)
    return row(panels, sizing_mode="stretch_both")


def _panels(run: Recorded, theme: Theme) -> list[figure]:
    """Draw the drive with the input force, the energies, and the output force."""
    units, index = Units.of(run), np.arange(0, len(run.time), max(1, -(-len(run.time) // _MOST_ROWS)))
    seconds = run.time[index]
    time = Range1d(float(seconds[-1]) / units.time[0], float(seconds[0]) / units.time[0])
    return [drive_panel(run, index, seconds, time, units, theme, jumps=True),
            energy_panel(run, index, time, units, theme), _output_panel(run, index, time, units, theme)]


def _measured_over(plot: figure, measured: Series, force: np.ndarray, units: Units) -> None:
    """Draw a measured force in front of a computed one, and make room for it."""
    (second, _), (newton, _) = units.time, units.force
    data = columns(measured.time / second, force=(force, newton))
    _line(plot, MEASURED, ColumnDataSource(data, name=f"{measured.word} {plot.name}"), level="overlay")
    low, high, axis = float(force.min()) / newton, float(force.max()) / newton, plot.x_range
    margin = 0.05 * max(high - low, axis.end - axis.start)
    axis.update(start=min(axis.start, low - margin), end=max(axis.end, high + margin))


def drive_panel(run: Recorded, index: np.ndarray, seconds: np.ndarray, time: Range1d, units: Units, theme: Theme,
                jumps: bool = False) -> figure:
    """Draw the force on bead 1 over the lower axis, and the driver's displacement over the upper one.

    `index` selects the rows that are drawn, at `seconds`. `jumps` adds the points at which the force jumps.
    """
    (second, second_unit), (length, length_unit), (force, force_unit) = units.time, units.length, units.force
    farthest = run.scene.A0 if isinstance(run, Run) else float(np.abs(run.drive_displacement).max())
    amplitude, largest = farthest / length or 1.0, run.max_input_force / force or 1.0
    lowest = min(0.0, float(run.input_force.min()) / force)
    plot = empty_figure(name="drive", y_range=time, min_border=4, sizing_mode="stretch_height", width=_SIDE_WIDTH,
                        x_range=Range1d(1.05 * lowest - 0.05 * largest, 1.05 * largest), toolbar_location=None)
    plot.extra_x_ranges = {"drive": Range1d(-1.15 * amplitude, 1.15 * amplitude)}
    plot.add_layout(LinearAxis(x_range_name="drive", axis_line_color=None, major_tick_line_color=None,
                               minor_tick_line_color=None, axis_label_text_font_style="normal"), "above")
    drive = ColumnDataSource(columns(seconds / second, drive=(run.drive_displacement[index], length)),
                             name="displacement")
    _line(plot, DRIVE, drive, "drive", x_range_name="drive")
    pushed = _forces(run, 0, index, seconds, units) if jumps else columns(seconds / second,
                                                                          force=(run.input_force[index], force))
    _line(plot, INPUT, ColumnDataSource(pushed, name=INPUT.title))
    plot.yaxis.axis_label = f"time ({second_unit})"
    apply_theme(plot, theme)
    for axis, style, unit in zip(plot.xaxis, (DRIVE, INPUT), (length_unit, force_unit), strict=True):
        _axis(axis, style, unit, theme)
    return plot


def energy_panel(run: Recorded, index: np.ndarray, time: Range1d, units: Units, theme: Theme) -> figure:
    """Draw the kinetic energy over bead and time, between the ends of the range `time`, in the page's colours."""
    factor, unit = units.energy
    values = np.asarray(run.kinetic_energy[index] / factor, dtype=np.float32)
    beads = values.shape[1]
    plot = empty_figure(name="energy", y_range=time, x_range=Range1d(0.5, beads + 0.5), min_border=4)
    plot.grid.visible = False
    plot.yaxis.visible = False
    plot.xaxis.axis_label = "bead"
    plot.xaxis[0].ticker = SingleIntervalTicker(interval=bead_interval(beads, 6), num_minor_ticks=0)
    colours = energy_mapper(float(values.max()) or 1.0)
    image = plot.image([values], x=0.5, y=time.end, dw=beads, dh=time.start - time.end, color_mapper=colours)
    plot.add_tools(HoverTool(renderers=[image], tooltips=energy_hover(units.time[1], unit)))
    plot.add_layout(energy_bar(colours, theme), "right")
    plot.title.text = f"{_named(run)}: kinetic energy ({unit})"
    return apply_theme(plot, theme)


def _named(run: Recorded) -> str:
    """Return the drive of the chain in words, with the regime if there is one."""
    if not isinstance(run, Run):
        return run.signal.words
    if not run.scene.is_driven:
        return "no drive"
    period = run.regime.period
    return f"{run.scene.f:g} Hz, {f'period {period}' if period else run.regime.name}"


def _output_panel(run: Recorded, index: np.ndarray, time: Range1d, units: Units, theme: Theme) -> figure:
    """Draw the force on the wall, with its elastic part dashed."""
    force, unit = units.force
    low = min(0.0, float(run.output_force.min()) / force)
    high = run.max_output_force / force or 1.0
    plot = empty_figure(name="output", y_range=time, min_border=4, sizing_mode="stretch_height", width=_SIDE_WIDTH,
                        x_range=Range1d(1.05 * low - 0.05 * high, 1.05 * high), toolbar_location=None)
    plot.yaxis.visible = False
    elastic = columns(run.time[index] / units.time[0], force=(run.output_force_elastic[index], force))
    _line(plot, ELASTIC, ColumnDataSource(elastic, name=ELASTIC.title))
    _line(plot, OUTPUT, ColumnDataSource(_forces(run, run.scene.N, index, run.time[index], units), name=OUTPUT.title))
    plot.title.text = "dashed: elastic"
    apply_theme(plot, theme)
    _axis(plot.xaxis[0], OUTPUT, unit, theme)
    return plot


def _line(plot: figure, style: LineStyle, source: ColumnDataSource, column: str = "force", **options: Any) -> None:
    """Draw a line of the motion: `column` of the source over time."""
    line = plot.line(column, "time", source=source, line_dash=list(style.dash), **options)
    themed(line, line_color=style.role, line_width=style.width)


def _axis(axis: Any, style: LineStyle, unit: str, theme: Theme) -> None:
    """Style the axis of a line: its label has the line's colour, which shows whose axis it is if there are two."""
    axis.update(axis_label=style.label(unit), axis_label_text_color=getattr(theme, f"{style.role}_text"),
                ticker=BasicTicker(desired_num_ticks=3))


def _forces(run: Recorded, contact: int, index: np.ndarray, seconds: np.ndarray, units: Units) -> dict[str, np.ndarray]:
    """Return a contact's force with the points at which it jumps; a motion under a signal records no jumps."""
    jumps = np.stack(run.jumps.of(contact), axis=1) if isinstance(run, Run) else np.zeros((0, 2))
    jumps = jumps[(jumps[:, 0] >= run.time[0]) & (jumps[:, 0] <= run.time[-1])]
    second, force = units.time[0], units.force[0]
    return force_columns(seconds / second, run.force[index, contact], force, jumps, 1.0 / second)
