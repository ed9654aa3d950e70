"""A measured series over the force trains and the drive: thin lines in a separate colour."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from bokeh.models import ColumnDataSource, GlyphRenderer, Line, Plot

from ...plots.force_lines import MEASURED
from ...plots.themed import themed
from .pinned_trains import MOST_POINTS, NO_TRAIN

if TYPE_CHECKING:
    from granchain_core.fitting.overlay import Overlay

#: The forces in the order of the figures, and the index of the shaker's displacement after them.
_FORCES = ("input_force", "output_force")
_DRIVE = 2


def thinned(values: np.ndarray, most: int) -> np.ndarray:
    """Return the indices of at most `most` values, in order: the smallest and largest of each of equal parts."""
    if len(values) <= most:
        return np.arange(len(values))
    size = -(-len(values) // (most // 2))
    count = -(-len(values) // size)
    parts = np.pad(values, (0, count * size - len(values)), "edge").reshape(count, size)
    places = size * np.arange(count) + np.stack([parts.argmin(axis=1), parts.argmax(axis=1)])
    return np.unique(np.minimum(places, len(values) - 1))


class MeasuredTrains:
    """The lines in both figures, made when the first series is shown."""

    def __init__(self, left: Plot, right: Plot) -> None:
        self._plots = left, right
        self._lines: dict[int, GlyphRenderer] = {}
        self._shown: Overlay | None = None
        self._last: tuple[float, ...] = (0.0, 1.0, 1.0, 1.0, 1.0)

    @property
    def largest(self) -> tuple[float, float]:
        """The largest measured force at the driver and at the wall [N]."""
        forces = {} if self._shown is None else self._shown.forces
        at = [float(forces[name].max()) if name in forces else 0.0 for name in _FORCES]
        return at[0], at[1]

    @property
    def largest_displacement(self) -> float:
        """The largest measured displacement of the shaker from its mean [m]."""
        swing = None if self._shown is None else self._shown.displacement
        return 0.0 if swing is None else float(np.abs(swing).max())

    def load(self, shown: Overlay | None) -> None:
        """Replace the series (None removes it), and draw it over the picture."""
        self._shown = shown
        self.update(*self._last)

    def update(self, shown: float, scale: float, push: float, out: float, drive: float) -> None:
        """Draw over `shown` seconds; `scale` is the axis divided by the time [1/s].

        `push` and `out` [N] are the units of the forces, `drive` [m] that of the displacement.
        """
        self._last = shown, scale, push, out, drive
        inside = np.zeros(0, dtype=np.int64)
        if self._shown is not None and shown > 0.0:
            inside = np.flatnonzero((self._shown.time >= 0.0) & (self._shown.time <= shown))
        for series, unit in ((0, push), (1, out), (_DRIVE, drive)):
            measured = self._measured(series)
            values = NO_TRAIN
            if self._shown is not None and measured is not None:
                drawn = inside[thinned(measured[inside], MOST_POINTS)]
                values = {"time": (self._shown.time[drawn] * scale).astype(np.float32),
                          "force": (measured[drawn] / unit).astype(np.float32)}
            self._draw(series, values)

    def _measured(self, series: int) -> np.ndarray | None:
        if self._shown is None:
            return None
        return self._shown.displacement if series == _DRIVE else self._shown.forces.get(_FORCES[series])

    def _draw(self, series: int, values: dict[str, np.ndarray]) -> None:
        line = self._lines.get(series)
        if line is None:
            if len(values["time"]):
                glyph = Line(x="force", y="time", line_width=MEASURED.width)
                where = {"x_range_name": "drive"} if series == _DRIVE else {}
                plot = self._plots[series % _DRIVE]  # the drive is on the left, over the input force
                line = plot.add_glyph(ColumnDataSource(values), glyph, level="overlay", **where)
                self._lines[series] = themed(line, plot, line_color=MEASURED.role)
        elif len(values["time"]) or len(line.data_source.data["time"]):
            line.data_source.data = dict(values)
