"""The resonance curve: largest output force over drive frequency, by regime and by the start of the curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, GlyphRenderer, HoverTool, Line, Plot, Range1d, Scatter, Segment, Span

from granchain_core import CurvePoint, Run
from granchain_core.experiment import Difference, Feature, Measured, compared
from granchain_core.steady.curve.resonance import Place, place_of

from ..format import prefixed
from ..frames import round_up
from ..parts.figures.figure_style import bare_axis, bare_plot
from ..plots.axes import knob_scale
from ..plots.curve import CURVE_STYLES, curve_columns, curve_line, curve_marks, curve_tooltips
from ..plots.force_lines import OUTPUT
from ..plots.measured import COLUMNS, TOOLTIPS, measured_columns
from ..plots.theme import GREY
from ..plots.themed import themed
from ..serve.document.changes import set_properties
from ..serve.document.document_models import models_collected_once
from .pinned_curves import PinnedCurves


class CurveFigure:
    """The figure with two curves for every start (`CURVE_STARTS`): the present one and, in grey, the one before it.

    Lines and marks that most visitors never see are made when they are first needed.
    """

    def __init__(self, choose: Callable[[object], None]) -> None:
        self._points: dict[str, list[CurvePoint]] = {name: [] for name in CURVE_STYLES}
        self._grey_points: dict[str, list[CurvePoint]] = {name: [] for name in CURVE_STYLES}
        self._scale = (1.0, "")
        self._rest_complete = False
        #: Whether a curve from rest is being computed, or will be computed unasked.
        self.expected = False
        self._ordered: tuple[np.ndarray, np.ndarray, list[int | None]] | None = None
        self._shown: tuple[float, float | None] = (0.0, None)
        self._mark_state: tuple[object, ...] = ()
        self._motion_source = ColumnDataSource({"frequency": [], "force": []})
        self._measured = ColumnDataSource({name: [] for name in COLUMNS})
        self._features = ColumnDataSource({name: [] for name in ("frequency", "top", "label", "source")})
        self._measurement: Measured | None = None
        self._renderers: dict[str, list[GlyphRenderer]] = {name: [] for name in CURVE_STYLES}
        self._shown_starts = set(CURVE_STYLES)
        self.figure = self._frame(choose)
        self._pinned = PinnedCurves(self.figure)
        self._grey_sources: dict[str, ColumnDataSource] = {}
        self._sources: dict[str, ColumnDataSource] = {}
        # In the overlay, so that moving f repaints a line and a dot and not the whole curve.
        self._frequency_line = Span(dimension="height", line_color=GREY, line_width=1, level="overlay")
        self.figure.add_layout(self._frequency_line)
        self._marks()
        self._sources["rest"] = self._line("rest", grey=False)

    def _frame(self, choose: Callable[[float], None]) -> Plot:
        plot = bare_plot((58, 26), (5, 5), ("below", "left"), name="resonance curve", x_range=Range1d(0, 1),
                          y_range=Range1d(0, 1))
        plot.min_border_top = 10
        plot.min_border_bottom = 6
        plot.xaxis.axis_label = knob_scale("f").label
        bare_axis(plot.yaxis[0], OUTPUT.role)
        plot.on_event(Tap, lambda event: choose(event.x))
        return plot

    def _line(self, start: str, grey: bool) -> ColumnDataSource:
        source = ColumnDataSource(curve_columns([], 1.0))
        style = CURVE_STYLES[start]
        overrides = {"line_color": GREY, "line_width": 1.8, "line_alpha": 0.45} if grey else {}
        renderers = [self.figure.add_glyph(source, Line(
            **{**curve_line(start), "line_color": style.colour, **overrides}), level=style.level)]
        if not grey:
            marks = self.figure.add_glyph(source, Scatter(**curve_marks(start)))
            renderers.append(marks)
            self.figure.add_tools(HoverTool(renderers=[marks], tooltips=curve_tooltips(start)))
        for renderer in renderers:
            renderer.visible = start in self._shown_starts
        self._renderers[start] += renderers
        self._bring_forward()
        return source

    def _bring_forward(self) -> None:
        """Draw the paper's statements in front of the curves, whatever the order in which they were made."""
        others = [renderer for renderer in self.figure.renderers if renderer is not self._stated]
        self.figure.renderers = [*others, self._stated]

    def _marks(self) -> None:
        """Make the marks of stated features and of the current point, in front of the curves."""
        plot = self.figure
        self._stated = plot.add_glyph(self._features, Segment(
            x0="frequency", y0=0, x1="frequency", y1="top", line_color=GREY, line_width=3, line_dash=[1, 5],
            line_cap="round"))
        plot.add_tools(HoverTool(renderers=[self._stated], line_policy="interp",
                                 tooltips=[("stated", "@label"), ("source", "@source")]))
        ring = plot.add_glyph(self._motion_source, Scatter(x="frequency", y="force", size=15, fill_color=None,
                                                           line_width=3), level="overlay")
        self._dot = themed(ring, line_color="ink", size=15.0)
        self._bars: list[GlyphRenderer] = []

    def _measurement_marks(self) -> list[GlyphRenderer]:
        """Make the marks of the visitor's data: error bars and hollow squares."""
        bars = self.figure.add_glyph(self._measured, Segment(x0="frequency", y0="low", x1="frequency", y1="high",
                                                             line_width=1), level="overlay")
        dots = self.figure.add_glyph(self._measured, Scatter(x="frequency", y="force", marker="square", size=7,
                                                             fill_color=None, line_width=1.2), level="overlay")
        self.figure.add_tools(HoverTool(renderers=[dots], tooltips=TOOLTIPS))
        return [themed(marks, self.figure, line_color="ink") for marks in (bars, dots)]

    def set_compact(self, compact: bool) -> None:
        """Show fewer numbers on the axis if there is little room."""
        self.figure.xaxis[0].ticker.desired_num_ticks = 3 if compact else 5

    def set_range(self, low: float, high: float) -> None:
        """Set the range of frequencies shown."""
        self.figure.x_range.update(start=low, end=high)

    def show_only(self, starts: list[str]) -> None:
        """Make only the curves of these starts visible."""
        self._shown_starts = set(starts)
        for name, renderers in self._renderers.items():
            for renderer in renderers:
                renderer.visible = name in starts

    def begin(self, starts: list[str]) -> None:
        """Turn the present curves of these starts grey, because new ones follow."""
        self._rest_complete = self._rest_complete and "rest" not in starts
        for name in CURVE_STYLES:
            if name in starts:
                self._grey_points[name] = self._points[name] or self._grey_points[name]
                self._points[name] = []
                self._draw_grey(name)
                self._draw(name)

    def add(self, start: str, points: list[CurvePoint], covers_range: bool) -> None:
        """Add points; once they cover the range, remove the grey curve."""
        self._ordered = None
        self._points[start] += [point for point in points if np.isfinite(point.max_output_force)]
        if covers_range:
            self._grey_points[start] = []
            self._draw_grey(start)
        self._rescale()
        self._draw(start)

    def redraw(self, start: str, points: list[CurvePoint]) -> None:
        """Replace the present curve by a whole new one, while a knob moves."""
        self._rest_complete = self._rest_complete and start != "rest"
        self._points[start] = []
        self.add(start, points, covers_range=True)

    def pin(self, places: Sequence[tuple[str, float, float]]) -> None:
        """Mark pinned motions: name, frequency [Hz] and largest output force [N]."""
        self._pinned.places = list(places)
        self._rescale()
        self._pinned.draw(self._scale[0])

    def pinned_curves(self, curves: Sequence[list[CurvePoint]]) -> None:
        """Draw the pins' curves in order, dashed like their force trains; one equal to the present curve is empty."""
        if self._pinned.take(curves):
            self._rescale()
            self._pinned.draw(self._scale[0])

    @property
    def rest_complete(self) -> bool:
        """Whether the curve from rest is complete."""
        return self._rest_complete

    @property
    def factor(self) -> float:
        """Newtons for one unit of the axis."""
        return self._scale[0]

    def points(self, start: str) -> list[CurvePoint]:
        """Return the points of the curve from this start, in ascending frequency."""
        return sorted(self._points[start], key=lambda point: point.frequency)

    def place(self, run: Run) -> Place | None:
        """Return where a run lies on the complete curve from rest; None while that curve is being computed."""
        if not self._rest_complete:
            return None if self.expected else Place("")
        if self._ordered is None:
            points = self.points("rest")
            self._ordered = (np.array([p.frequency for p in points]), np.array([p.max_output_force for p in points]),
                             [p.regime.period for p in points])
        transmission = run.max_output_force / run.max_input_force if run.max_input_force > 0.0 else 0.0
        return place_of(*self._ordered, run.scene.f, run.max_output_force, transmission)

    def note_complete(self, start: str) -> None:
        """Note that all points of the curve from this start have been computed."""
        self._rest_complete = self._rest_complete or start == "rest"
        if self._measurement is not None:
            self.measured(self._measurement)

    def clear(self) -> None:
        """Remove all curves, because another scene was opened."""
        self._rest_complete = False
        for name in CURVE_STYLES:
            self._points[name], self._grey_points[name] = [], []
            self._draw(name)
            self._draw_grey(name)

    def mark_motion(self, frequency: float, force: float | None) -> None:
        """Mark the present motion; without a force, only its frequency."""
        shown = frequency, None if force is None else float(f"{force:.3g}")
        if (shown, self._scale) == self._mark_state:
            return
        self._shown, self._mark_state = shown, (shown, self._scale)
        set_properties(self._frequency_line, location=frequency)
        factor = self._scale[0]
        set_properties(self._motion_source, data={
            "frequency": [frequency] if force is not None else [],
            "force": [force / factor] if force is not None else []})

    def features(self, features: Sequence[Feature]) -> None:
        """Draw vertical marks at the frequencies that the paper states; it states no forces."""
        self._features.data = {
            "frequency": [f.frequency for f in features],
            "top": [self.figure.y_range.end] * len(features),
            "label": [f"{f.kind}, {f.repeats} repeats" for f in features],
            "source": [f.source for f in features],
        }
        self._rescale()

    def measured(self, measured: Measured | None) -> None:
        """Show the visitor's data with error bars, or remove them."""
        self._measurement = measured
        self._rescale()
        if measured is None:
            self._measured.data = {name: [] for name in COLUMNS}
            return
        if not self._bars:
            self._bars = self._measurement_marks()
        difference = self.difference
        residuals = None if difference is None else difference.residuals
        self._measured.data = measured_columns(measured, self._scale[0], residuals)

    @property
    def difference(self) -> Difference | None:
        """How the visitor's data differ from the curve from rest; None if one of the two is missing."""
        if self._measurement is None or not self._rest_complete:
            return None
        points = sorted(self._points["rest"], key=lambda point: point.frequency)
        return compared(self._measurement, np.array([point.frequency for point in points]),
                        np.array([point.max_output_force for point in points]))

    def _rescale(self) -> None:
        """Fit the force axis to all curves and measured data; redraw everything if its unit changes."""
        curves = (*self._points.values(), *self._grey_points.values())
        forces = [point.max_output_force for points in curves for point in points] + self._pinned.forces
        if self._measurement is not None:
            forces.append(float(np.max(self._measurement.force)))
        high = round_up(max(forces, default=1.0))
        scale = prefixed(high)
        if scale != self._scale:
            self._scale = scale
            for name in CURVE_STYLES:
                self._draw(name)
                self._draw_grey(name)
            self.mark_motion(*self._shown)
            self._pinned.draw(scale[0])
            if self._measurement is not None:
                self.measured(self._measurement)
        # Leave room for the names of the peaks and, above them, for the names of the stated features.
        set_properties(self.figure.y_range, end=(1.3 if self._features.data["top"] else 1.15) * high / scale[0])
        set_properties(self.figure.yaxis[0], axis_label=f"largest output force ({scale[1]}N)")
        top = [self.figure.y_range.end] * len(self._features.data["top"])
        if list(self._features.data["top"]) != top:
            self._features.data = {**self._features.data, "top": top}

    def _draw(self, start: str) -> None:
        self._fill(self._sources, start, self._points[start])

    def _draw_grey(self, start: str) -> None:
        self._fill(self._grey_sources, start, self._grey_points[start])

    def _fill(self, sources: dict[str, ColumnDataSource], start: str, points: list[CurvePoint]) -> None:
        """Draw the points of the curve from this start, in ascending frequency."""
        if points and start not in sources:
            with models_collected_once(self.figure.document):
                sources[start] = self._line(start, grey=sources is self._grey_sources)
        if start in sources:
            ordered = sorted(points, key=lambda point: point.frequency)
            larger = CURVE_STYLES[start].larger // 2  # the figure is small, and its points are close to each other
            set_properties(sources[start], data=curve_columns(ordered, self._scale[0], larger))
