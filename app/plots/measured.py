"""Measured points over a computed curve: hollow, thin and in front, with error bars; and residuals below."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Span
from bokeh.plotting import figure

from granchain_core.experiment import Measured

from ..format import given_in_words, signed_in_words
from .axes import knob_scale
from .themed import empty_figure, themed

COLUMNS = ("frequency", "force", "low", "high", "value", "repeats", "residual", "word")
TOOLTIPS = [("", "@word"), ("frequency", "@frequency{0.0} Hz"), ("force", "@value"), ("repeats", "@repeats"),
            ("model − measured", "@residual")]


def measured_columns(measured: Measured, factor: float, residuals: np.ndarray | None = None,
                     sigma: np.ndarray | None = None) -> dict[str, list[Any]]:
    """Return columns for points, bars and tooltips; bars are stated errors, the repeats' extremes, or `sigma` [N].

    `residuals` are model − measured [N], NaN where there is no model.
    """
    low, high = measured.bars
    if sigma is not None and measured.error is None and measured.force.size and np.all(low == high):
        low, high = measured.force - sigma, measured.force + sigma
    count = np.ones(len(measured.force), dtype=int) if measured.repeats is None else measured.repeats
    gap = np.full(len(measured.force), np.nan) if residuals is None else residuals
    return {"frequency": measured.frequency.tolist(), "force": (measured.force / factor).tolist(),
            "low": (low / factor).tolist(), "high": (high / factor).tolist(),
            "word": [measured.word] * len(low),
            "value": [given_in_words(float(force), "N", 5) for force in measured.force], "repeats": count.tolist(),
            "residual": ["no model here" if not np.isfinite(difference) else
                         signed_in_words(float(difference), "N") for difference in gap]}


def measured_over(plot: figure, measured: Measured, factor: float, sigma: np.ndarray | None = None) -> None:
    """Draw a measurement in front of everything else."""
    source = ColumnDataSource(name="measured", data=measured_columns(measured, factor, None, sigma))
    themed(plot.segment("frequency", "low", "frequency", "high", source=source, level="overlay"), line_color="ink",
           line_width=1.0)
    dots = plot.scatter("frequency", "force", source=source, marker="square", size=7, fill_color=None, level="overlay",
                        legend_label=measured.word)
    themed(dots, line_color="ink", line_width=1.0)
    plot.add_tools(HoverTool(renderers=[dots], tooltips=TOOLTIPS[:4]))


def residuals_over(frequencies: np.ndarray, residuals: np.ndarray, unit: str) -> figure:
    """Draw residuals over the frequency, with a line at zero."""
    plot = empty_figure(name="residuals", min_border=4)
    plot.add_layout(themed(Span(location=0, dimension="width"), line_color="soft", line_width=1.0))
    source = ColumnDataSource(name="residuals", data={"frequency": frequencies, "residual": residuals})
    themed(plot.segment("frequency", 0, "frequency", "residual", source=source), line_color="ink", line_width=1.0)
    themed(plot.scatter("frequency", "residual", source=source, marker="square", size=6, fill_color=None),
           line_color="ink")
    plot.xaxis.axis_label, plot.yaxis.axis_label = knob_scale("f").label, unit
    return plot
