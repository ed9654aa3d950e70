"""The resonance curve: largest output force over drive frequency, by regime and by direction of the sweep."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, GlyphRenderer, HoverTool, Range1d, Span
from bokeh.plotting import figure

from granchain_core import CurvePoint, Run
from granchain_core.experiment import Difference, Feature, Measured, compared
from granchain_core.steady.curve.resonance import Place, place_of

from ...format import prefixed
from ...frames import round_up
from ...parts.figure_style import OUTPUT, quiet_axis, quiet_figure
from ...parts.pinned_trains import DASHES as PIN_DASHES
from ...pictures.curve import DASHES, curve_columns, curve_tooltips
from ...pictures.measured import COLUMNS, TOOLTIPS, measured_columns
from ...pictures.regimes import REGIMES, SYMBOLS, regime_key
from ...pictures.theme import GREY


class Curve:
    """The figure with, for every direction, the curve being computed and the one before it in grey."""

    def __init__(self, choose: Callable[[object], None]) -> None:
        self._points: dict[str, list[CurvePoint]] = {name: [] for name in DASHES}
        self._before: dict[str, list[CurvePoint]] = {name: [] for name in DASHES}
        self._scale = (1.0, "")
        self._whole = False
        self._shown: tuple[float, float | None] = (0.0, None)
        self._place: tuple[object, ...] = ()
        self._now = ColumnDataSource({"frequency": [], "force": []})
        self._measured = ColumnDataSource({name: [] for name in COLUMNS})
        self._features = ColumnDataSource({name: [] for name in ("frequency", "top", "label", "source")})
        self._pins = ColumnDataSource({name: [] for name in ("frequency", "force", "name")})
        self._pinned: list[tuple[str, float, float]] = []
        self._ghosts: list[list[CurvePoint]] = []
        self._measurement: Measured | None = None
        self._renderers: dict[str, list[GlyphRenderer]] = {name: [] for name in DASHES}
        self.figure = self._frame(choose)
        self._ghost_lines = [self._ghost(dash) for dash in PIN_DASHES]
        self._old = {name: self._line(name, grey=True) for name in DASHES}
        self._new = {name: self._line(name, grey=False) for name in DASHES}
        # In the overlay, so that moving f repaints a line and a dot and not the whole curve.
        self._current = Span(dimension="height", line_color=GREY, line_width=1, level="overlay")
        self.figure.add_layout(self._current)
        self._marks()

    def _frame(self, choose: Callable[[float], None]) -> figure:
        plot = quiet_figure(58, 26, name="resonance curve", x_range=Range1d(0, 1), y_range=Range1d(0, 1))
        plot.min_border_top = 10
        plot.min_border_bottom = 6
        plot.xaxis.axis_label = "drive frequency f (Hz)"
        quiet_axis(plot.yaxis[0], OUTPUT)
        plot.on_event(Tap, lambda event: choose(event.x))
        for axis in (plot.xaxis[0], plot.yaxis[0]):
            axis.ticker.desired_num_ticks = 5
            axis.ticker.num_minor_ticks = 0
        return plot

    def _line(self, direction: str, grey: bool) -> ColumnDataSource:
        source = ColumnDataSource(curve_columns([], 1.0))
        line = self.figure.line(
            "frequency", "force", source=source, line_dash=DASHES[direction] or "solid",
            line_color=GREY if grey else OUTPUT, line_width=1.5, line_alpha=0.45 if grey else 0.9)
        self._renderers[direction].append(line)
        if not grey:
            marks = self.figure.scatter(
                "frequency", "force", source=source, marker="marker", size="size", fill_color="colour",
                line_color="colour", line_width=1.5)
            self._renderers[direction].append(marks)
            self.figure.add_tools(HoverTool(renderers=[marks], tooltips=curve_tooltips(direction)))
        return source

    def _ghost(self, dash: list[int]) -> ColumnDataSource:
        source = ColumnDataSource({"frequency": [], "force": []})
        self.figure.line("frequency", "force", source=source, line_dash=dash, line_color=GREY, line_width=1.5,
                         level="underlay")
        return source

    def _marks(self) -> None:
        """Stated features, the visitor's data and the current point, in front of the curves."""
        plot = self.figure
        feature = plot.segment("frequency", 0, "frequency", "top", source=self._features, line_color=GREY,
                               line_width=3, line_dash=[1, 5], line_cap="round")
        self._labels = plot.text("frequency", "top", "label", source=self._features, angle=np.pi / 2,
                                 text_align="right", text_baseline="bottom", text_font_size="12px",
                                 text_color=GREY, x_offset=-3)
        plot.add_tools(HoverTool(renderers=[feature], line_policy="interp",
                                 tooltips=[("stated", "@label"), ("source", "@source")]))
        self._bars = plot.segment("frequency", "low", "frequency", "high", source=self._measured, line_width=1,
                                  level="overlay")
        self._dots = plot.scatter("frequency", "force", source=self._measured, marker="square", size=7,
                                  fill_color=None, line_width=1.2, level="overlay")
        plot.add_tools(HoverTool(renderers=[self._dots], tooltips=TOOLTIPS))
        self._pin_marks = plot.scatter("frequency", "force", source=self._pins, marker="circle", size=17,
                                       fill_color=None, line_width=1.5, line_dash=[3, 2], level="overlay")
        self._pin_names = plot.text("frequency", "force", "name", source=self._pins, text_align="center",
                                    text_baseline="top", y_offset=10, text_font_size="13px",
                                    text_font_style="bold", level="overlay")
        self._dot = plot.scatter("frequency", "force", source=self._now, size=15, fill_color=None,
                                 line_width=3, level="overlay")

    def fit(self, narrow: bool) -> None:
        """Fewer numbers on the axis where there is little room."""
        self.figure.xaxis[0].ticker.desired_num_ticks = 3 if narrow else 5

    def ink(self, colour: str, thick: float) -> None:
        """The colour of measured data and of the current point's ring: dark on light, light on dark."""
        for renderer in (self._bars, self._dots, self._dot, self._pin_marks):
            renderer.glyph.line_color = colour
        for names in (self._labels, self._pin_names):
            names.glyph.text_color = colour
        self._dot.glyph.size = 15 * thick

    def range(self, low: float, high: float) -> None:
        """Set the range of frequencies shown."""
        self.figure.x_range.update(start=low, end=high)

    def show_directions(self, directions: list[str]) -> None:
        """Make only these directions visible."""
        for name, renderers in self._renderers.items():
            for renderer in renderers:
                renderer.visible = name in directions

    def begin(self, directions: list[str]) -> None:
        """Make the present curves of these directions grey, because new ones will come."""
        self._whole = self._whole and "rest" not in directions
        for name in DASHES:
            if name in directions:
                self._before[name] = self._points[name] or self._before[name]
                self._points[name] = []
                self._draw_before(name)
                self._draw(name)

    def add(self, direction: str, points: list[CurvePoint], covers: bool) -> None:
        """Add points; once they cover the range the grey curve is removed."""
        self._points[direction] += [point for point in points if np.isfinite(point.max_output_force)]
        if covers:
            self._before[direction] = []
            self._draw_before(direction)
        self._rescale()
        self._draw(direction)

    def redraw(self, direction: str, points: list[CurvePoint]) -> None:
        """Draw a whole curve in place of the present one, while a knob moves."""
        self._whole = self._whole and direction != "rest"
        self._points[direction] = []
        self.add(direction, points, covers=True)

    def pin(self, places: Sequence[tuple[str, float, float]]) -> None:
        """Mark pinned motions: name, frequency [Hz] and largest output force [N]."""
        self._pinned = list(places)
        self._rescale()
        self._draw_pins()

    def pinned_curves(self, curves: Sequence[list[CurvePoint]]) -> None:
        """Draw the curves of the pins, in their order, dashed as their trains are; an empty one is the present one."""
        if [*map(len, curves)] == [*map(len, self._ghosts)] == [0] * len(curves):
            return
        self._ghosts = [[point for point in points if np.isfinite(point.max_output_force)] for points in curves]
        self._rescale()
        self._draw_pins()

    def _draw_pins(self) -> None:
        factor = self._scale[0]
        names, frequencies, forces = zip(*self._pinned, strict=True) if self._pinned else ((), (), ())
        self._pins.data = {"name": list(names), "frequency": list(frequencies),
                           "force": [force / factor for force in forces]}
        for place, source in enumerate(self._ghost_lines):
            points = self._ghosts[place] if place < len(self._ghosts) else []
            if points or len(source.data["frequency"]):
                source.data = {"frequency": [p.frequency for p in points],
                               "force": [p.max_output_force / factor for p in points]}

    @property
    def whole(self) -> bool:
        """Whether the curve from rest is complete."""
        return self._whole

    @property
    def factor(self) -> float:
        """Newtons for one unit of the axis."""
        return self._scale[0]

    def points(self, direction: str) -> list[CurvePoint]:
        """The points of a direction in ascending frequency."""
        return sorted(self._points[direction], key=lambda point: point.frequency)

    def kinds(self) -> list[dict[str, str]]:
        """Name, symbol and colour of every mark that the curves have, for a key."""
        drawn = {regime_key(p.regime.name, p.regime.period) for points in self._points.values() for p in points}
        return [{"name": name, "symbol": SYMBOLS[marker], "colour": colour}
                for name, (marker, colour, _) in REGIMES.items() if name in drawn]

    def place(self, run: Run) -> Place | None:
        """Where a run lies on the whole curve from rest; None while there is none."""
        if not self._whole:
            return None
        points = self.points("rest")
        transmission = run.max_output_force / run.max_input_force if run.max_input_force > 0.0 else 0.0
        return place_of([p.frequency for p in points], [p.max_output_force for p in points],
                        [p.regime.period for p in points], run.scene.f, run.max_output_force, transmission)

    def finished(self, direction: str) -> None:
        """All points of a direction are there."""
        self._whole = self._whole or direction == "rest"
        if self._measurement is not None:
            self.measured(self._measurement)

    def clear(self) -> None:
        """Remove all curves, because another scene was opened."""
        self._whole = False
        for name in DASHES:
            self._points[name], self._before[name] = [], []
            self._draw(name)
            self._draw_before(name)

    def now(self, frequency: float, force: float | None) -> None:
        """Mark the current point; without a force, only its frequency."""
        shown = frequency, None if force is None else float(f"{force:.3g}")
        if (shown, self._scale) == self._place:
            return
        self._shown, self._place = shown, (shown, self._scale)
        self._current.location = frequency
        factor = self._scale[0]
        self._now.data = {"frequency": [frequency] if force is not None else [],
                          "force": [force / factor] if force is not None else []}

    def features(self, features: Sequence[Feature]) -> None:
        """Draw vertical marks at the frequencies that the paper states; it states no forces."""
        self._features.data = {
            "frequency": [f.frequency for f in features],
            "top": [self.figure.y_range.end] * len(features),
            "label": [f"{f.kind}, {f.repeats} repeats" for f in features],
            "source": [f.source for f in features],
        }

    def measured(self, measured: Measured | None) -> None:
        """Show the visitor's own data with error bars, or none."""
        self._measurement = measured
        self._rescale()
        if measured is None:
            self._measured.data = {name: [] for name in COLUMNS}
            return
        found = self.difference
        self._measured.data = measured_columns(measured, self._scale[0], None if found is None else found.residuals)

    @property
    def difference(self) -> Difference | None:
        """The visitor's data beside the curve from rest; None where either is not there."""
        if self._measurement is None or not self._whole:
            return None
        points = sorted(self._points["rest"], key=lambda point: point.frequency)
        return compared(self._measurement, np.array([point.frequency for point in points]),
                        np.array([point.max_output_force for point in points]))

    def _rescale(self) -> None:
        curves = (*self._points.values(), *self._before.values(), *self._ghosts)
        forces = [point.max_output_force for points in curves for point in points]
        forces += [force for _, _, force in self._pinned]
        if self._measurement is not None:
            forces.append(float(np.max(self._measurement.force)))
        high = round_up(max(forces, default=1.0))
        scale = prefixed(high)
        if scale != self._scale:
            self._scale = scale
            for name in DASHES:
                self._draw(name)
                self._draw_before(name)
            self.now(*self._shown)
            self._draw_pins()
            if self._measurement is not None:
                self.measured(self._measurement)
        self.figure.y_range.end = 1.15 * high / scale[0]  # room for the names of the peaks
        self.figure.yaxis[0].axis_label = f"output force ({scale[1]}N)"  # its heading says that it is the largest
        top = [self.figure.y_range.end] * len(self._features.data["top"])
        if list(self._features.data["top"]) != top:
            self._features.data = {**self._features.data, "top": top}

    def _draw(self, direction: str) -> None:
        self._new[direction].data = self._columns(self._points[direction])

    def _draw_before(self, direction: str) -> None:
        self._old[direction].data = self._columns(self._before[direction])

    def _columns(self, points: list[CurvePoint]) -> dict[str, Any]:
        return curve_columns(sorted(points, key=lambda point: point.frequency), self._scale[0])
