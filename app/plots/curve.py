"""A resonance curve: largest output force over drive frequency, every point marked by its regime."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from bokeh.models import ColumnDataSource, DataRange1d, HoverTool, Legend, LegendItem
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


@dataclass(frozen=True)
class SweepStyle:
    """How a curve is drawn, depending on its start; there are no dashes, which mean unstable on branches.

    Attributes
    ----------
    words : str
        The start in words.
    label : str
        The same for the selector next to the curve, with a piece of the line.
    role : str
        The theme role of the line's colour, which is the same in every theme.
    colour_word : str
        That colour in a word.
    width, alpha : float
        Width [px] and opacity of the line.
    level : str
        Bokeh's level of the line: the broad line is below the others, so that all are visible where they coincide.
    filled : bool
        Whether the marks are filled.
    larger : int
        By how much the marks are larger [px]: hollow marks surround the filled ones of another curve.
    meaning : str
        How the points were computed.
    """

    words: str
    label: str
    role: str
    colour_word: str
    width: float
    alpha: float
    level: str
    filled: bool
    larger: int
    meaning: str

    @property
    def colour(self) -> str:
        """The line's colour."""
        return str(getattr(Theme, self.role))

    @property
    def line_words(self) -> str:
        """The description of the line and the marks."""
        usual = CURVE_STYLES["rest"].width
        width = "broad " if self.width > usual else "thin " if self.width < usual else ""
        return f"{width}{self.colour_word} line{'' if self.filled else ' with hollow marks'}"


#: The style of a curve by its start.
CURVE_STYLES = {
    "rest": SweepStyle("from rest", "from rest ─", "output", "green", 2.2, 0.9, "glyph", True, 0,
                       "every frequency started from rest"),
    "up": SweepStyle("sweep up", "sweep up ━", "naive", "amber", 7.0, 0.65, "underlay", True, 0,
                     "frequency rising, the state carried along"),
    "down": SweepStyle("sweep down", "sweep down ─○", "second", "violet", 1.4, 0.9, "glyph", False, 6,
                       "frequency falling, the state carried along"),
}
#: The meaning of the lines in a sentence.
KEY = "; ".join(f"{style.line_words}: {style.words}" for style in CURVE_STYLES.values()).capitalize() + "."
#: The lines of a tooltip for the columns of `forces_in_words`.
FORCES = [("largest output force", "@total"), ("its elastic part", "@elastic"), ("largest input force", "@input")]


def curve(sweeps: Sequence[Curve], theme: Theme, elastic: bool = False, measured: Measured | None = None) -> figure:
    """Draw curves over one frequency axis, one for each way of sweeping; a failed computation has no point.

    With `elastic`, draw the elastic part of the output force, as the paper does. A `measured` curve is drawn over it.
    """
    drawn = "max_output_force_elastic" if elastic else "max_output_force"
    largest = max((getattr(p, drawn) for sweep in sweeps for p in sweep.points if math.isfinite(p.max_output_force)),
                  default=1.0)
    if measured is not None:
        largest = max(largest, float(measured.bars[1].max()))
    scale = force_scale("largest elastic output force" if elastic else "largest output force", largest)
    plot = empty_figure(name="curve", min_border=4, y_range=DataRange1d(start=0, range_padding=0.06))
    lines: dict[str, LegendItem] = {}
    regimes: dict[str, LegendItem] = {}
    for sweep in sweeps:
        points = [p for p in sweep.points if math.isfinite(p.max_output_force)]
        style = CURVE_STYLES[sweep.start]
        columns = curve_columns(points, scale.factor, 3 + style.larger, drawn)
        source = ColumnDataSource(name=sweep.start, data=columns)
        line = plot.line(**curve_line(sweep.start), source=source, level=style.level)
        marks = plot.scatter(**curve_marks(sweep.start), source=source)
        themed(line, line_color=style.role, line_width=style.width)
        plot.add_tools(HoverTool(renderers=[marks], tooltips=curve_tooltips(sweep.start)))
        lines.setdefault(sweep.start, LegendItem(label=f"{style.words}: {style.line_words}", renderers=[line]))
        for row, name in enumerate(columns["regime"]):
            regimes.setdefault(name, LegendItem(label=name, renderers=[marks], index=row))
    if measured is not None:
        measured_over(plot, measured, scale.factor)
    plot.xaxis.axis_label, plot.yaxis.axis_label = knob_scale("f").label, scale.label
    shown = [regimes[name] for name in REGIME_MARKS if name in regimes]
    items = [lines[start] for start in CURVE_STYLES if start in lines] + (plot.legend[0].items if plot.legend else [])
    for legend in list(plot.legend):
        plot.center.remove(legend)
    for name, some in (("lines", items), ("regimes", shown)):
        if some:
            plot.add_layout(Legend(name=name, items=some, orientation="horizontal", location="left", padding=0,
                                   margin=2, spacing=14, ncols=len(some) if len(some) < 7 else 4), "below")
    return apply_theme(plot, theme)


def curve_line(start: str) -> dict[str, Any]:
    """Return the properties of the line through a curve, here and on the page."""
    style = CURVE_STYLES[start]
    return {"x": "frequency", "y": "force", "line_width": style.width, "line_alpha": style.alpha}


def curve_marks(start: str) -> dict[str, Any]:
    """Return the properties of a curve's marks, here and on the page."""
    return {"x": "frequency", "y": "force", "marker": "marker", "size": "size", "line_color": "colour",
            "line_width": 1.5, "fill_color": "colour" if CURVE_STYLES[start].filled else None}


def line_pieces(points: Sequence[CurvePoint]) -> list[list[int]]:
    """Return runs of neighbouring points, by their indices, that one line connects.

    A line does not connect a periodic point with a point that is not periodic, because their maxima are not comparable.
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
    """Return the columns for a line, its marks and their tooltips.

    The force `drawn` is divided by `factor` [N], and marks are `larger` px larger. Between two `line_pieces`, a row
    without a force breaks the line.
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
    """Return the lines of a tooltip for `curve_columns`."""
    return [("drive frequency", "@frequency{0.0} Hz"), *FORCES, ("motion", "@sentence"),
            ("start", CURVE_STYLES[start].words)]


def forces_in_words(points: Sequence[CurvePoint]) -> dict[str, list[str]]:
    """Return the largest forces of every point in words, with their relative errors."""
    return {"total": [_force(p.max_output_force, p.force_errors.output) for p in points],
            "elastic": [_force(p.max_output_force_elastic, p.force_errors.elastic) for p in points],
            "input": [_force(p.max_input_force, p.force_errors.input) for p in points]}


@functools.lru_cache(maxsize=4096)
def _force(newtons: float, relative: float | None) -> str:
    """Return a force in words; cached, because a growing curve is drawn repeatedly, in every session of a class."""
    error = ", no error stated" if relative is None else f", relative error {short_error(relative)}"
    return in_words(newtons, "N", figures_of(relative, 5)) + error


@functools.lru_cache(maxsize=1024)
def _sentence(regime: Regime) -> str:
    return regime.sentence
