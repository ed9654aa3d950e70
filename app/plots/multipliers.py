"""Multipliers in the complex plane: filled inside the unit circle, larger and open outside, with their trail."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, DataRange1d, FixedTicker, HoverTool, Legend, LegendItem, Span, TapTool
from bokeh.plotting import figure

from granchain_core.orbits import Orbit
from granchain_core.orbits.unit_circle import outside
from granchain_core.results.regime import modulus_words

from ..format import duration
from .theme import Theme
from .themed import apply_theme, empty_figure, themed

#: Multipliers farther out are drawn at the edge, with their modulus next to them.
_LARGEST_DRAWN = 2.4
#: Smallest half-width of the plane: the unit circle with some room.
_AROUND = 1.18
#: Multipliers of a smaller modulus have a small mark.
_SMALL_MARK = 0.02
#: Multipliers of a smaller modulus have no trail.
_NO_TRAIL = 0.05
#: Marks of successive orbits are not joined if they are farther apart than this.
_LONGEST_TRAIL_STEP = 0.35
_SETS = {"within": "dies out", "outside": "grows", "observer within": "observer",
         "observer outside": "observer, grows"}
_MARK = ("x", "y", "size", "value", "modulus", "angle", "decay", "rank")


def multipliers(orbit: Orbit, theme: Theme, rank: int | None = None) -> figure:
    """Draw the multipliers of an orbit and, if they were computed, of its observer, with the unit circle.

    `rank` is the index of the multiplier that gets a ring.
    """
    return plane(plane_state(orbit, orbit.observer_multipliers is not None, rank), theme)


def plane(state: dict[str, dict[str, Any]], theme: Theme, compact: bool = False) -> figure:
    """Draw the plane from `state`: properties by model name, as `plane_state` returns them."""
    sources = {name: ColumnDataSource(name=name, **properties)
               for name, properties in state.items() if "data" in properties}
    ranges = {axis: DataRange1d(range_padding=0.0) for axis in ("x_range", "y_range")}
    plot = empty_figure(name="multipliers", min_border=2, match_aspect=True, active_scroll=None,
                        toolbar_location=None if compact else "right", **ranges)
    corners = plot.scatter("x", "y", source=sources["reach"], alpha=0.0)
    for data_range in ranges.values():
        data_range.renderers = [corners]
    _circle(plot, compact)
    themed(plot.segment("x", "y", "x1", "y1", source=sources["ways"], line_alpha="alpha"), line_color="soft",
           line_width=1.6)
    themed(plot.scatter("x", "y", source=sources["past"], size=5, line_color=None, fill_alpha="alpha"),
           fill_color="soft")
    themed(plot.scatter("x", "y", source=sources["chosen"], size=28, fill_color=None, line_dash=[3, 3]),
           line_color="ink", line_width=1.8)
    items = _marks(plot, sources, compact)
    for item in items:
        item.update(**state[item.name])
    themed(plot.text("x", "y", "words", source=sources["far"], text_align="align",
                     y_offset="down", text_font_style="bold", text_baseline="middle"), text_color="ink",
           text_font_size="small_figure_text")
    if not compact:
        plot.xaxis.axis_label, plot.yaxis.axis_label = "real part of μ", "imaginary part of μ"
        plot.add_layout(Legend(items=items, orientation="horizontal", padding=0, margin=2, glyph_width=16), "above")
    return apply_theme(plot, theme)


def _circle(plot: figure, compact: bool) -> None:
    """Draw the unit circle, the circle |μ| = 1/2, and both axes."""
    inside = plot.circle(0, 0, radius=1.0, fill_alpha=0.07, level="underlay")
    themed(inside, line_color="ink", line_width=2.0, fill_color="accent")
    plot.grid.visible = False
    if not compact:
        themed(plot.circle(0, 0, radius=0.5, fill_color=None, level="underlay"), line_color="faint", line_width=1.0)
    for dimension in ("width", "height"):
        plot.add_layout(themed(Span(dimension=dimension, location=0.0, level="underlay"), line_color="faint",
                               line_width=1.0))
    for axis in (plot.xaxis[0], plot.yaxis[0]):
        axis.ticker = FixedTicker(ticks=[-2, -1, 0, 1, 2])


def _marks(plot: figure, sources: dict[str, ColumnDataSource], compact: bool) -> list[LegendItem]:
    """Draw the marks of each set, and return its entry in the legend."""
    shown = {}
    for name in _SETS:
        observer, outside = name.startswith("observer"), name.endswith("outside")
        mark = plot.scatter("x", "y", source=sources[name], size="size", marker="square" if observer else
                            "diamond" if outside else "circle", fill_color=None, line_color=None)
        mark.nonselection_glyph = None
        role = "second" if observer else "ink" if outside else "accent"
        if outside:
            themed(mark, line_color=role, line_width=3.2)
        else:
            themed(mark, fill_color=role, line_color="card", line_width=1.0)
        shown[name] = mark
    own = [shown["within"], shown["outside"]]
    if not compact:
        plot.add_tools(
            HoverTool(renderers=list(shown.values()), limit=1, tooltips=[
                ("μ", "@value"), ("|μ|", "@modulus"), ("angle/2π per orbit", "@angle"), ("", "@decay")]),
            TapTool(name="tap", renderers=own, mode="replace"))
    return [LegendItem(name=f"legend of {name}", label=label, renderers=[shown[name]])
            for name, label in _SETS.items()]


def plane_state(orbit: Orbit | None, observer: bool = False, rank: int | None = None,
                before: Sequence[np.ndarray] = ()) -> dict[str, dict[str, Any]]:
    """Return the properties of the plane's sources by their names.

    `observer` adds the observer's multipliers; `before` has those of earlier orbits of the same period, oldest first.
    """
    own = np.zeros(0, dtype=complex) if orbit is None else orbit.multipliers
    others = orbit.observer_multipliers if observer and orbit is not None else None
    every = own if others is None else np.concatenate([own, others])
    reach = min(_LARGEST_DRAWN, max([_AROUND, *(1.12 * np.abs(every))]))
    rows: dict[str, list[tuple[Any, ...]]] = {name: [] for name in _SETS}
    far: list[tuple[Any, ...]] = []
    for prefix, multipliers in (("", own), ("observer ", () if others is None else others)):
        for number, mu in enumerate(multipliers):
            assert orbit is not None
            x, y = _shown(complex(mu), reach)
            kind = prefix + ("outside" if outside(mu, orbit.scene.has_dissipation) else "within")
            rows[kind].append((x, y, _size(abs(mu), kind), *multiplier_words(complex(mu), orbit), number))
            if abs(mu) > reach:
                far.append((x, y, f"|μ| {abs(mu):.3g}", "right" if x > 0.4 else "left" if x < -0.4 else "center",
                            20 if y > 0 else -20))
    ringed = [_shown(complex(own[rank]), reach)] if rank is not None and rank < len(own) else []
    return {
        "reach": _source(("x", "y"), [(-reach, -reach), (reach, reach)]),
        **{name: _source(_MARK, columns) for name, columns in rows.items()},
        **{f"legend of {name}": {"visible": bool(columns)} for name, columns in rows.items()},
        "chosen": _source(("x", "y"), ringed), "far": _source(("x", "y", "words", "align", "down"), far),
        **_trail([*before, own] if len(own) else []),
    }


def multiplier_words(mu: complex, orbit: Orbit) -> tuple[str, str, str, str]:
    """Return a multiplier in words: its value, its modulus, its angle as a frequency, its decay time."""
    size, n = abs(mu), orbit.period
    turn = abs(cmath.phase(mu)) / (2.0 * math.pi)
    decay = ""
    if size > 0.0 and size != 1.0:
        periods = n / abs(math.log(size))
        decay = (f"{'decays' if size < 1.0 else 'grows'} by a factor e in {periods:.3g} drive periods "
                 f"({duration(periods * orbit.scene.period)})")
    real = f"{mu.real:+.4f}".replace("-", "\N{MINUS SIGN}")
    return (real + (f" {'+' if mu.imag > 0 else '−'} {abs(mu.imag):.4f} i" if mu.imag else ""),
            modulus_words(size),
            f"{turn:.3f}: {turn / n:.3g} of the drive frequency, {turn * orbit.scene.f / n:.3g} Hz", decay)


def _shown(mu: complex, reach: float) -> tuple[float, float]:
    """Return the place where a multiplier is drawn."""
    shrink = 0.9 * reach / abs(mu) if abs(mu) > reach else 1.0
    return shrink * mu.real, shrink * mu.imag


def _size(modulus: float, kind: str) -> float:
    if kind == "observer outside":
        return 11.0
    return 11.0 * (1.7 if kind == "outside" else 0.62 if modulus < _SMALL_MARK else 1.0)


def _trail(sets: Sequence[np.ndarray]) -> dict[str, dict[str, Any]]:
    """Return marks of earlier orbits, fainter with age and joined to the nearest of the next; small ones have none."""
    dots, ways = [], []
    for i, (now, after) in enumerate(itertools.pairwise(sets)):
        alpha = 0.12 + 0.6 * (i + 1) / len(sets)
        for mu in now[(np.abs(now) >= _NO_TRAIL) & (np.abs(now) <= _LARGEST_DRAWN)]:
            dots.append((float(mu.real), float(mu.imag), alpha))
            near = after[np.argmin(np.abs(after - mu))]
            if abs(near - mu) < _LONGEST_TRAIL_STEP:
                ways.append((float(mu.real), float(mu.imag), float(near.real), float(near.imag), alpha))
    return {"past": _source(("x", "y", "alpha"), dots), "ways": _source(("x", "y", "x1", "y1", "alpha"), ways)}


def _source(names: Sequence[str], rows: Sequence[tuple[Any, ...]]) -> dict[str, Any]:
    return {"data": {name: [row[i] for row in rows] for i, name in enumerate(names)}}
