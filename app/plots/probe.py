"""One bead of a motion: displacement, velocity, contact forces, phase portrait with stroboscopic points, and spectrum.

A further figure shows when each contact of the chain is closed, as in figure 12 of Zhang et al. (2016). Every figure is
drawn from a run and a bead. `probe_state` returns the properties of its models by their names, so that a page can fill
the same figures with the next motion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Range1d
from bokeh.plotting import figure

from granchain_core import Run
from granchain_core.analysis.spectrum import cosines

from ..format import prefixed
from .theme import Theme
from .themed import apply_theme, empty_figure, span_of, themed

#: Most points of a line; a longer motion is thinned out evenly.
_MOST_ROWS = 700
#: Upper end of the spectrum, as a multiple of the drive frequency.
_LAST_HARMONIC = 12.5
#: Columns of a source that glyphs refer to.
_COLUMNS = ("x", "y", "floor", "number", "contact", "from", "to")
#: The smallest amplitude of the spectrum, divided by its largest.
_SMALLEST_AMPLITUDE = 1e-4


def probe(name: str, run: Run, bead: int, theme: Theme) -> figure:
    """Draw the figure of this name, one of `FIGURES`, for a bead (counted from 1)."""
    plot = FIGURES[name]()
    models = {model.name: model for model in plot.references() if model.name}
    for model, properties in probe_state(run, bead)[name].items():
        models[model].update(**properties)
    return apply_theme(plot, theme)


def without_points(name: str, theme: Theme, compact: bool = False) -> figure:
    """Return the figure of this name without data, which a page fills with `probe_state`; `compact` omits the tools."""
    plot = FIGURES[name]()
    if compact:
        plot.toolbar_location = None
        for axis in (plot.xaxis[0], plot.yaxis[0]):
            axis.ticker.desired_num_ticks = 2
    return apply_theme(plot, theme)


def _displacement() -> figure:
    return _over_time("displacement")


def _velocity() -> figure:
    return _over_time("velocity")


def _forces() -> figure:
    plot, sources = _frame("forces", ("before", "after"))
    for name, role, dash, words in (("before", "input", "solid", "towards the driver"),
                                    ("after", "output", [7, 4], "towards the wall")):
        themed(plot.line("x", "y", source=sources[name], line_dash=dash, legend_label=words), line_color=role,
               line_width=2.2)
    plot.legend.update(orientation="horizontal", padding=0, margin=2, click_policy="hide")
    plot.add_layout(plot.legend[0], "above")
    return plot


def _contacts() -> figure:
    plot, sources = _frame("contacts", ("closed", "own"))
    for name, role in (("closed", "soft"), ("own", "accent")):
        bars = themed(plot.hbar("contact", left="from", right="to", height=0.62, source=sources[name],
                                line_color=None), fill_color=role)
        plot.add_tools(HoverTool(renderers=[bars], tooltips=[
            ("contact", "@contact"), ("closed from", "@from{0.000}"), ("to", "@to{0.000}")]))
    plot.yaxis[0].ticker.update(desired_num_ticks=8, num_minor_ticks=0, mantissas=[1, 2, 5])
    return plot


def _phase() -> figure:
    plot, sources = _frame("phase", ("way", "strobe"))
    themed(plot.line("x", "y", source=sources["way"], line_alpha=0.8), line_color="accent", line_width=1.8)
    dots = themed(plot.scatter("x", "y", size=12, source=sources["strobe"], line_width=2), fill_color="drive",
                  line_color="card")
    plot.add_tools(HoverTool(renderers=[dots], tooltips=[("start of drive period", "@number"), ("displacement", "@x"),
                                                         ("velocity", "@y")]))
    return plot


def _spectrum() -> figure:
    plot, sources = _frame("spectrum", ("lines",), y_axis_type="log")
    themed(plot.segment("x", "floor", "x", "y", source=sources["lines"]), line_color="accent", line_width=3.0)
    dots = themed(plot.scatter("x", "y", size=7, source=sources["lines"], line_color=None), fill_color="accent")
    plot.add_tools(HoverTool(renderers=[dots], tooltips=[("frequency over drive frequency", "@x{0.00}"),
                                                         ("amplitude", "@y{0.000e}")]))
    return plot


#: The figures by name: displacement, velocity and the forces of both contacts over time; when each contact is closed,
#: from the driver's (0) to the wall's (N); velocity over displacement, with a dot at the start of every drive period;
#: amplitudes over frequency.
FIGURES: dict[str, Callable[[], figure]] = {
    "displacement": _displacement, "velocity": _velocity, "forces": _forces, "contacts": _contacts, "phase": _phase,
    "spectrum": _spectrum}


def probe_state(run: Run, bead: int) -> dict[str, dict[str, dict[str, Any]]]:
    """Return the properties of the models of every figure, by figure and model name. Beads are counted from 1."""
    index = bead - 1
    time, time_unit = _scaled(run.time, "s")
    u, u_unit = _scaled(run.displacement[:, index], "m")
    v, v_unit = _scaled(run.velocity[:, index], "m/s")
    both, force_unit = _scaled(run.force[:, index:index + 2], "N")
    seconds = {"x": f"time ({time_unit})"}
    thin = slice(None, None, max(1, -(-len(time) // _MOST_ROWS)))
    closed = closed_spells(run)
    own = [(c, a, b) for c, a, b in closed if c in (index, bead)]
    others = [(c, a, b) for c, a, b in closed if c not in (index, bead)]
    factor = run.time[-1] / time[-1] if time[-1] else 1.0
    lines, amplitude = amplitudes(run, index)
    shown, amplitude_unit = _scaled(amplitude, "m")
    note = {} if run.regime.name == "periodic" else {"note": f"{round((len(time) - 1) / run.samples)} periods"}
    strobes = slice(0, -1, run.samples)
    state = {
        "displacement": _line({"line": (time, u)}, thin, seconds | {"y": f"displacement ({u_unit})"}),
        "velocity": _line({"line": (time, v)}, thin, seconds | {"y": f"velocity ({v_unit})"}),
        "forces": _line({"before": (time, both[:, 0]), "after": (time, both[:, 1])}, thin,
                        seconds | {"y": f"contact force ({force_unit})"}),
        "contacts": {
            "closed": _bars(others, factor), "own": _bars(own, factor),
            **_axes(seconds | {"y": "contact, from driver to wall"}),
            "across": _ends(0.0, float(time[-1])), "up": _ends(-0.6, run.scene.N + 0.6)},
        "phase": _line({"way": (u, v)}, thin, {"x": f"displacement ({u_unit})", "y": f"velocity ({v_unit})"}),
        "spectrum": {
            "lines": {"data": {"x": _short(lines), "y": _short(np.maximum(shown, 1e-300)),
                               "floor": [_SMALLEST_AMPLITUDE * float(shown.max())] * len(lines)}},
            **_axes({"x": "frequency / drive frequency" + "".join(f" ({words} recorded)" for words in note.values()),
                     "y": f"amplitude ({amplitude_unit})"}),
            "across": _ends(-0.2, _LAST_HARMONIC),
            "up": _ends(_SMALLEST_AMPLITUDE * float(shown.max()), 2.0 * float(shown.max()))}}
    state["phase"]["strobe"] = {"data": {"x": _short(u[strobes]), "y": _short(v[strobes]),
                                         "number": list(range(1, len(u[strobes]) + 1))}}
    return state


def closed_spells(run: Run) -> list[tuple[int, float, float]]:
    """Return contact, start and end [s] of every contact phase; overlaps are linear in time between samples."""
    spells = []
    for contact, overlap in enumerate(run.overlap.T):
        shut = np.concatenate([[False], overlap > 0.0, [False]])
        begins, ends = np.flatnonzero(~shut[:-1] & shut[1:]), np.flatnonzero(shut[:-1] & ~shut[1:])
        spells += [(contact, _crossing(run.time, overlap, int(begin)), _crossing(run.time, overlap, int(end)))
                   for begin, end in zip(begins, ends, strict=True)]
    return spells


def amplitudes(run: Run, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies over the drive's, up to _LAST_HARMONIC, and amplitudes of a bead's displacement [m]."""
    motion = run.displacement[:-1, index]
    periods = len(motion) / run.samples
    repeats = run.regime.period is not None and periods % run.regime.period == 0
    magnitudes = np.abs(cosines(motion, repeats))
    multiples = np.arange(len(magnitudes)) / periods
    kept = (multiples > 0.0) & (multiples <= _LAST_HARMONIC)
    return multiples[kept], magnitudes[kept]


def _crossing(time: np.ndarray, overlap: np.ndarray, after: int) -> float:
    """Return when the overlap vanishes between the samples before and at `after`; at an end of the record, its time."""
    if not 0 < after < len(time):
        return float(time[min(after, len(time) - 1)])
    a, b = overlap[after - 1], overlap[after]
    return float(time[after - 1] + (time[after] - time[after - 1]) * (a / (a - b)))


def _over_time(name: str) -> figure:
    plot, sources = _frame(name, ("line",))
    themed(plot.line("x", "y", source=sources["line"]), line_color="accent", line_width=2.2)
    return plot


def _frame(name: str, sources: tuple[str, ...], **options: Any) -> tuple[figure, dict[str, ColumnDataSource]]:
    plot = empty_figure(name=f"probe {name}", min_border=4, x_range=Range1d(name="across"), y_range=Range1d(name="up"),
                        active_scroll=None, **options)
    plot.xaxis[0].name, plot.yaxis[0].name = "x axis", "y axis"
    for axis in (plot.xaxis[0], plot.yaxis[0]):
        axis.ticker.desired_num_ticks = 4
    empty: dict[str, list[float]] = {column: [] for column in _COLUMNS}
    return plot, {source: ColumnDataSource(name=source, data=dict(empty)) for source in sources}


def _line(lines: dict[str, tuple[np.ndarray, np.ndarray]], thin: slice, titles: dict[str, str]) -> dict[str, Any]:
    across, up = (np.concatenate([pair[i] for pair in lines.values()]) for i in (0, 1))
    return {**{name: {"data": {"x": _short(x[thin]), "y": _short(y[thin])}} for name, (x, y) in lines.items()},
            **_axes(titles), "across": _span(across), "up": _span(up)}


def _bars(spells: list[tuple[int, float, float]], factor: float) -> dict[str, Any]:
    return {"data": {"contact": [c for c, _, _ in spells], "from": [a / factor for _, a, _ in spells],
                     "to": [b / factor for _, _, b in spells]}}


def _axes(titles: dict[str, str]) -> dict[str, Any]:
    return {f"{which} axis": {"axis_label": words} for which, words in titles.items()}


def _span(values: np.ndarray) -> dict[str, float]:
    span = span_of(float(values.min()), float(values.max()), 0.05)
    return _ends(span.start, span.end)


def _ends(start: float, end: float) -> dict[str, float]:
    return {"start": start, "end": end, "reset_start": start, "reset_end": end}


def _scaled(values: np.ndarray, unit: str) -> tuple[np.ndarray, str]:
    factor, letter = prefixed(float(np.abs(values).max()))
    return values / factor, letter + unit


def _short(values: np.ndarray) -> list[float]:
    """Return the values to five digits, more than can be seen in a figure."""
    return [float(f"{value:.5g}") for value in values]
