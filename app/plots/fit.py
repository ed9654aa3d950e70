"""A fit: the data over the model, residuals below, and each parameter's misfit landscape with its profile."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from bokeh.layouts import column, row
from bokeh.models import ColumnDataSource, HoverTool, LayoutDOM, Span
from bokeh.plotting import figure

from granchain_core import Curve, Fit
from granchain_core.fitting import CurveTarget, FeatureTarget, Free, RecordsTarget, SeriesTarget

from ..format import prefixed
from .axes import Scale, force_scale, knob_scale
from .curve import curve_columns
from .measured import measured_over, residuals_over
from .theme import Theme
from .themed import apply_theme, empty_figure, themed

#: Most parameters whose landscape is drawn.
_MOST_LANDSCAPES = 4
#: Most drive periods drawn of a series.
_MOST_PERIODS = 3
#: Height of the residuals divided by the height of the data.
_RESIDUALS_HEIGHT = 0.42
#: Smallest rise above the minimum that is drawn on the logarithmic axis.
_SMALLEST_RISE = 1e-2


def fit(result: Fit, theme: Theme) -> LayoutDOM:
    """Draw the data and the model on the left, the landscapes on the right."""
    target = result.target
    if isinstance(target, CurveTarget):
        left = _curve(result, target, theme)
    elif isinstance(target, FeatureTarget):
        left = _features(result, target, theme)
    elif isinstance(target, RecordsTarget):
        left = _records(result, target, theme)
    else:
        left = _series(target, result.evaluation.model, result.scene.period, _verdict(result), theme)
    right = column([_landscape(result, i, theme) for i in range(min(len(result.free), _MOST_LANDSCAPES))],
                   sizing_mode="stretch_both")
    return row([left, right], sizing_mode="stretch_both")


def _line(plot: figure, curve: Curve, name: str, factor: float) -> None:
    """Draw the model's curve with its regimes."""
    points = [p for p in curve.points if math.isfinite(p.max_output_force)]
    source = ColumnDataSource(name="model", data=curve_columns(points, factor, 2, name))
    themed(plot.line("frequency", "force", source=source), line_color="output", line_width=1.8)
    marks = plot.scatter("frequency", "force", source=source, marker="marker", size="size", fill_color="colour",
                         line_color="colour", line_width=1.5)
    plot.add_tools(HoverTool(renderers=[marks], tooltips=[("drive frequency", "@frequency{0.0} Hz"),
                                                          ("largest output force", "@total"), ("motion", "@sentence")]))


def _curve(result: Fit, target: CurveTarget, theme: Theme) -> LayoutDOM:
    name = "max_output_force_elastic" if target.elastic else "max_output_force"
    scale = force_scale("largest elastic output force" if target.elastic else "largest output force",
                        float(np.nanmax([target.measured.force.max(), np.nanmax(result.evaluation.model)])))
    plot = empty_figure(name="data", min_border=4)
    assert result.evaluation.curve is not None
    _line(plot, result.evaluation.curve, name, scale.factor)
    measured_over(plot, target.measured, scale.factor, target.sigma)
    plot.yaxis.axis_label = scale.label
    plot.y_range.start = 0
    plot.title.text = _verdict(result)
    below = residuals_over(target.frequencies, result.evaluation.residuals, "residual / σ")
    below.x_range = plot.x_range
    return _stacked(apply_theme(plot, theme), apply_theme(below, theme))


def _features(result: Fit, target: FeatureTarget, theme: Theme) -> LayoutDOM:
    curve = result.evaluation.curve
    assert curve is not None
    scale = force_scale("largest elastic output force", float(np.nanmax(curve.column("max_output_force_elastic"))))
    plot = empty_figure(name="data", min_border=4)
    _line(plot, curve, "max_output_force_elastic", scale.factor)
    for feature, model in zip(target.features, result.evaluation.model, strict=True):
        role = "drive" if feature.is_resonance else "soft"
        plot.add_layout(themed(Span(location=feature.frequency, dimension="height", line_dash=[2, 4]), line_color=role,
                               line_width=1.8))
        if math.isfinite(model):
            plot.add_layout(themed(Span(location=float(model), dimension="height"), line_color=role, line_width=0.8))
    plot.yaxis.axis_label, plot.xaxis.axis_label = scale.label, knob_scale("f").label
    plot.title.text = "Dotted: stated; thin: the model's nearest of the same kind (peak red, valley grey)"
    below = residuals_over(target.frequencies, result.evaluation.residuals, "residual / σ")
    below.x_range = plot.x_range
    return _stacked(apply_theme(plot, theme), apply_theme(below, theme))


def _records(result: Fit, target: RecordsTarget, theme: Theme) -> LayoutDOM:
    """Draw each record over the model, below the previous record."""
    figures: list[LayoutDOM] = []
    for record, samples, _ in target.parts(result.evaluation):
        assert record.frequency is not None
        title = f"{record.frequency:g} Hz" if figures else f"{record.frequency:g} Hz – {_verdict(result)}"
        figures.append(_series(record, result.evaluation.model[samples], 1.0 / record.frequency, title, theme))
    return column(figures, sizing_mode="stretch_both")


def _series(target: SeriesTarget, models: np.ndarray, period: float, title: str, theme: Theme) -> figure:
    """Draw the first periods of the measured forces over the model's; `models` has those of all channels in a row."""
    channels, time = target.channels, target.time
    count = min(len(time), int(np.searchsorted(time, _MOST_PERIODS * period)) + 1)
    scale = force_scale("force", max(float(np.abs(values).max()) for values in channels.values()))
    plot, first = empty_figure(name="data", min_border=4), 0
    for name, role in (("input_force", "input"), ("output_force", "output")):
        if name not in channels:
            continue
        model = models[first : first + len(channels[name])]
        first += len(channels[name])
        themed(plot.line(1e3 * time[:count], model[:count] / scale.factor), line_color=role, line_width=1.8)
        themed(plot.scatter(1e3 * time[:count], channels[name][:count] / scale.factor, size=5, fill_color=None,
                            line_width=1, legend_label=name.replace("_", " ")), line_color=role)
    plot.xaxis.axis_label, plot.yaxis.axis_label = "time (ms)", scale.label
    plot.title.text = title
    return apply_theme(plot, theme)


def _stacked(above: figure, below: figure) -> LayoutDOM:
    above.min_height, below.min_height = 200, 110
    below.sizing_mode, below.height = "stretch_width", 150
    return column([above, below], sizing_mode="stretch_both")


def _landscape(result: Fit, i: int, theme: Theme) -> figure:
    """Draw χ² above its minimum over one parameter: every set that was evaluated, the profile, and the interval."""
    parameter, (values, misfits) = result.free[i], result.landscape
    axis = _axis(parameter)
    plot = empty_figure(name=f"landscape of {parameter.name}", min_border=4, y_axis_type="log",
                        x_axis_type="log" if parameter.low > 0.0 else "linear")
    rise = np.maximum(misfits - result.misfit, _SMALLEST_RISE)
    dots = plot.scatter(values[:, i] / axis.factor, rise, size=4, fill_alpha=0.5, line_color=None)
    themed(dots, fill_color="steel")
    if result.profiles:
        profile = result.profiles[i]
        line = plot.line(np.array(profile.values) / axis.factor, np.maximum(profile.rises, _SMALLEST_RISE))
        themed(line, line_color="accent", line_width=2.0)
        for end in (profile.low, profile.high):
            upright = Span(location=end / axis.factor, dimension="height", line_dash=[4, 4])
            plot.add_layout(themed(upright, line_color="accent", line_width=1.2))
        plot.add_layout(themed(Span(location=result.limit, dimension="width", line_dash=[2, 4]),
                               line_color="soft", line_width=1.2))
    plot.xaxis.axis_label = axis.label
    plot.yaxis.axis_label = "Δχ²"
    plot.title.text = _best(result, i)
    return apply_theme(plot, theme)


def _axis(parameter: Free) -> Scale:
    """Return the scale of a parameter; metres and newtons get a prefix."""
    unit = "" if parameter.unit == "1" else parameter.unit
    if unit not in ("m", "N"):
        return Scale(parameter.name, 1.0, unit)
    factor, letter = prefixed(parameter.high)
    return Scale(parameter.name, factor, letter + unit)


def _verdict(result: Fit) -> str:
    words = {"can": "the model can describe it", "cannot": "the model cannot describe it", "not known": "no verdict"}
    return f"χ² = {result.chi_squared:.4g}, {result.degrees_of_freedom} degrees of freedom: {words[result.verdict]}"


def _best(result: Fit, i: int) -> str:
    words = f"{result.free[i].name} = {result.best[i]:.4g} {result.free[i].unit}"
    if not result.profiles:
        return words
    interval: Sequence[float] = (result.profiles[i].low, result.profiles[i].high)
    return f"{words}, 95 %: {interval[0]:.4g} to {interval[1]:.4g}"
