"""The steady states of one setting: largest output force over the share of random states that lead to each."""

from __future__ import annotations

from collections.abc import Sequence

from bokeh.models import ColumnDataSource, HoverTool, Range1d
from bokeh.plotting import figure

from granchain_core import Attractor

from ..format import figures_of, in_words
from .axes import force_scale
from .regimes import REGIME_MARKS, regime_key
from .theme import Theme
from .themed import apply_theme, empty_figure, themed


def attractors(results: Sequence[Attractor], theme: Theme) -> figure:
    """Draw a mark for each attractor, according to its regime, with a bar for the 95 % interval of its share.

    Without random states, the marks are at their fraction of all starts.
    """
    drawn = any(attractor.share is not None for attractor in results)
    starts = "random states" if drawn else "starts"
    count = sum(len(attractor.origins) for attractor in results)
    largest = max(attractor.max_output_force for attractor in results)
    scale = force_scale("largest output force", largest)
    plot = empty_figure(name="attractors", min_border=4, x_range=Range1d(-4, 104),
                        y_range=Range1d(0.0, 1.15 * largest / scale.factor))
    for attractor in results:
        key = regime_key(attractor.regime.name, attractor.regime.period)
        marker, colour, size = REGIME_MARKS[key]
        share = 100.0 * (len(attractor.origins) / count if attractor.share is None else attractor.share)
        low, high = (100.0 * end for end in attractor.share_interval) if attractor.share_interval else (share, share)
        words = attractor.share_words if drawn else f"{share:.0f} %"
        source = ColumnDataSource({
            "share": [share], "low": [low], "high": [high],
            "force": [attractor.max_output_force / scale.factor], "motion": [attractor.regime.sentence],
            "value": [in_words(attractor.max_output_force, "N", figures_of(attractor.force_errors.output))],
            "starts": [", ".join(origin.name for origin in attractor.origins[:4])]}, name=key)
        themed(plot.segment("low", "force", "high", "force", source=source), line_color="soft", line_width=1.2)
        marks = plot.scatter("share", "force", source=source, marker=marker, size=size + 5, fill_color=colour,
                             line_color=colour, line_width=1.5, legend_label=key)
        plot.add_tools(HoverTool(renderers=[marks], tooltips=[
            ("motion", "@motion"), ("largest output force", "@value"),
            (starts if drawn else "of all starts", words), ("starts", "@starts")]))
    plot.xaxis.axis_label, plot.yaxis.axis_label = f"{starts} that lead there (%)", scale.label
    for legend in plot.legend:
        legend.update(orientation="horizontal", padding=0, margin=2)
    plot.add_layout(plot.legend[0], "below")
    return apply_theme(plot, theme)
