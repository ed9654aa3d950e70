"""The space-time map of kinetic energy: bead to the right, time downwards."""

from __future__ import annotations

import numpy as np
from bokeh.models import ColumnDataSource, HoverTool, Image, Plot, Range1d, SingleIntervalTicker

from ...format import prefixed
from ...frames import Frames
from ...plots.energies import bead_interval, energy_hover, energy_mapper
from ...serve.document.changes import set_properties
from ..figures.figure_style import GAP, bare_plot


class EnergyMap:
    """One image with one colour mapper; each new picture changes their contents."""

    def __init__(self, time: Range1d) -> None:
        self._source = ColumnDataSource({name: [] for name in ("image", "x", "y", "dw", "dh")})
        self._mapper = energy_mapper(1.0)
        self._beads, self._compact = 1, False
        self.figure = self._build(time)

    def _build(self, time: Range1d) -> Plot:
        plot = bare_plot((GAP, GAP), (12, 6), ("above", None), (), name="kinetic energy", y_range=time,
                          x_range=Range1d(0.5, 11.5))
        self._axis = plot.xaxis[0]
        self._axis.ticker = SingleIntervalTicker(interval=1, num_minor_ticks=0)
        image = plot.add_glyph(self._source, Image(image="image", x="x", y="y", dw="dw", dh="dh",
                                                   color_mapper=self._mapper))
        self._hover = HoverTool(renderers=[image], tooltips=energy_hover("", ""))
        plot.add_tools(self._hover)
        return plot

    def set_compact(self, compact: bool) -> None:
        """Number fewer beads if there is little room."""
        self._compact = compact
        set_properties(self._axis, axis_label="bead" if compact else "bead, numbered as above")
        set_properties(self._axis.ticker, interval=bead_interval(self._beads, 6 if compact else 12))

    def update(self, frames: Frames, time: np.ndarray, unit: str, high: float) -> None:
        """Show `frames`, whose rows are at `time` (in `unit`), in colours that end at `high` [J]."""
        factor, letter = prefixed(high)
        step = float(time[1] - time[0])
        set_properties(self._source, data={
            "image": [np.asarray(frames.kinetic_energy / factor, dtype=np.float32)],
            "x": [0.5],
            "y": [float(time[0]) - step / 2],
            "dw": [frames.beads],
            "dh": [step * frames.rows],
        })
        set_properties(self._mapper, high=high / factor)
        set_properties(self.figure.x_range, end=frames.beads + 0.5)
        self._beads = frames.beads
        self.set_compact(self._compact)
        set_properties(self._hover, tooltips=energy_hover(unit, f"{letter}J"))
