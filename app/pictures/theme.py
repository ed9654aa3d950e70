"""Themes: their colours and line widths, and how they are applied to a figure."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

from bokeh.models import Model, Range1d
from bokeh.plotting import figure

TOOLS = "pan,wheel_zoom,box_zoom,reset,save"


#: Colours of marks in several pictures, the same in every theme. Blue is the input force; it is also quasi-periodic
#: motion, because no picture of regimes shows the input force.
AMBER = "#e0900a"
VIOLET = "#9b6bf2"
TEAL = "#0fa3b8"
BROWN = "#7a3b00"
GREY = "#8a8f98"
BLUE = "#3b82f6"


@dataclass(frozen=True)
class Theme:
    """Colours by role. `line` multiplies all line widths; `type` and `small` are sizes of words in pixels.

    `style_sheet` gives the page the same.
    """

    scheme: str
    paper: str
    card: str
    ink: str
    soft: str
    faint: str
    accent: str
    steel: str
    steel_shine: str
    steel_edge: str
    steel_number: str
    warn: str
    warn_paper: str
    line: float = 1.0
    type: int = 15
    small: int = 14
    drive: str = "#e5484d"
    input: str = BLUE
    output: str = "#2f9e6a"
    naive: str = "#d97706"
    second: str = VIOLET


THEMES = {
    "light": Theme("light", paper="#f6f7f9", card="#ffffff", ink="#14181f", soft="#565f6d", faint="#dfe3e8",
                   accent="#2456c7", steel="#8b95a3",
                   steel_shine="#f4f6f9", steel_edge="#5d6673", steel_number="#14181f",
                   warn="#8a4b00", warn_paper="#fff1da"),
    "dark": Theme("dark", paper="#0e1116", card="#161a21", ink="#eef1f6", soft="#a4adba", faint="#2a313b",
                  accent="#7aa5ff", steel="#7c8796",
                  steel_shine="#e3e8ef", steel_edge="#414a57", steel_number="#0e1116",
                  warn="#ffcf87", warn_paper="#3a2a10"),
    "projector": Theme("light", paper="#ffffff", card="#ffffff", ink="#000000", soft="#222222", faint="#c4c9d0",
                       accent="#003cc0", steel="#66707d",
                       steel_shine="#ffffff", steel_edge="#4a525d", steel_number="#000000",
                       warn=BROWN, warn_paper="#ffe8c2",
                       line=1.8, type=19, small=17),
}


def style_sheet() -> str:
    """The themes as CSS: a custom property for every role. A theme's rule has only what differs from the first one's,
    so that the page may change sizes on large and small screens for all themes at once.
    """
    rules: list[str] = []
    first: dict[str, str] = {}
    for name, theme in THEMES.items():
        roles = {f"--{role.replace('_', '-')}": str(value) for role, value in asdict(theme).items()}
        roles["color-scheme"] = roles.pop("--scheme")
        for size in ("--type", "--small"):
            roles[size] += "px"
        own = "; ".join(f"{role}: {value}" for role, value in roles.items() if first.get(role) != value)
        rules.append(f':root{(first and f"[data-theme={name}]") or ""} {{ {own} }}\n')
        first = first or roles
    return "".join(rules)


def frame(tools: str = TOOLS, **options: Any) -> figure:
    """An empty figure with the tools that every picture has; `apply_theme` gives it its colours."""
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


def themed(model: Any, **roles: str | float) -> Any:
    """Mark what follows the theme: a string is a colour's role, a number a line width in pixels. Returns `model`."""
    model.tags = [*model.tags, {"theme": roles}]
    return model


def apply_theme(plot: figure, theme: Theme) -> figure:
    """Give a figure, and all in it that `themed` has named, the colours and widths of a theme. Returns `plot`."""
    plot.background_fill_color = plot.border_fill_color = theme.card
    plot.grid.grid_line_color = theme.faint
    small = f"{theme.small}px"
    plot.title.update(text_color=theme.soft, text_font_size=small)
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.update(axis_label_text_color=theme.soft, major_label_text_color=theme.ink,
                    axis_label_text_font_size=small, major_label_text_font_size=small)
    for legend in plot.legend:
        legend.update(label_text_color=theme.ink, label_text_font_size=small, background_fill_color=theme.card,
                      border_line_color=None)
    for model, roles in _followers(plot):
        model.update(**{name: getattr(theme, role) if isinstance(role, str) else role * theme.line
                        for name, role in roles.items()})
    return plot


def _followers(plot: figure) -> Iterator[tuple[Model, dict[str, str | float]]]:
    for model in (*plot.renderers, *plot.center):
        for tag in model.tags:
            if isinstance(tag, dict) and "theme" in tag:
                yield getattr(model, "glyph", model), tag["theme"]


def span_of(low: float, high: float, room: float = 0.07) -> Range1d:
    """A range with some room on both sides; one that is empty is widened."""
    if not high > low:
        wide = 0.1 * abs(high) or 1.0
        low, high = low - wide, high + wide
    return Range1d(low - room * (high - low), high + room * (high - low))
