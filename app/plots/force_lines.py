"""The force and drive lines of a motion, the same for the page and for files: titles, colours, columns of data.

On the left are the input force, over the lower axis, and the drive, over the upper one. On the right are the output
force and its elastic part.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..frames import with_jumps
from .theme import Theme


@dataclass(frozen=True)
class LineStyle:
    """The style of a line: the titles of its axis, its role in a theme, its width [px] and dashes."""

    title: str
    short: str
    role: str
    width: float
    dash: tuple[int, ...] = ()

    @property
    def colour(self) -> str:
        """The line's colour, which is the same in every theme (not for the role `ink`)."""
        return str(getattr(Theme, self.role))

    def label(self, unit: str, compact: bool = False) -> str:
        """Return the title of the axis, shorter if `compact`."""
        return f"{self.short if compact else self.title} ({unit})"


DRIVE = LineStyle("drive u₀", "drive", "drive", 2.0)
INPUT = LineStyle("input force", "in", "input", 2.5)
ELASTIC = LineStyle("elastic output force", "elastic", "output", 2.0, (5, 4))
OUTPUT = LineStyle("output force", "out", "output", 2.5)
#: A measured force or displacement over the computed one.
MEASURED = LineStyle("measured", "measured", "ink", 1.4)


def columns(time: np.ndarray, **lines: tuple[np.ndarray, float]) -> dict[str, np.ndarray]:
    """Return the columns of lines with points at `time`; each line is given by its values and their unit."""
    scaled = {"time": time, **{name: values / unit for name, (values, unit) in lines.items()}}
    return {name: np.asarray(values, dtype=np.float32) for name, values in scaled.items()}


def force_columns(time: np.ndarray, force: np.ndarray, unit: float, jumps: np.ndarray,
                  scale: float = 1.0) -> dict[str, np.ndarray]:
    """Return a force whose `jumps` (J, 2) have points between the rows; `scale` converts their times to the axis."""
    at, values = with_jumps(time, force, jumps * np.array([scale, 1.0]))
    return columns(at, force=(values, unit))
