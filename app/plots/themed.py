"""Figures in a theme: empty figures, tags for the models that follow the theme, and the change of theme."""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from typing import Any

from bokeh.models import Plot, Range1d
from bokeh.plotting import figure

from .theme import THEMES, Theme

#: The current theme of each figure.
_THEMES: weakref.WeakKeyDictionary[Plot, Theme] = weakref.WeakKeyDictionary()

TOOLS = "pan,wheel_zoom,box_zoom,reset,save"


def empty_figure(tools: str = TOOLS, **options: Any) -> figure:
    """Return an empty figure with the tools that every figure has; `apply_theme` gives it its colours."""
    plot = figure(tools=tools, output_backend="canvas", outline_line_color=None,
                  **{"sizing_mode": "stretch_both", "toolbar_location": "right", **options})
    plot.toolbar.logo = None
    plot.toolbar.autohide = True
    plot.title.text_font_style = "normal"
    plot.title.standoff = 4
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.axis_line_color = axis.major_tick_line_color = axis.minor_tick_line_color = None
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_standoff = 4
        axis.major_label_standoff = 3
    return plot


def themed(model: Any, plot: Plot | None = None, **roles: str | float) -> Any:
    """Tag the properties of `model` that follow the theme, and return `model`.

    A string is a role, that is, an attribute of `Theme`: a colour or a text size. A number is a line width in pixels.
    If `plot` is given, a figure that is created once and changes its theme, the model gets its current theme at once.
    """
    model.tags = [*model.tags, {"theme": roles}]
    if plot is not None:
        _dress(model, roles, _THEMES.get(plot, THEMES["light"]))
    return model


def follow_theme(plot: Plot, theme: Theme) -> None:
    """Give all models in a figure that `themed` has tagged, present and future, a theme's colours and widths."""
    _THEMES[plot] = theme
    for model in (*plot.renderers, *plot.center):
        for tag in model.tags:
            if isinstance(tag, dict) and "theme" in tag:
                _dress(model, tag["theme"], theme)


def _dress(model: Any, roles: Mapping[str, str | float], theme: Theme) -> None:
    getattr(model, "glyph", model).update(**{
        name: getattr(theme, role) if isinstance(role, str) else role * theme.line_scale
        for name, role in roles.items()})


def apply_theme(plot: figure, theme: Theme) -> figure:
    """Give a figure, and all models in it that `themed` has tagged, a theme's colours and widths; return `plot`."""
    plot.background_fill_color = plot.border_fill_color = theme.card
    plot.grid.grid_line_color = theme.faint
    size = theme.figure_text
    plot.title.update(text_color=theme.soft, text_font_size=size)
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.update(axis_label_text_color=theme.soft, major_label_text_color=theme.ink,
                    axis_label_text_font_size=size, major_label_text_font_size=size)
    for legend in plot.legend:
        legend.update(label_text_color=theme.ink, label_text_font_size=size, background_fill_color=theme.card,
                      border_line_color=None)
    follow_theme(plot, theme)
    return plot


def span_of(low: float, high: float, room: float = 0.07) -> Range1d:
    """Return a range with some room on both sides; an empty range is widened."""
    if not high > low:
        wide = 0.1 * abs(high) or 1.0
        low, high = low - wide, high + wide
    return Range1d(low - room * (high - low), high + room * (high - low))
