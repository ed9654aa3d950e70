"""The force trains of pinned motions: grey lines behind the present ones, dashed differently."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bokeh.models import ColumnDataSource, Line, Plot

from granchain_core import Run

from ...frames import jumps_of, with_jumps
from ...plots.theme import GREY

#: Dashes of the pins, in their order.
DASHES = ([7, 3], [2, 3], [9, 3, 2, 3])
#: The same dashes as text.
SIGNS = ("╌", "┈", "─ ·")
#: Largest number of points of a line; a longer train ends before the picture does.
MOST_POINTS = 30_000
#: The data of a line that shows nothing.
NO_TRAIN = {"time": np.zeros(0, np.float32), "force": np.zeros(0, np.float32)}


@dataclass(frozen=True, eq=False)
class _Train:
    """One pinned motion: times and forces [s, N] at the driver and at the wall. It repeats or is shown once."""

    lasts: float
    repeats: bool
    lines: tuple[tuple[np.ndarray, np.ndarray], ...]

    @classmethod
    def of(cls, run: Run) -> _Train:
        """Return the trains of a run."""
        time = run.time - run.time[0]
        lines = tuple(with_jumps(time, force, jumps_of(run, contact))
                      for force, contact in ((run.input_force, 0), (run.output_force, run.scene.N)))
        return cls(float(time[-1]), run.regime.name == "periodic", lines)

    def over(self, copies: int, line: int) -> tuple[np.ndarray, np.ndarray]:
        """Return one of the lines, repeated `copies` times in a row."""
        time, force = self.lines[line]
        shifts = self.lasts * np.arange(copies)
        return (time[None, :] + shifts[:, None]).ravel(), np.tile(force, copies)


class PinnedTrains:
    """The lines in both figures. They are redrawn when the pins, the units or the time on the axis change.

    A line is made only when needed, since most visitors pin nothing.
    """

    def __init__(self, left: Plot, right: Plot) -> None:
        self._plots = left, right
        self._sources: dict[tuple[int, int], ColumnDataSource] = {}
        self._trains: list[_Train | None] = []
        self._drawn: tuple[object, ...] = ()
        self._last: tuple[float, float, float, float] = (0.0, 1.0, 1.0, 1.0)

    def _draw(self, line: int, pin: int, values: dict[str, np.ndarray]) -> None:
        """Draw the train of a pin: `line` is 0 at the driver, 1 at the wall."""
        source = self._sources.get((line, pin))
        if source is not None:
            source.data = values
        elif len(values["time"]):
            source = self._sources[line, pin] = ColumnDataSource(values)
            self._plots[line].add_glyph(source, Line(x="force", y="time", line_color=GREY, line_width=1.8,
                                                     line_dash=DASHES[pin]), level="underlay")

    @property
    def largest(self) -> tuple[float, float]:
        """The largest force at the driver and at the wall of all pinned motions [N]."""
        at = [[float(train.lines[line][1].max()) for train in self._trains if train] for line in (0, 1)]
        return max(at[0], default=0.0), max(at[1], default=0.0)

    def load(self, runs: Sequence[Run | None]) -> None:
        """Replace the pins, and draw them over the picture."""
        self._trains = [None if run is None else _Train.of(run) for run in runs]
        self._drawn = ()
        self.update(*self._last)

    def update(self, shown: float, scale: float, push: float, out: float) -> None:
        """Draw over `shown` seconds; `scale` is the axis divided by the time [1/s], `push` and `out` are units [N].

        `shown` is 0 for a live picture, over which no pins are drawn because its time axis moves.
        """
        scale = float(f"{scale:.9g}")  # the same for all pictures in one unit
        self._last = shown, scale, push, out
        copies = [_copies(train, shown) for train in self._trains]
        if self._drawn == (copies, scale, push, out):
            return
        self._drawn = (copies, scale, push, out)
        for line, unit in ((0, push), (1, out)):
            for pin in range(len(DASHES)):
                train = self._trains[pin] if pin < len(self._trains) else None
                if train is None or not copies[pin]:
                    self._draw(line, pin, dict(NO_TRAIN))
                    continue
                time, force = train.over(copies[pin], line)
                self._draw(line, pin, {"time": (time * scale).astype(np.float32),
                                         "force": (force / unit).astype(np.float32)})


def _copies(train: _Train | None, shown: float) -> int:
    """Return how often a motion is repeated to fill the picture: a power of two, so that it is rarely sent again."""
    if train is None or shown <= 0.0:
        return 0
    needed = 2 ** int(np.ceil(np.log2(max(shown / train.lasts, 1.0)))) if train.repeats else 1
    return max(1, min(needed, MOST_POINTS // len(train.lines[0][0])))
