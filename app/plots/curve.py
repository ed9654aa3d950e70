"""A resonance curve: largest output force over drive frequency, every point marked by its regime."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import Any

from bokeh.models import ColumnDataSource, DataRange1d, HoverTool
from bokeh.plotting import figure

from granchain_core import Curve, CurvePoint
from granchain_core.experiment import Measured
from granchain_core.results.regime import Regime

from ..format import figures_of, in_words, short_error
from .axes import force_scale, knob_scale
from .measured import measured_over
from .regimes import REGIME_MARKS, regime_key
from .theme import Theme
from .themed import apply_theme, empty_figure, themed

#: Dashes of the line by the start of a sweep.
DASHES: dict[str, list[int]] = {"rest": [], "up": [8, 4], "down": [2, 3]}
#: The same in words.
WORDS = {"rest": "from rest", "up": "sweep up", "down": "sweep down"}
#: The same for a choice beside the curve, with a piece of the line.
LABELS = {"rest": "from rest ─", "up": "sweep up ╌", "down": "sweep down ┈○"}
#: What the dashes mean, in a sentence.
KEY = "Solid line: from rest; dashed: frequency rising; dotted, with hollow marks: frequency falling."
#: Filling of the marks by the start of a curve: a column, or none, so that one sees where the two sweeps differ.
FILLS: dict[str, str | None] = {"rest": "colour", "up": "colour", "down": None}
#: Width of the line through a curve [px].
LINE_WIDTH = 1.8
#: A tooltip's lines for the columns of `forces_in_words`.
FORCES = [("largest output force", "@total"), ("its elastic part", "@elastic"), ("largest input force", "@input")]


def curve(found: Sequence[Curve], theme: Theme, elastic: bool = False, measured: Measured | None = None) -> figure:
    """Curves over one frequency axis, one for each way of sweeping; where the numbers failed there is no point.

    `elastic` draws the elastic part of the output force, as the paper does; a curve that was `measured` is drawn over
    it.
    """
    drawn = "max_output_force_elastic" if elastic else "max_output_force"
    largest = max((getattr(p, drawn) for one in found for p in one.points if math.isfinite(p.max_output_force)),
                  default=1.0)
    if measured is not None:
        largest = max(largest, float(measured.bars[1].max()))
    scale = force_scale("largest elastic output force" if elastic else "largest output force", largest)
    plot = empty_figure(name="curve", min_border=4, y_range=DataRange1d(start=0, range_padding=0.06))
    for one in found:
        points = [p for p in one.points if math.isfinite(p.max_output_force)]
        source = ColumnDataSource(name=one.start, data=curve_columns(points, scale.factor, 3, drawn))
        line = plot.line(**curve_line(one.start), source=source)
        marks = plot.scatter(**curve_marks(one.start), source=source, legend_group="regime")
        themed(line, line_color="output", line_width=LINE_WIDTH)
        plot.add_tools(HoverTool(renderers=[marks], tooltips=curve_tooltips(one.start)))
    if measured is not None:
        measured_over(plot, measured, scale.factor)
    plot.xaxis.axis_label, plot.yaxis.axis_label = knob_scale("f").label, scale.label
    for legend in plot.legend:
        legend.update(orientation="horizontal", padding=0, margin=2, ncols=4)
    if plot.legend:
        plot.add_layout(plot.legend[0], "below")
    return apply_theme(plot, theme)


def curve_line(start: str) -> dict[str, Any]:
    """The properties of the line through a curve, here and on the page."""
    return {"x": "frequency", "y": "force", "line_dash": DASHES[start] or "solid", "line_width": LINE_WIDTH}


def curve_marks(start: str) -> dict[str, Any]:
    """The properties of a curve's marks, here and on the page."""
    return {"x": "frequency", "y": "force", "marker": "marker", "size": "size", "line_color": "colour",
            "line_width": 1.5, "fill_color": FILLS[start]}


def line_pieces(points: Sequence[CurvePoint]) -> list[list[int]]:
    """Runs of neighbouring points, by their places, through which one line goes.

    A line does not connect a periodic point with one that is not periodic: their maxima are not comparable.
    """
    pieces: list[list[int]] = []
    for index, point in enumerate(points):
        if index and (points[index - 1].regime.period is None) == (point.regime.period is None):
            pieces[-1].append(index)
        else:
            pieces.append([index])
    return pieces


def curve_columns(points: Sequence[CurvePoint], factor: float, larger: int = 0,
                  drawn: str = "max_output_force") -> dict[str, list[Any]]:
    """Columns for a line, its marks and their tooltips.

    The force `drawn` is drawn over `factor` [N], marks `larger` px larger. Between two `line_pieces` a row without a
    force breaks the line.
    """
    shown: list[CurvePoint] = []
    forces: list[float] = []
    for piece in line_pieces(points):
        if shown:
            shown.append(points[piece[0]])
            forces.append(math.nan)
        shown += (points[i] for i in piece)
        forces += (getattr(points[i], drawn) / factor for i in piece)
    keys = [regime_key(p.regime.name, p.regime.period) for p in shown]
    styles = [REGIME_MARKS[key] for key in keys]
    return {
        "frequency": [p.frequency for p in shown], "force": forces,
        "marker": [style[0] for style in styles], "colour": [style[1] for style in styles],
        "size": [style[2] + larger for style in styles], "regime": keys,
        "sentence": [_sentence(p.regime) for p in shown], **forces_in_words(shown)}


def curve_tooltips(start: str) -> list[tuple[str, str]]:
    """The lines of a tooltip over `curve_columns`."""
    return [("drive frequency", "@frequency{0.0} Hz"), *FORCES, ("motion", "@sentence"), ("start", WORDS[start])]


def forces_in_words(points: Sequence[CurvePoint]) -> dict[str, list[str]]:
    """The largest forces of every point with their relative errors."""
    return {"total": [_force(p.max_output_force, p.force_errors.output) for p in points],
            "elastic": [_force(p.max_output_force_elastic, p.force_errors.elastic) for p in points],
            "input": [_force(p.max_input_force, p.force_errors.input) for p in points]}


@functools.lru_cache(maxsize=4096)
def _force(newtons: float, relative: float | None) -> str:
    """Remembered: a growing curve is drawn again and again, for every session of a class."""
    error = ", no error stated" if relative is None else f", relative error {short_error(relative)}"
    return in_words(newtons, "N", figures_of(relative, 5)) + error


@functools.lru_cache(maxsize=1024)
def _sentence(regime: Regime) -> str:
    return regime.sentence
