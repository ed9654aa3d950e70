"""Lyapunov exponents in order of size, with their standard errors; unresolved exponents are hollow."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Span
from bokeh.plotting import figure

from granchain_core import LyapunovSpectrum

from .theme import Theme
from .themed import apply_theme, empty_figure, themed


def lyapunov(result: LyapunovSpectrum, theme: Theme) -> figure:
    """Draw the exponents per drive period; above the line of zero, neighbouring trajectories separate."""
    rank = np.arange(1, len(result.exponents) + 1)  # numbered as by the command
    source = ColumnDataSource({"rank": rank, "exponent": result.exponents, "error": result.errors,
                               "low": result.exponents - result.errors, "high": result.exponents + result.errors,
                               "fill": np.where(rank <= result.resolved, 1.0, 0.0)}, name="exponents")
    plot = empty_figure(name="lyapunov", min_border=4)
    plot.add_layout(themed(Span(location=0.0, dimension="width"), line_color="soft", line_width=1.0))
    themed(plot.segment("rank", "low", "rank", "high", source=source), line_color="accent", line_width=1.4)
    dots = plot.scatter("rank", "exponent", source=source, size=8, fill_alpha="fill")
    themed(dots, fill_color="accent", line_color="accent")
    plot.add_tools(HoverTool(renderers=[dots], tooltips=[
        ("rank", "@rank"), ("exponent per drive period", "@exponent{0.0000} ± @error{0.0000}")]))
    plot.xaxis.axis_label, plot.yaxis.axis_label = "rank", "Lyapunov exponent per drive period"
    dimension = result.dimension_words()
    plot.title.text = f"Kaplan–Yorke dimension {dimension}; hollow: upper bounds"
    return apply_theme(plot, theme)
