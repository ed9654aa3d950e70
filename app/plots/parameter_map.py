"""The parameter map: a cell for each pair of values, coloured by its largest force or by its regime."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import (
    CDSView,
    ColorBar,
    ColumnDataSource,
    FixedTicker,
    GroupFilter,
    HoverTool,
    IndexFilter,
    Legend,
    LegendItem,
    LogColorMapper,
    PrintfTickFormatter,
    Range1d,
    TapTool,
)
from bokeh.palettes import Inferno256
from bokeh.plotting import figure
from bokeh.transform import factor_cmap, transform

from granchain_core.bifurcation_continuation import BifurcationCurve
from granchain_core.parameter_maps import Axis, Grid, ParameterMap
from granchain_core.parameter_maps.cells import CELL_REGIMES, empty_cells
from granchain_core.results.regime import exponent_words

from ..format import figures_of, in_words, short_error
from .axes import Scale, knob_scale
from .branches import SPECIAL, SPECIAL_STYLES
from .regimes import REGIME_MARKS, regime_key
from .theme import BROWN, GREY, MARK_COLOUR, MARK_EDGE, Theme
from .themed import apply_theme, empty_figure, themed

#: The kinds of a cell, in the curve's colours, each with its own hatch.
CATEGORIES = (*REGIME_MARKS, "failed")
COLOURS = [REGIME_MARKS[name][1] if name in REGIME_MARKS else BROWN for name in CATEGORIES]
_HATCHES = (" ", "/", "-", "|", "+", "\\", "x", ".", "o")
#: Marks on a bifurcation curve: most of them on one curve, and their width [px].
_MOST_MARKS, _MARK_SIZE = 9, 11
#: Most cells that a browser shows smoothly.
MOST_DRAWN_CELLS = 40_000
_CELL = ("left", "right", "bottom", "top", "x", "y", "force", "regime", "tooltip", "spacing",
         "number", "own_right", "own_top")


def parameter_map(result: ParameterMap, theme: Theme, shown: str = "force", now: tuple[float, float] | None = None,
                  curves: Sequence[BifurcationCurve] = ()) -> figure:
    """Draw all computed cells of a parameter map over its two knobs; `shown` is "force" or "regime".

    `now` is a pair of values [SI] that gets a mark, and `curves` are its bifurcation curves. The source "cells" has a
    row for each cell, with those of coarse grids first: they stand for the cells around them until these are computed.
    `cell_rows`, `scale_models` and `shown_models` return the data that change later.
    """
    grid = result.grid
    across, up = _scales(grid)
    computed = result.cells[result.cells["regime"] >= 0]
    plot = empty_figure(name="map", min_border=4, active_scroll=None, x_range=_range(grid.x, across),
                        y_range=_range(grid.y, up), **{f"{side}_axis_type": "log" if _by_ratio(axis) else "linear"
                                                       for side, axis in (("x", grid.x), ("y", grid.y))})
    source = ColumnDataSource(cell_rows(grid, computed), name="cells")
    mapper = LogColorMapper(name="force colours", palette=Inferno256[::4], low=1.0, high=10.0, nan_color=GREY)
    edges: dict[str, Any] = {"left": "left", "right": "right", "bottom": "bottom", "top": "top", "source": source,
                             "line_color": None}
    force = plot.quad(**edges, fill_color=transform("force", mapper), name="force")
    # Cells may arrive in any order, and a coarse cell must not hide the finer cells that it stands for.
    own = plot.quad(**{**edges, "right": "own_right", "top": "own_top"}, fill_color=transform("force", mapper),
                    name="own force")
    regime = plot.quad(**edges, fill_color=factor_cmap("regime", COLOURS, CATEGORIES), name="regime")
    items = _hatched(plot, source)
    for cells in (force, own, regime):
        cells.nonselection_glyph = cells.selection_glyph = None
    bar = ColorBar(name="bar", color_mapper=mapper, orientation="horizontal", height=10, padding=2,
                   title="largest output force (N)", ticker=FixedTicker(name="force ticks", ticks=[]),
                   formatter=PrintfTickFormatter(format="%.3g"), bar_line_color=None)
    plot.add_layout(bar, "above")
    plot.add_layout(Legend(name="regimes", orientation="horizontal", ncols=3, padding=0, margin=2,
                           items=items), "above")
    plot.add_tools(HoverTool(renderers=[force, regime], tooltips=[("", "@tooltip")], limit=1, sort_by="spacing"),
                   TapTool(name="tap", renderers=[force, regime], mode="replace"))
    _draw_curves(plot, grid, curves)
    _marks(plot, mark_row(grid, *now) if now else mark_row(grid))
    for name, properties in {**shown_models(shown), **scale_models(computed)}.items():
        plot.select_one({"name": name}).update(**properties)
    bar.update(title_text_color=theme.soft, major_label_text_color=theme.ink, background_fill_color=theme.card,
               title_text_font_style="normal", major_label_text_font_size=theme.figure_text,
               title_text_font_size=theme.figure_text, title_standoff=2)
    plot.xaxis.axis_label, plot.yaxis.axis_label = across.label, up.label
    plot.grid.visible = False
    return apply_theme(plot, theme)


def _hatched(plot: figure, source: ColumnDataSource) -> list[LegendItem]:
    """Draw every computed cell's own area in the colour and hatch of its regime, and return the legend's entries.

    There is one renderer per regime, because with a hatch per cell the browser would draw an image for each cell.
    """
    items = []
    for name, colour, hatch in zip(CATEGORIES, COLOURS, _HATCHES, strict=True):
        cells = plot.quad("left", "own_right", "bottom", "own_top", source=source, line_color=None, fill_color=colour,
                          hatch_pattern=hatch, hatch_color="black", hatch_alpha=0.65, hatch_scale=8, name=f"all {name}",
                          view=CDSView(filter=GroupFilter(column_name="regime", group=name)))
        cells.nonselection_glyph = cells.selection_glyph = None
        items.append(LegendItem(name=f"legend of {name}", label=name, renderers=[cells], visible=False))
    return items


def shown_models(shown: str) -> dict[str, dict[str, Any]]:
    """Return the visibility of the figure's models, by their names, for `shown` "force" or "regime"."""
    force = shown == "force"
    return {**{name: {"visible": force} for name in ("force", "own force", "bar")},
            **{name: {"visible": not force}
               for name in ("regime", "regimes", *(f"all {category}" for category in CATEGORIES))}}


def _draw_curves(plot: figure, grid: Grid, curves: Sequence[BifurcationCurve]) -> None:
    """Draw bifurcation curves, black on white, so that they are visible on every colour.

    The marks on them show their kind; they are the marks of the special points of a branch.
    """
    across, up = _scales(grid)
    kinds: dict[str, LegendItem] = {}
    for curve in curves:
        source = ColumnDataSource({
            "x": [point.x / across.factor for point in curve.points],
            "y": [point.y / up.factor for point in curve.points],
            "tooltip": [curve.sentence(grid.x.knob, grid.y.knob)] * len(curve.points)}, name="bifurcation curve")
        plot.line("x", "y", source=source, line_color=MARK_EDGE, line_width=5)
        line = plot.line("x", "y", source=source, line_color=MARK_COLOUR, line_width=2)
        places = np.unique(np.linspace(0, len(curve.points) - 1, _MOST_MARKS).round().astype(int))
        style, marked = SPECIAL_STYLES[curve.kind], CDSView(filter=IndexFilter(places.tolist()))
        marks = plot.scatter("x", "y", source=source, view=marked, marker=style["marker"], size=_MARK_SIZE,
                             fill_color=style["colour"] if style["filled"] else MARK_EDGE,
                             line_color=MARK_COLOUR, line_width=1.5)
        kinds.setdefault(curve.kind, LegendItem(label=SPECIAL[curve.kind], renderers=[line, marks]))
        plot.add_tools(HoverTool(renderers=[line, marks], tooltips=[("", "@tooltip")], line_policy="nearest"))
    if kinds:
        plot.add_layout(Legend(name="bifurcations", items=list(kinds.values()), orientation="horizontal", padding=0,
                               margin=2), "below")


def _marks(plot: figure, mark: dict[str, Any]) -> None:
    """Draw the page's setting, black on white to be visible on every colour, and the cell chosen by the keyboard."""
    setting = ColumnDataSource(mark, name="mark")
    for colour, width in ((MARK_EDGE, 5), (MARK_COLOUR, 2)):
        plot.scatter("x", "y", source=setting, marker="circle_cross", size=20, fill_color=None, line_color=colour,
                     line_width=width)
    cursor = ColumnDataSource({name: [] for name in ("left", "right", "bottom", "top")}, name="cursor")
    box = plot.quad("left", "right", "bottom", "top", source=cursor, fill_color=None)
    themed(box, line_color="ink", line_width=3.0)


def cell_rows(grid: Grid, cells: np.ndarray) -> dict[str, list[Any]]:
    """Return the columns of the source "cells" for some computed cells, coarse cells first."""
    across, up = _scales(grid)
    x, y = (_edges(axis) / scale.factor for axis, scale in ((grid.x, across), (grid.y, up)))
    spacing = grid.spacing()
    rows = []
    for cell in sorted(cells, key=lambda cell: -spacing[cell["number"]]):
        number = int(cell["number"])
        i, j = divmod(number, grid.shape[1])
        step = int(spacing[number])
        rows.append((*map(_short, (x[j], x[min(j + step, len(x) - 1)], y[i], y[min(i + step, len(y) - 1)])),
                     grid.x.values[j] / across.factor, grid.y.values[i] / up.factor,
                     _or_none(float(cell["max_output_force"])), category(cell),
                     cell_words(grid, cell), step, number,
                     _short(x[j + 1]), _short(y[i + 1])))
    return {name: [row[k] for row in rows] for k, name in enumerate(_CELL)}


def scale_models(cells: np.ndarray) -> dict[str, dict[str, Any]]:
    """Return the force scale and the legend's regimes for all computed cells, by the names of models."""
    models: dict[str, dict[str, Any]] = {}
    for regime, period in np.unique(cells[["regime", "period"]]):
        models[f"legend of {_category(int(regime), int(period))}"] = {"visible": True}
    forces = cells["max_output_force"]
    forces = forces[forces > 0.0]
    if len(forces):
        low, high = float(forces.min()), float(max(forces.max(), 1.0001 * forces.min()))
        models["force colours"] = {"low": low, "high": high}
        models["force ticks"] = {"ticks": _round_values(low, high)}
    return models


def _round_values(low: float, high: float) -> list[float]:
    """Return ticks of a logarithmic scale: powers of ten and, if these are few, also 3 times or 2 and 5 times them."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    for steps in ((1,), (1, 3), (1, 2, 5)):
        ticks = [float(f"{step}e{power}") for power in powers for step in steps]
        inside = [value for value in ticks if low <= value <= high]
        if len(inside) >= 3:
            return inside
    return inside or [low]


def mark_row(grid: Grid, x: float | None = None, y: float | None = None) -> dict[str, list[float]]:
    """Return the columns of the source "mark" for a pair of values in SI, or for no mark."""
    if x is None or y is None:
        return {"x": [], "y": []}
    across, up = _scales(grid)
    return {"x": [x / across.factor], "y": [y / up.factor]}


def nothing(grid: Grid) -> ParameterMap:
    """Return a parameter map without any computed cell."""
    return ParameterMap(grid, empty_cells(grid))


def category(cell: np.ndarray) -> str:
    """Return the entry of `CATEGORIES` for a cell."""
    return _category(int(cell["regime"]), int(cell["period"]))


def _category(regime: int, period: int) -> str:
    return "failed" if CELL_REGIMES[regime] == "failed" else regime_key(CELL_REGIMES[regime], period)


def cell_words(grid: Grid, cell: np.ndarray) -> str:
    """Return a cell in words: its place, regime and largest force, with errors."""
    i, j = divmod(int(cell["number"]), grid.shape[1])
    place = ", ".join(f"{axis.values[at] / scale.factor:.4g} {scale.unit or axis.knob}"
                      for axis, at, scale in zip((grid.x, grid.y), (j, i), _scales(grid), strict=True))
    name = CELL_REGIMES[int(cell["regime"])]
    if name == "failed":
        return f"{place}: computation failed"
    regime = f"period {int(cell['period'])}" if cell["period"] else name
    error = float(cell["error_estimate"])
    sure = f", relative error {short_error(error)}" if np.isfinite(error) else ", largest observed, no error stated"
    exponent = (f"; Lyapunov exponent {exponent_words(float(cell['lyapunov']), float(cell['lyapunov_error']))}"
                if np.isfinite(cell["lyapunov"]) else "")
    force = in_words(float(cell["max_output_force"]), "N", figures_of(error))
    return f"{place}: {regime}, largest output force {force}{sure}{exponent}"


def _scales(grid: Grid) -> tuple[Scale, Scale]:
    return knob_scale(grid.x.knob, grid.x.values), knob_scale(grid.y.knob, grid.y.values)


def _by_ratio(axis: Axis) -> bool:
    """Return whether the values of an axis are spaced by their ratio rather than evenly."""
    if len(axis.values) < 3 or axis.values[0] <= 0.0:
        return False
    even, ratio = np.diff(axis.array), np.diff(np.log(axis.array))
    return bool(np.ptp(ratio) / ratio.mean() < np.ptp(even) / even.mean())


def _edges(axis: Axis) -> np.ndarray:
    """Return the edges of the cells along an axis, (n + 1,)."""
    by_ratio = _by_ratio(axis)
    values = np.log(axis.array) if by_ratio else axis.array
    if len(values) == 1:
        half = 0.5 * abs(values[0]) or 0.5
        return np.array([values[0] - half, values[0] + half])
    middle = 0.5 * (values[1:] + values[:-1])
    edges = np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])
    return np.asarray(np.exp(edges) if by_ratio else edges)


def _range(axis: Axis, scale: Scale) -> Range1d:
    first, *_, last = (float(edge) for edge in _edges(axis) / scale.factor)
    return Range1d(first, last)


def _short(value: float) -> float:
    return float(f"{value:.7g}")


def _or_none(value: float) -> float | None:
    return value if np.isfinite(value) else None
