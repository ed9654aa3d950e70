"""The Poincaré section of one bead: a point per drive period; the transient is grey, the orbit's points have rings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Range1d
from bokeh.plotting import figure

from .theme import Theme
from .themed import apply_theme, empty_figure, span_of, themed

#: In sections with fewer points than this, the points of the transient are larger.
_FEW_POINTS = 150
#: Most points that are joined on the way to an orbit.
_MOST_JOINED = 60


@dataclass(frozen=True, eq=False)
class SectionPoints:
    """The points and labels of a drawn section.

    points : (T, 2) displacement and velocity in `units`, one row per drive period. own : (n, 2), those of the orbit.
    transient : number of points before the motion has settled. period : of the settled motion, 0 if it is not periodic.
    unstable : whether the orbit was found by search and the chain does not follow it.
    """

    points: np.ndarray
    own: np.ndarray
    transient: int
    period: int
    unstable: bool
    bead: int
    units: tuple[str, str]


def section(shown: SectionPoints, theme: Theme) -> figure:
    """Draw velocity over displacement of one bead at one drive phase; `section_state` returns the data that change."""
    state = section_state(shown)
    plot = empty_figure(name="section", min_border=4, x_range=Range1d(name="displacements"),
                        y_range=Range1d(name="velocities"))
    plot.xaxis[0].name, plot.yaxis[0].name = "displacement", "velocity"
    sources = {name: ColumnDataSource(name=name) for name in ("path", "way", "dots", "orbit", "unstable orbit")}
    for name, model in (*sources.items(), ("displacements", plot.x_range), ("velocities", plot.y_range),
                        ("displacement", plot.xaxis[0]), ("velocity", plot.yaxis[0])):
        model.update(**state[name])
    themed(plot.multi_line("u", "v", source=sources["path"], line_alpha=0.45), line_color="soft", line_width=1.4)
    way = themed(plot.scatter("u", "v", size="size", source=sources["way"], line_color=None, fill_alpha=0.75),
                 fill_color="soft")
    dots = themed(plot.scatter("u", "v", size="size", source=sources["dots"], line_color=None), fill_color="accent")
    ring = themed(plot.scatter("u", "v", size=16, source=sources["orbit"], fill_color=None),
                  line_color="accent", line_width=3.0)
    diamond = themed(plot.scatter("u", "v", size=20, marker="diamond", source=sources["unstable orbit"],
                                  fill_color=None), line_color="ink", line_width=3.0)
    plot.add_tools(HoverTool(renderers=[way, dots], tooltips=[("drive period", "@number"), ("displacement", "@u"),
                                                              ("velocity", "@v")]),
                   HoverTool(renderers=[ring, diamond], tooltips=[("point of the orbit", "@number"),
                                                                  ("displacement", "@u"), ("velocity", "@v")]))
    for axis in (plot.xaxis[0], plot.yaxis[0]):
        axis.ticker.desired_num_ticks = 4
    return apply_theme(plot, theme)


def section_state(shown: SectionPoints) -> dict[str, dict[str, Any]]:
    """Return the properties of the figure's models by their names: sources, ranges, axis titles.

    The ranges fit the settled part of a motion that is not periodic, and an orbit together with its approach.
    """
    points, own, before = shown.points, shown.own, min(shown.transient, len(shown.points))
    shows_all = bool(shown.period) or shown.transient >= len(points)
    joined = [points[:before][i::shown.period][:_MOST_JOINED] for i in range(min(shown.period, before))]
    if shown.unstable:
        joined = []
    number = np.arange(len(points))
    return {
        "path": {"data": {"u": [_short(path[:, 0]) for path in joined], "v": [_short(path[:, 1]) for path in joined]}},
        "way": _dots(points[:before], number[:before], 6 if len(points) < _FEW_POINTS else 3.4),
        "dots": _dots(points[before:], number[before:], 3.4),
        "orbit": _dots(own[:0] if shown.unstable else own, np.arange(1, len(own) + 1), 16),
        "unstable orbit": _dots(own if shown.unstable else own[:0], np.arange(1, len(own) + 1), 20),
        "displacement": {"axis_label": f"displacement of bead {shown.bead} ({shown.units[0]})"},
        "velocity": {"axis_label": f"velocity ({shown.units[1]})"},
        **_ranges(np.concatenate([points if shows_all else points[shown.transient:], own])),
    }


def close_up(shown: SectionPoints) -> dict[str, dict[str, Any]]:
    """Return the ranges that contain the second half of the points and the orbit."""
    return _ranges(np.concatenate([shown.points[len(shown.points) // 2:], shown.own]))


def _dots(points: np.ndarray, number: np.ndarray, size: float) -> dict[str, Any]:
    return {"data": {"u": _short(points[:, 0]), "v": _short(points[:, 1]), "number": number[: len(points)].tolist(),
                     "size": [size] * len(points)}}


def _short(values: np.ndarray) -> list[float]:
    """Return the values to seven digits: a section is sent again at every step of the phase slider."""
    return [float(f"{value:.7g}") for value in values]


def _ranges(points: np.ndarray) -> dict[str, dict[str, Any]]:
    ranges = {}
    for name, values in zip(("displacements", "velocities"), points.T, strict=True):
        span = span_of(float(values.min()), float(values.max()), 0.08)
        ranges[name] = {"start": span.start, "end": span.end, "reset_start": span.start, "reset_end": span.end}
    return ranges
