"""Error against processor time for every method, both logarithmic, with the requested accuracy and the cheapest row."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bokeh.models import BoxAnnotation, ColumnDataSource, HoverTool, Legend, LegendItem, Span
from bokeh.plotting import figure

from granchain_core.accuracy import Row, compared_methods

from ..format import duration, short_error
from .theme import GREY, LINE_COLOURS, Theme
from .themed import apply_theme, empty_figure, themed

_MARKS = ("circle", "square", "diamond", "triangle", "hex", "star", "inverted_triangle", "square_pin")
_NAIVE_MARKS = ("x", "cross", "asterisk")
_NAIVE_COLOUR = GREY
_DASHES: dict[str, str | list[int]] = {"granchain": "solid", "naive": [6, 4], "scipy": [2, 4]}
#: Largest error drawn; larger errors, which say nothing more, are drawn at this value.
_LARGEST_ERROR = 10.0
_COLUMNS = ("ms", "error", "setting", "tooltip")


@dataclass(frozen=True)
class Annotations:
    """The parts of the figure that are not measurements.

    accuracy : the requested accuracy, a fraction of the largest displacement. agreement : of the two references, or
    None. cheapest : time [s] and error of the row that reaches this accuracy in the least time. now : time and error of
    the page's own setting.
    """

    accuracy: float
    agreement: float | None = None
    cheapest: tuple[float, float] | None = None
    now: tuple[float, float] | None = None


def styles() -> dict[str, dict[str, Any]]:
    """Return marker, colour, dash and fill of every method; shape and fill alone are enough to tell them apart."""
    properties: dict[str, dict[str, Any]] = {}
    used = {"naive": 0, "other": 0}
    for way in compared_methods().values():
        kind = "naive" if way.family == "naive" else "other"
        number = used[kind]
        used[kind] += 1
        marks = _NAIVE_MARKS if kind == "naive" else _MARKS
        properties[way.name] = {
            "marker": marks[number % len(marks)], "dash": _DASHES[way.family], "filled": way.family == "granchain",
            "colour": _NAIVE_COLOUR if kind == "naive" else LINE_COLOURS[number % len(LINE_COLOURS)]}
    return properties


def points(rows: Sequence[Row]) -> dict[str, dict[str, list[Any]]]:
    """Return the columns of every method's source by its name; a row without a finite error or a time has no point."""
    columns: dict[str, dict[str, list[Any]]] = {
        name: {column: [] for column in _COLUMNS} for name in compared_methods()}
    for row in rows:
        if not row.failure and math.isfinite(row.error) and row.error > 0.0 and row.wall_s > 0.0:
            words = f"error {row.error:.2g}, {duration(row.wall_s)}, {row.rhs} evaluations"
            for name, value in zip(_COLUMNS, (1e3 * row.wall_s, min(row.error, _LARGEST_ERROR), row.setting, words),
                                   strict=True):
                columns[row.method][name].append(value)
    return columns


def marks(annotations: Annotations, rows: Sequence[Row]) -> dict[str, dict[str, Any]]:
    """Return the properties of the models that mark the requested accuracy, the agreement of the references, the
    cheapest row and the present one.
    """
    times = [1e3 * row.wall_s for row in rows if row.wall_s > 0.0] or [1.0]

    def at(place: tuple[float, float] | None) -> dict[str, Any]:
        return {"data": {"ms": [1e3 * place[0]] if place else [], "error": [place[1]] if place else []}}

    agreement = annotations.agreement or None
    return {
        "good": {"top": annotations.accuracy},
        "asked": {"data": {"ms": [min(times)], "error": [annotations.accuracy],
                           "words": [f"asked {short_error(annotations.accuracy)}"]}},
        "agreement line": {"location": agreement, "visible": agreement is not None},
        "agreement": {"data": {"ms": [max(times)] if agreement else [], "error": [agreement] if agreement else []}},
        "cheapest": at(annotations.cheapest), "now": at(annotations.now),
    }


def accuracy(rows: Sequence[Row], annotations: Annotations, theme: Theme, compact: bool = False) -> figure:
    """Draw largest error over largest displacement against the processor time of ten drive periods in ms.

    The sources have the names of the methods; `points` and `marks` return the data that change during a measurement.
    """
    plot = empty_figure(name="accuracy", x_axis_type="log", y_axis_type="log", min_border=4,
                        toolbar_location=None if compact else "right")
    state = marks(annotations, rows)
    good = themed(BoxAnnotation(name="good", fill_alpha=0.09, level="underlay"), fill_color="accent",
                  line_color="accent", line_width=2.0)
    limit = themed(Span(name="agreement line", dimension="width", line_dash=[1, 5], line_cap="round",
                        level="underlay"), line_color="soft", line_width=1.5)
    for model in (good, limit):
        model.update(**state[model.name])
        plot.add_layout(model)
    shown = _lines(plot, points(rows), compact) + _rings(plot, state, compact)
    for data_range in (plot.x_range, plot.y_range):
        data_range.update(renderers=shown, range_padding=0.06)
    if not compact:
        plot.xaxis.axis_label = "processor time of ten drive periods (ms)"
        plot.yaxis.axis_label = "largest error / largest displacement"
    for axis in (plot.xaxis[0], plot.yaxis[0]):
        axis.ticker.desired_num_ticks = 4 if compact else 6
    return apply_theme(plot, theme)


def _lines(plot: figure, columns: Mapping[str, dict[str, list[Any]]], compact: bool) -> list[Any]:
    """Draw a line and marks for every method, and return the marks."""
    shown, items = [], []
    for name, style in styles().items():
        source = ColumnDataSource(columns[name], name=name)
        line = plot.line("ms", "error", source=source, line_color=style["colour"], line_dash=style["dash"],
                         line_alpha=0.75)
        dots = plot.scatter("ms", "error", source=source, marker=style["marker"], size=8 if compact else 12,
                            line_color=style["colour"], line_width=2.0, fill_color=style["colour"],
                            name=f"{name}, order {compared_methods()[name].order:g}")
        themed(line, line_width=1.8)
        if not style["filled"]:
            themed(dots, fill_color="card")
        shown.append(dots)
        items.append(LegendItem(label=name.replace("scipy ", "SciPy "), renderers=[line, dots]))
    plot.add_tools(HoverTool(renderers=shown, tooltips=[("", "$name"), ("", "@setting"), ("", "@tooltip")]))
    if not compact:
        plot.add_layout(Legend(items=items, click_policy="hide", padding=0, margin=0, spacing=0, label_height=14,
                               glyph_height=14), "right")
    return shown


def _rings(plot: figure, state: Mapping[str, dict[str, Any]], compact: bool) -> list[Any]:
    """Draw a ring around the cheapest row, a cross at the page's setting and, if there is room, words at all marks."""
    sources = {name: ColumnDataSource(state[name]["data"], name=name)
            for name in ("asked", "agreement", "cheapest", "now")}
    ring = plot.scatter("ms", "error", source=sources["cheapest"], size=18 if compact else 26, fill_color=None)
    now = plot.scatter("ms", "error", source=sources["now"], marker="square_cross", size=14 if compact else 20,
                       fill_color=None)
    themed(ring, line_color="accent", line_width=3.0)
    themed(now, line_color="ink", line_width=1.8)
    words: list[tuple[str, Any, str, dict[str, Any]]] = [
        ("asked", {"field": "words"}, "accent", {"text_baseline": "bottom", "y_offset": -3}),
        ("agreement", {"value": "the references agree to here"}, "soft",
         {"text_align": "right", "text_baseline": "bottom", "y_offset": -3}),
        ("cheapest", {"value": "cheapest"}, "accent", {"x_offset": 17, "y_offset": 5}),
        ("now", {"value": "this page now"}, "ink", {"x_offset": 13, "y_offset": -8}),
    ]
    texts = [themed(plot.text("ms", "error", text=text, source=sources[name], text_font_style="bold",
                              text_alpha=0.0 if compact else 1.0,
                              background_fill_alpha=0.0 if compact else 0.8, padding=1, **place),
                    text_color=role, background_fill_color="card", text_font_size="figure_text")
             for name, text, role, place in words]
    return [ring, now, *texts[:2]]
