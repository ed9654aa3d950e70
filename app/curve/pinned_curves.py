"""Pinned motions on the resonance curve: their points, and their curves behind the present one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from bokeh.models import ColumnDataSource, GlyphRenderer, Line, Plot, Scatter, Text

from granchain_core import CurvePoint

from ..parts.time_figures.pinned_trains import DASHES
from ..plots.curve import curve_columns
from ..plots.theme import GREY
from ..plots.themed import themed


class PinnedCurves:
    """Dashed circles with names, and grey lines; each is made only when needed, since most visitors pin nothing.

    `places` are the name, frequency [Hz] and largest output force [N] of each pinned motion.
    """

    def __init__(self, plot: Plot) -> None:
        self._plot = plot
        self.places: list[tuple[str, float, float]] = []
        self._curves: list[list[CurvePoint]] = []
        self._lines: dict[int, ColumnDataSource] = {}
        self._source = ColumnDataSource({name: [] for name in ("frequency", "force", "name")})
        self._marks: list[GlyphRenderer] = []

    @property
    def forces(self) -> list[float]:
        """All forces that must fit into the picture [N]."""
        return [force for *_, force in self.places] + [p.max_output_force for points in self._curves for p in points]

    def take(self, curves: Sequence[list[CurvePoint]]) -> bool:
        """Set the curves of the pins, in their order; return whether there is anything new to draw."""
        if [*map(len, curves)] == [*map(len, self._curves)] == [0] * len(curves):
            return False
        self._curves = [[point for point in points if np.isfinite(point.max_output_force)] for points in curves]
        return True

    def draw(self, factor: float) -> None:
        """Draw everything; one unit of the axis is `factor` newtons."""
        if self.places and not self._marks:
            self._marks = self._make_marks()
        names, frequencies, forces = zip(*self.places, strict=True) if self.places else ((), (), ())
        self._source.data = {"name": list(names), "frequency": list(frequencies),
                             "force": [force / factor for force in forces]}
        for number, dash in enumerate(DASHES):
            points = self._curves[number] if number < len(self._curves) else []
            if points and number not in self._lines:
                self._lines[number] = self._line(dash)
            if number in self._lines:
                columns = curve_columns(points, factor)
                self._lines[number].data = {name: columns[name] for name in ("frequency", "force")}

    def _line(self, dash: list[int]) -> ColumnDataSource:
        source = ColumnDataSource({"frequency": [], "force": []})
        self._plot.add_glyph(source, Line(x="frequency", y="force", line_dash=dash, line_color=GREY, line_width=1.5),
                             level="underlay")
        return source

    def _make_marks(self) -> list[GlyphRenderer]:
        at = {"x": "frequency", "y": "force"}
        circles = self._plot.add_glyph(self._source, Scatter(
            **at, marker="circle", size=17, fill_color=None, line_width=1.5, line_dash=[3, 2]), level="overlay")
        names = self._plot.add_glyph(self._source, Text(
            **at, text="name", text_align="center", text_baseline="top", y_offset=10,
            text_font_style="bold"), level="overlay")
        return [themed(circles, self._plot, line_color="ink"),
                themed(names, self._plot, text_color="ink", text_font_size="small_figure_text")]
