"""The force trains next to the map: drive and input force on the left, output force on the right.

These figures are made once and follow every knob; app/plots/motion.py draws the same for files and notebooks.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from bokeh.models import BasicTicker, ColumnDataSource, GlyphRenderer, Line, LinearAxis, Plot, Range1d, Span

from granchain_core import Run

from ...format import figures_of, prefixed, with_decimals, with_figures
from ...frames import Extremes, Frames, round_up
from ...plots.force_lines import DRIVE, ELASTIC, INPUT, OUTPUT, LineStyle, columns, force_columns
from ...plots.themed import themed
from ...serve.document.changes import set_properties
from ..figures.figure_style import GAP, LEFT, bare_axis, bare_plot
from .measured_trains import MeasuredTrains
from .pinned_trains import PinnedTrains

if TYPE_CHECKING:
    from granchain_core.fitting.overlay import Overlay

#: The lines in the order in which they are drawn, and the lines that have an axis.
_LINES = (DRIVE, INPUT, ELASTIC, OUTPUT)
_AXES = (DRIVE, INPUT, OUTPUT)
#: The style of the lines at zero, which are at different places for drive and force.
_ZERO: dict[str, Any] = {"line_width": 1, "line_alpha": 0.35, "level": "underlay"}
#: Approximate numbers of ticks of a force axis and of the time axis.
_TICKS = (3, 6)
#: The smallest number that is written in the unit of an axis.
_SMALLEST_READABLE = 0.01
#: Largest number of figures of a force under its axis, where there is little room.
_PEAK_FIGURES = 3
#: Smallest pull that is shown next to the largest force, as a fraction of that force.
_SHOWN_PULL = 0.01
#: Smallest pressure of an always pressed contact that is shown next to the largest force, as a fraction of that force.
_SHOWN_PRESSURE = 0.2
#: Widest titles of the axes. The browser measures them and says whether there is room for them (`set_compact`).
WIDEST_TITLES = {"left": INPUT.label("mN"), "right": OUTPUT.label("mN")}


class ForceTrains:
    """Two figures and one data source; time runs downwards on the axis they share with the map."""

    def __init__(self, time: Range1d) -> None:
        self._source = ColumnDataSource({name: np.zeros(0) for name in ("time", "drive", "elastic")})
        # A force that jumps has extra points at its jumps, between the rows.
        self._input = ColumnDataSource({name: np.zeros(0) for name in ("time", "force")})
        self._output = ColumnDataSource({name: np.zeros(0) for name in ("time", "force")})
        self._lines: list[GlyphRenderer] = []
        self._compact = False
        self._units = ("m", "N", "N")
        self._factors = (1.0, 1.0)
        self.left = self._left_figure(time)
        self.right = self._right_figure(time)
        for line, style in zip(self._lines, _LINES, strict=True):
            themed(line, line_width=style.width)
        self._axes = [*self.left.xaxis, *self.right.xaxis]
        self._time_axis = self.left.yaxis[0]
        self._pinned = PinnedTrains(self.left, self.right)
        self._measured = MeasuredTrains(self.left, self.right)

    def _left_figure(self, time: Range1d) -> Plot:
        plot = bare_plot((LEFT, GAP), _TICKS, ("below", "left"), (1,), name="input force", y_range=time,
                          x_range=Range1d(-1, 1), extra_x_ranges={"drive": Range1d(-1, 1)})
        axis = LinearAxis(x_range_name="drive", ticker=BasicTicker(desired_num_ticks=_TICKS[0], num_minor_ticks=0))
        bare_axis(axis, DRIVE.role)
        plot.add_layout(axis, "above")
        bare_axis(plot.xaxis[1], INPUT.role)
        plot.yaxis.axis_label = "time"
        self._zero_of_drive = Span(location=0, dimension="height", x_range_name="drive", line_color=DRIVE.colour,
                                   **_ZERO)
        plot.add_layout(self._zero_of_drive)
        plot.add_layout(Span(location=0, dimension="height", line_color=INPUT.colour, **_ZERO))
        self._lines += [
            plot.add_glyph(self._source, _glyph(DRIVE, "drive"), x_range_name="drive"),
            plot.add_glyph(self._input, _glyph(INPUT)),
        ]
        return plot

    def _right_figure(self, time: Range1d) -> Plot:
        plot = bare_plot((GAP, 14), _TICKS, ("below", None), (1,), name="output force", y_range=time,
                          x_range=Range1d(0, 1))
        bare_axis(plot.xaxis[0], OUTPUT.role)
        plot.add_layout(Span(location=0, dimension="height", line_color=OUTPUT.colour, **_ZERO))
        self._lines += [
            plot.add_glyph(self._source, _glyph(ELASTIC, "elastic")),
            plot.add_glyph(self._output, _glyph(OUTPUT)),
        ]
        return plot

    def update(self, frames: Frames, time: np.ndarray, high: Extremes, driven: bool) -> None:
        """Show `frames`, whose rows are at `time` on the shared axis, on axes that end at the forces of `high`.

        A chain that is not `driven` has no drive line and no axis for it.
        """
        set_properties(self._axes[0], visible=driven)
        set_properties(self._lines[0], visible=driven)
        set_properties(self._zero_of_drive, visible=driven)
        far = -1 if frames.time[-1] else 0  # in a live picture, the last row is the present, time 0
        scale = float(time[far] / frames.time[far]) if frames.time[far] else 1.0
        moved = max(float(np.abs(frames.drive_displacement).max()), self._measured.largest_displacement)
        drive_high = round_up(moved)
        pinned, measured = self._pinned.largest, self._measured.largest
        input_range = _span(max(high.input_force, pinned[0], measured[0]), high.input_pull, frames.input_force,
                            frames.input_jumps[:, 1])
        output_range = _span(max(high.output_force, pinned[1], measured[1]), high.output_pull, frames.output_force,
                             frames.output_jumps[:, 1], frames.output_force_elastic)
        drive, drive_letter = prefixed(drive_high)
        push, push_letter = prefixed(max(map(abs, input_range)))
        out, out_letter = prefixed(max(map(abs, output_range)))
        set_properties(self._source, data=columns(time, drive=(frames.drive_displacement, drive),
                                          elastic=(frames.output_force_elastic, out)))
        set_properties(self._input, data=force_columns(time, frames.input_force, push, frames.input_jumps, scale))
        set_properties(self._output, data=force_columns(time, frames.output_force, out, frames.output_jumps, scale))
        shown = 0.0 if frames.time[-1] == 0.0 else float(frames.time[-1])
        self._pinned.update(shown, scale, push, out)
        self._measured.update(shown, scale, push, out, drive)
        edge = 1.15 * drive_high / drive
        set_properties(self.left.extra_x_ranges["drive"], start=-edge, end=edge)
        set_properties(self.left.x_range, start=input_range[0] / push, end=input_range[1] / push)
        set_properties(self.right.x_range, start=output_range[0] / out, end=output_range[1] / out)
        self._units, self._factors = (f"{drive_letter}m", f"{push_letter}N", f"{out_letter}N"), (push, out)
        self._write_titles()

    def name_time(self, title: str) -> None:
        """Set the title of the time axis."""
        set_properties(self._time_axis, axis_label=title)

    def peak_words(self, frames: Frames, largest: tuple[float, float],
                   errors: tuple[float | None, float | None]) -> list[list[str]]:
        """Return the picture's largest input and output force [N], to the figures that their relative errors leave.

        Each comes with the smallest force of the rows if that is informative: if the contact pulls, or is never free of
        force. A pull has only one figure, since it may be larger between the rows.
        """
        words = []
        for series, force, error, axis, unit in zip((frames.input_force, frames.output_force), largest, errors,
                                                    self._factors, self._units[1:], strict=True):
            lowest = float(series.min())
            factor, unit = self._readable(max(force, -lowest), axis, unit)
            most = with_figures(force / factor, figures_of(error, _PEAK_FIGURES))
            words.append([f"max {most}\N{NO-BREAK SPACE}{unit}", ""])
            if lowest < -_SHOWN_PULL * force:
                words[-1][1] = f"min ≈ {with_figures(lowest / factor, 1)}\N{NO-BREAK SPACE}{unit}"
            elif lowest > _SHOWN_PRESSURE * force:
                decimals = len(most.partition(".")[2])  # so that the smallest never seems larger than the largest
                words[-1][1] = f"min ≈ {with_decimals(lowest / factor, decimals)}\N{NO-BREAK SPACE}{unit}"
        return words

    def output_words(self, force: float, error: float | None) -> str:
        """Return a force at the wall [N] in the unit of its axis, or its own; `error` sets the number of figures."""
        factor, unit = self._readable(force, self._factors[1], self._units[2])
        return f"{'about ' if error is None else ''}{with_figures(force / factor, figures_of(error))} {unit}"

    @staticmethod
    def _readable(force: float, factor: float, unit: str) -> tuple[float, str]:
        """Return the unit of an axis or, if `force` is too small for it, a unit of its own."""
        if force >= _SMALLEST_READABLE * factor:
            return factor, unit
        factor, letter = prefixed(force)
        return factor, f"{letter}N"

    def pin(self, runs: Sequence[Run | None]) -> None:
        """Pin these motions as dashed grey lines over the same time; None leaves a place empty."""
        self._pinned.load(runs)

    def measured(self, shown: Overlay | None) -> None:
        """Draw a measured series over the picture, or remove it."""
        self._measured.load(shown)

    def set_compact(self, compact: bool) -> None:
        """Show fewer ticks and shorter titles if there is little room."""
        self._compact = compact
        for axis in self._axes:
            axis.ticker.desired_num_ticks = 2 if compact else 3
        self._write_titles()

    def _write_titles(self) -> None:
        for axis, style, unit in zip(self._axes, _AXES, self._units, strict=True):
            set_properties(axis, axis_label=style.label(unit, self._compact))


def _glyph(style: LineStyle, column: str = "force") -> Line:
    """Return a line over time, which draws `column` of its source."""
    return Line(x=column, y="time", line_color=style.colour, line_width=style.width, line_dash=list(style.dash))


def _span(largest: float, pull: float, *series: np.ndarray) -> tuple[float, float]:
    """Return a range from −`pull` to `largest` that contains all values and does not follow small changes of them."""
    high = round_up(max(largest, *(float(s.max(initial=0.0)) for s in series)))
    pull = max(pull, *(float(-s.min(initial=0.0)) for s in series))
    return (-0.06 * high if pull < 0.02 * high else -round_up(pull)), 1.04 * high
