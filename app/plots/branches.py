"""Branches of periodic orbits: largest force over the knob, stable solid, unstable dashed, with special points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, DataRange1d, HoverTool, Legend, LegendItem, Scatter, Span, TapTool
from bokeh.plotting import figure

from granchain_core import CurvePoint
from granchain_core.orbits import Branch, BranchPoint, SpecialPoint
from granchain_core.orbits.branch.normal_forms import SUPERCRITICAL
from granchain_core.results.regime import modulus_words

from ..format import in_words, short_error
from .axes import Scale, force_scale, knob_scale
from .curve import line_pieces
from .theme import AMBER, GREY, TEAL, VIOLET, Theme
from .themed import apply_theme, empty_figure, themed

SPECIAL = {"fold": "fold", "period_doubling": "period doubling", "neimark_sacker": "Neimark–Sacker (torus)",
           "multiplier_one": "multiplier +1 without a fold", "grazing": "grazing"}
#: Marks of special points, on branches and on the bifurcation curves of a map.
SPECIAL_STYLES: dict[str, dict[str, Any]] = {
    "fold": {"marker": "inverted_triangle", "size": 14, "colour": AMBER, "filled": True},
    "period_doubling": {"marker": "hex", "size": 14, "colour": VIOLET, "filled": True},
    "neimark_sacker": {"marker": "circle", "size": 12, "colour": TEAL, "filled": False},
    "multiplier_one": {"marker": "square", "size": 12, "colour": AMBER, "filled": False},
    "grazing": {"marker": "cross", "size": 9, "colour": GREY, "filled": True},
}
#: The new motions that start at a sub- or supercritical bifurcation.
_BORN = {"period_doubling": "an orbit of twice the period", "neimark_sacker": "a closed curve of the map"}
#: Width and dash of the lines.
LINES = {"stable": (2.6, "solid"), "unstable": (1.8, [6, 4])}
_ORBIT = ("x", "y", "tooltip", "elastic", "output", "input", "period", "motion", "residual", "stable", "target", "arm",
          "place")
_MARK = ("x", "y", "tooltip", "criticality", "place")
#: Source of the points of the resonance curve behind the branches.
_CURVE = "curve"
#: Source of the lines between neighbouring points of that curve that are both periodic.
_CURVE_LINE = "curve line"
_TITLE = "largest elastic output force"
#: Diameter of an orbit's target for the pointer [px]; it is smaller for the orbits next to a special point.
_TARGET = 13

Columns = dict[str, dict[str, list[Any]]]


class BranchRows:
    """Branches as they grow: `add` returns the data that a new piece of a half-branch adds to the figure's sources.

    The unit of force is chosen for `largest` [N] or, if that is not known, for the first orbit. `orbits` has all drawn
    orbits of every half-branch and `special` all special points, in order; the sources refer to them by number.
    """

    def __init__(self, largest: float | None = None) -> None:
        self._force = None if largest is None else force_scale(_TITLE, largest)
        self._knob: Scale | None = None
        self._last: dict[int, tuple[str, int]] = {}
        self._pieces = dict.fromkeys(LINES, 0)
        self._models: dict[str, dict[str, Any]] = {}
        self._curve_shown = False
        self.orbits: dict[int, list[BranchPoint]] = {}
        self.special: list[SpecialPoint] = []

    def add(self, half: int, branch: Branch, points: list[BranchPoint], special: list[SpecialPoint]) -> dict[str, Any]:
        """Return new rows by source, line pieces to append as (source, number, x, y), and changed model properties."""
        new = drawn_orbits(points, special)
        self._choose_scales(branch.axis.knob, branch.axis.high, new[0].max_output_force_elastic)
        before = self.orbits.setdefault(half, [])
        beside = {p for s in special for p in (s.before, s.after)}
        rows: Columns = {"orbits": _columns(_ORBIT, [
            (*self._place(p), *_orbit_words(p, branch), 1 if p in beside else _TARGET, half, len(before) + i)
            for i, p in enumerate(new)])}
        for kind in SPECIAL:
            rows[kind] = _columns(_MARK, [
                (*self._place(s.before, s.knob), special_words(s, branch), criticality_words(s),
                 len(self.special) + i)
                for i, s in enumerate(special) if s.kind == kind])
        pieces = self._lines(half, before[-1:], new)
        before.extend(new)
        self.special.extend(special)
        return {"rows": rows, "pieces": pieces,
                "models": self._fresh({f"legend of {s.kind}": {"visible": True} for s in special})}

    def curve(self, points: Sequence[CurvePoint]) -> dict[str, Any] | None:
        """Return the data of the resonance curve's points, in order of frequency; None if there is nothing new."""
        points = [point for point in points if np.isfinite(point.max_output_force_elastic)]
        if self._curve_shown or not points:
            return None
        self._curve_shown = True
        self._choose_scales("f", points[-1].frequency, max(point.max_output_force_elastic for point in points))
        places = [self._scaled(point.frequency, point.max_output_force_elastic) for point in points]
        runs = [run for run in line_pieces(points) if len(run) > 1 and points[run[0]].regime.period is not None]
        pieces = [[_CURVE_LINE, number, *map(list, zip(*(places[i] for i in run), strict=True))]
                  for number, run in enumerate(runs)]
        return {"rows": {_CURVE: _columns(("x", "y"), places)}, "pieces": pieces,
                "models": self._fresh({f"legend of {_CURVE}": {"visible": True}})}

    def _choose_scales(self, knob: str, high: float, force: float) -> None:
        """Choose the units of both axes, unless something has already been drawn."""
        self._force = self._force or force_scale(_TITLE, force)
        self._knob = self._knob or knob_scale(knob, (high,))

    def _fresh(self, models: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        """Return the properties, including the axis labels, that have not been sent yet."""
        assert self._knob is not None and self._force is not None
        models = {**models, "knob": {"axis_label": self._knob.label}, "force": {"axis_label": self._force.label}}
        fresh = {name: properties for name, properties in models.items() if name not in self._models}
        self._models |= fresh
        return fresh

    def _place(self, point: BranchPoint, knob: float | None = None) -> tuple[float, float]:
        return self._scaled(point.knob if knob is None else knob, point.max_output_force_elastic)

    def _scaled(self, knob: float, force: float) -> tuple[float, float]:
        assert self._knob is not None and self._force is not None
        return knob / self._knob.factor, force / self._force.factor

    def _lines(self, half: int, last: list[BranchPoint], new: list[BranchPoint]) -> list[list[Any]]:
        """Return pieces on which either all orbits are stable or none is; each starts where its half-branch ended."""
        pieces: list[list[Any]] = []
        for point in new:
            source = "stable" if point.stable else "unstable"
            if half not in self._last or self._last[half][0] != source:
                self._last[half] = source, self._pieces[source]
                self._pieces[source] += 1
                pieces.append([*self._last[half], *([value] for value in self._place(last[0]))] if last else
                              [*self._last[half], [], []])
            elif not pieces:
                pieces.append([*self._last[half], [], []])
            for column, value in zip(pieces[-1][2:], self._place(point), strict=True):
                column.append(value)
            last = [point]
        return pieces


def branches(drawn: Sequence[Branch], theme: Theme, now: float | None = None, compact: bool = False) -> figure:
    """Draw the largest elastic output force of periodic orbits over the knob of their branches.

    `now` is a value of the knob [SI] marked by a line. Sources have names: "stable" and "unstable" contain lines,
    "orbits" a row for each orbit, and those of the kinds of special points a row for each point. `BranchRows` has the
    data that a new orbit adds.
    """
    rows = BranchRows(max((p.max_output_force_elastic for branch in drawn for p in branch.points), default=1e-3))
    data: Columns = {**{name: {"x": [], "y": []} for name in (_CURVE, _CURVE_LINE, *LINES)},
                     "orbits": _columns(_ORBIT, []), **{kind: _columns(_MARK, []) for kind in SPECIAL}}
    models: dict[str, Any] = {}
    number = 0
    for branch in drawn:
        for half in branch.half_branches:
            if half.points:
                added = rows.add(number, branch, half.points, half.special)
                _put(data, added)
                models |= added["models"]
            number += 1
    plot = _drawn(data, theme, compact)
    factor = knob_scale(drawn[0].axis.knob, (drawn[0].axis.high,)).factor if drawn else 1.0
    plot.select_one({"name": "now"}).update(location=None if now is None else now / factor, visible=now is not None)
    if not compact:
        for name, properties in models.items():
            plot.select_one({"name": name}).update(**properties)
    return plot


def _put(data: Columns, added: dict[str, Any]) -> None:
    """Append the rows and line pieces of `added` to the columns."""
    for name, columns in added["rows"].items():
        for column, values in columns.items():
            data[name][column].extend(values)
    for name, number, x, y in added["pieces"]:
        for column, values in (("x", x), ("y", y)):
            if number == len(data[name][column]):
                data[name][column].append([])
            data[name][column][number].extend(values)


def _drawn(data: Columns, theme: Theme, compact: bool) -> figure:
    plot = empty_figure(name="branches", min_border=4, toolbar_location=None if compact else "right",
                        x_range=DataRange1d(range_padding=0.02), y_range=DataRange1d(start=0, range_padding=0.06))
    if not compact:
        plot.xaxis[0].name, plot.yaxis[0].name = "knob", "force"
    sources = {name: ColumnDataSource(columns, name=name) for name, columns in data.items()}
    grey = [plot.multi_line("x", "y", source=sources[_CURVE_LINE], line_width=1.2, line_color=GREY, line_alpha=0.8),
            plot.scatter("x", "y", source=sources[_CURVE], size=2.5, line_color=None, fill_color=GREY, fill_alpha=0.8)]
    items = [LegendItem(name=f"legend of {_CURVE}", label="resonance curve, from rest", renderers=grey, visible=False)]
    for name, (width, dash) in LINES.items():
        line = plot.multi_line("x", "y", source=sources[name], line_dash=dash, line_join="round")
        items.append(LegendItem(label=name, renderers=[themed(line, line_color="output", line_width=width)]))
    dots = plot.scatter("x", "y", source=sources["orbits"], size=1 if compact else 4.5, line_color=None)
    targets = plot.scatter("x", "y", source=sources["orbits"], size="target", alpha=0.0, fill_color=None)
    chosen = targets.selection_glyph = Scatter(size=_TARGET, line_width=2.5, fill_color=None)
    chosen.line_color = theme.ink
    dots.nonselection_glyph = targets.nonselection_glyph = None
    themed(dots, fill_color="output")
    plot.add_layout(themed(Span(name="now", dimension="height", line_alpha=0.6, level="underlay", visible=False),
                           line_color="ink", line_width=1.2))
    items += [LegendItem(name=f"legend of {kind}", label=SPECIAL[kind], renderers=[mark], visible=False)
              for kind, mark in _marks(plot, sources, compact).items()]
    for data_range in (plot.x_range, plot.y_range):
        data_range.renderers = [targets, grey[1]]
    if not compact:
        _tools(plot, targets, items)
        plot.xaxis.axis_label, plot.yaxis.axis_label = knob_scale("f").label, _TITLE
    for axis in (plot.xaxis[0], plot.yaxis[0]):
        axis.ticker.desired_num_ticks = 4 if compact else 7
    return apply_theme(plot, theme)


def _marks(plot: figure, sources: dict[str, ColumnDataSource], compact: bool) -> dict[str, Any]:
    """Draw the special points, without grazings in a small figure, for which they are too many."""
    made = {}
    for kind, style in SPECIAL_STYLES.items():
        mark = plot.scatter("x", "y", source=sources[kind], marker=style["marker"], line_color=style["colour"],
                            fill_color=style["colour"], size=0.75 * style["size"] if compact else style["size"],
                            visible=not (compact and kind == "grazing"))
        mark.nonselection_glyph = None
        themed(mark, line_width=2.2) if style["filled"] else themed(mark, line_width=2.2, fill_color="card")
        made[kind] = mark
    return made


def _tools(plot: figure, targets: Any, items: list[LegendItem]) -> None:
    """Add hover and tap for orbits and special points, and a legend, where a click on an entry hides its marks."""
    marks = {kind: mark for item in items for mark in item.renderers for kind, words in SPECIAL.items()
             if item.label.value == words}
    born, others = ([mark for kind, mark in marks.items() if (kind in _BORN) is wanted] for wanted in (True, False))
    above: dict[str, Any] = {"limit": 2, "attachment": "above"}
    plot.add_tools(
        HoverTool(renderers=[targets], limit=1, attachment="below", tooltips=[
            ("orbit", "@tooltip"), ("motion", "@motion"), ("elastic output force", "@elastic"),
            ("output force", "@output"), ("input force", "@input"), ("relative error of the orbit", "@residual")]),
        HoverTool(renderers=born, tooltips=[("", "@tooltip"), ("", "@criticality")], **above),
        HoverTool(renderers=others, tooltips=[("", "@tooltip")], **above),
        TapTool(name="tap", renderers=[targets, *marks.values()], mode="replace"))
    plot.add_layout(Legend(name="legend", items=items, click_policy="hide", orientation="horizontal", ncols=len(items),
                           padding=0, margin=4, spacing=12, glyph_width=26), "below")


def drawn_orbits(points: list[BranchPoint], special: list[SpecialPoint]) -> list[BranchPoint]:
    """Return the orbits to draw of a piece of a branch, in order.

    They include the two orbits around each special point, so that the line changes its dash where stability changes.
    """
    return sorted([*points, *(p for s in special for p in (s.before, s.after))], key=lambda point: point.arclength)


def special_words(special: SpecialPoint, branch: Branch) -> str:
    """Return the kind of a special point, its knob value with the uncertainty, and the evidence for the kind."""
    scale = knob_scale(branch.axis.knob, (branch.axis.high,))
    low, high = special.interval
    words = (f"{SPECIAL[special.kind].removesuffix(' (torus)')} at {special.knob / scale.factor:.4f} ± "
             f"{0.5 * (high - low) / scale.factor:.4f} {scale.unit}")
    if special.contact is not None:
        side = special.gained_side
        where = "on one side" if side is None else f"{side} {special.knob / scale.factor:.4f} {scale.unit}"
        words += f": contact {special.contact} has one {special.gained} more per orbit {where}"
    elif special.kind == "neimark_sacker" and special.multiplier is not None:
        words += (f": a pair μ = {special.multiplier.real:+.3f} ± {abs(special.multiplier.imag):.3f}i crosses the unit "
                  "circle")
    return words


def criticality_words(special: SpecialPoint) -> str:
    """Say whether a period doubling or Neimark–Sacker point is supercritical and, if stability changes, what follows.

    Return "" for other kinds.
    """
    new, form = _BORN.get(special.kind), special.normal_form
    if new is None or form is None:
        return ""
    words = special.criticality_words()
    if form.reason or special.before.stable == special.after.stable:
        return words
    if form.criticality == SUPERCRITICAL:
        return f"{words}: near it, on the unstable side, {new} attracts"
    return f"{words}: near it, on the stable side, {new} repels"


def _orbit_words(point: BranchPoint, branch: Branch) -> tuple[Any, ...]:
    """Return the columns of an orbit from `tooltip` to `stable`."""
    scale = knob_scale(branch.axis.knob, (branch.axis.high,))
    forces = (point.max_output_force_elastic, point.max_output_force, point.max_input_force)
    return (f"{point.knob / scale.factor:.7g} {scale.unit}, period {branch.period}",
            *(in_words(force, "N") for force in forces), branch.period,
            f"{'stable' if point.stable else 'unstable'}, |μ| {modulus_words(abs(point.multipliers[0]))}",
            short_error(point.residual), int(point.stable))


def _columns(names: Sequence[str], rows: Sequence[tuple[Any, ...]]) -> dict[str, list[Any]]:
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}
