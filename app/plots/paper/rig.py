"""A chain at rest between driver and wall, to scale: figures 1 and 8 and, with the fixture around it, figure 4."""

from __future__ import annotations

import numpy as np
from bokeh.models import DataRange1d
from bokeh.plotting import figure

from granchain_core.paper import Rig

from ..theme import Theme
from ..themed import apply_theme, empty_figure, themed

_MM = 1e3


def rig(shown: Rig, theme: Theme) -> figure:
    """Draw the beads with their radii in mm; parts without a size in the text are grey."""
    scene = shown.scene
    rows = list(shown.rows())
    centres = np.array([row["centre_m"] for row in rows]) * _MM
    radii = np.array([row["radius_m"] for row in rows]) * _MM
    radius, end = float(radii[1]), float(centres[-1] + radii[-1])
    plot = empty_figure(name="rig", match_aspect=True, min_border=4, x_range=DataRange1d(range_padding=0.02),
                        y_range=DataRange1d(range_padding=0.04))
    plot.xaxis.axis_label = "distance from the left edge of the driver (mm)"
    plot.yaxis.visible = False
    plot.grid.visible = False
    first = 1 if shown.fixture else 0
    circles = plot.circle(centres[first:], np.zeros(len(centres) - first), radius=radii[first:])
    themed(circles, fill_color="faint", line_color="ink", line_width=1.6)
    _words(plot, centres[first:], 0.0, [str(row["bead"]) for row in rows[first:]], "ink", align="center")
    _wall(plot, end, radius, 4 * radius if shown.fixture else 2 * radius)
    if shown.fixture:
        _fixture(plot, centres, radius, end)
    else:
        _driver(plot, radius, scene.A0, scene.f)
        if scene.k > 0.0:
            _springs(plot, centres[1:], radius)
    low = -1.9 * radius if shown.fixture or scene.k == 0.0 else -4.2 * radius
    _dimension(plot, float(centres[1]) - radius, float(centres[1]) + radius, low, f"2R = {2 * radius:g} mm")
    _dimension(plot, float(centres[1]) - radius, end, low - 1.1 * radius,
               f"{scene.N} beads, {end - float(centres[1]) + radius:.1f} mm")
    bead = scene.bead(1)
    plot.title.text = (f"m = {1e3 * bead.mass:g} g, R = {radius:g} mm, E = {bead.young / 1e9:g} GPa, "
                       f"ν = {bead.poisson:g}, K = {scene.K:.4g} N/m^1.5, wall {scene.wall_factor:.3g} K, "
                       f"D = {scene.D:g} N s/m"
                       + (f", k = {scene.k / 1e3:.3g} kN/m (κ = {scene.kappa:.3g})" if scene.k else ""))
    return apply_theme(plot, theme)


def _driver(plot: figure, radius: float, amplitude: float, f: float) -> None:
    """Draw bead 0 in the drive's colour, with arrows in the directions of its motion."""
    bead = plot.circle(radius, 0.0, radius=radius, fill_alpha=0.25)
    themed(bead, fill_color="drive", line_color="drive", line_width=2.0)
    arrow = plot.segment([-0.2 * radius], [1.5 * radius], [2.2 * radius], [1.5 * radius])
    heads = plot.scatter([-0.2 * radius, 2.2 * radius], [1.5 * radius] * 2, marker="triangle", size=10,
                         angle=[np.pi / 2, -np.pi / 2])
    themed(arrow, line_color="drive", line_width=2.0)
    themed(heads, line_color="drive", fill_color="drive")
    _words(plot, [-0.4 * radius], 2.2 * radius,
           [f"driver: u0 = A0 sin(2πft), A0 = {1e6 * amplitude:g} µm, f = {f:g} Hz"], "drive")


def _wall(plot: figure, left: float, radius: float, height: float) -> None:
    wall = plot.quad(left=[left], right=[left + radius], bottom=[-0.5 * height - radius], top=[0.5 * height + radius],
                     hatch_pattern="/", hatch_alpha=0.6, fill_alpha=0.2)
    themed(wall, fill_color="steel", line_color="ink", line_width=1.6, hatch_color="ink")
    _words(plot, [left + 0.5 * radius], 0.5 * height + 1.1 * radius, ["wall"], "ink", align="center", up=True)


def _springs(plot: figure, centres: np.ndarray, radius: float) -> None:
    """Draw the symbol of a spring from every bead to the ground."""
    top, bottom = -radius, -3.2 * radius
    y = np.linspace(top, bottom, 11)
    across = np.concatenate([[0.0, 0.0], np.tile([0.3, -0.3], 4)[:7], [0.0, 0.0]]) * radius
    themed(plot.multi_line([c + across for c in centres], [y] * len(centres)), line_color="second", line_width=1.6)
    ground = plot.segment([centres[0] - radius], [bottom], [centres[-1] + radius], [bottom])
    themed(ground, line_color="ink", line_width=2.0)


def _fixture(plot: figure, centres: np.ndarray, radius: float, end: float) -> None:
    """Draw in grey the parts that the text describes without sizes: flexures, shaft, pillars, shaker, sensors."""
    shaft, foot = 4.2 * radius, -1.2 * radius
    pillars = plot.quad(left=[centres[1] - 2.6 * radius, end + radius],
                        right=[centres[1] - 2.1 * radius, end + 1.5 * radius],
                        bottom=[foot - 0.4 * radius] * 2, top=[shaft + radius] * 2, fill_alpha=0.3, line_dash=[5, 3])
    themed(pillars, fill_color="soft", line_color="soft", line_width=1.2)
    rod = plot.segment([centres[1] - 2.1 * radius], [shaft], [end + radius], [shaft], line_dash=[5, 3])
    themed(rod, line_color="soft", line_width=3.0)
    ones = np.ones(len(centres) - 1)
    flexures = plot.segment(centres[1:], radius * ones, centres[1:], shaft * ones)
    themed(flexures, line_color="second", line_width=1.6)
    left = float(centres[1] - radius)
    boxes = plot.quad(left=[left - 7.6 * radius, left - 0.45 * radius, end - 0.02 * radius],
                      right=[left - 4.8 * radius, left, end + 0.4 * radius],
                      bottom=[-1.2 * radius, -0.3 * radius, -0.3 * radius],
                      top=[1.2 * radius, 0.3 * radius, 0.3 * radius], fill_alpha=0.5, line_dash=[5, 3])
    themed(boxes, fill_color="steel", line_color="soft", line_width=1.2)
    stinger = plot.segment([left - 4.8 * radius], [0.0], [left - 0.45 * radius], [0.0])
    themed(stinger, line_color="drive", line_width=4.0)
    laser = plot.segment([left - 4.0 * radius], [3.6 * radius], [left - 4.0 * radius], [0.0], line_dash=[2, 3])
    themed(laser, line_color="drive", line_width=1.6)
    for x, y, words in ((left - 7.6 * radius, 1.8 * radius, "shaker"),
                        (left - 6.5 * radius, 4.1 * radius, "laser vibrometer"),
                        (left - 7.6 * radius, -1.8 * radius, "stinger, force transducer"),
                        (float(centres[4]), shaft + 0.8 * radius, "flexures in holders on threaded shafts"),
                        (end - 7.2 * radius, -1.4 * radius, "force transducer at the wall")):
        _words(plot, [x], y, [words], "soft")


def _dimension(plot: figure, left: float, right: float, y: float, words: str) -> None:
    """Draw a line from `left` to `right` with its length."""
    ends = plot.scatter([left, right], [y, y], marker="dash", angle=np.pi / 2, size=10)
    line = plot.segment([left], [y], [right], [y])
    for mark in (ends, line):
        themed(mark, line_color="soft", line_width=1.2)
    _words(plot, [right if right - left < 60.0 else 0.5 * (left + right)], y, [words], "soft",
           align="left" if right - left < 60.0 else "center", up=right - left >= 60.0)


def _words(plot: figure, x: object, y: float, words: list[str], role: str, align: str = "left",
           up: bool = False) -> None:
    text = plot.text(x, [y] * len(words), text=words, text_align=align, text_baseline="bottom" if up else "middle",
                     x_offset=6 if align == "left" else 0)
    themed(text, text_color=role, text_font_size="small_figure_text")
