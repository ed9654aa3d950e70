"""A measured time series, and measured shaker amplitudes, as data classes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from .measured import Noted


@dataclass(frozen=True, eq=False)
class Series(Noted):
    """A measured time series: time (T,) [s] from 0, velocity [m/s] and forces [N]; None for those not measured.

    `displacement` is the shaker's [m]. `units` are those of the file by quantity, and `began` is the time of the first
    sample in the file [s]. For text files, `lines` (T,) has the line number of every sample, and `left_out` the titles
    of columns that were not read.
    """

    time: np.ndarray
    velocity: np.ndarray | None
    input_force: np.ndarray | None
    output_force: np.ndarray | None
    understood: str
    displacement: np.ndarray | None = None
    source: str = ""
    note: str = ""
    units: dict[str, str] = field(default_factory=dict)
    lines: Sequence[int] = ()
    began: float = 0.0
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Shaker(Noted):
    """The shaker's amplitude over frequency [Hz], ascending: velocity V0 [m/s]; displacement A0 = V0/(2πf) [m]."""

    frequency: np.ndarray
    velocity: np.ndarray
    understood: str
    source: str = ""
    note: str = ""
    units: dict[str, str] = field(default_factory=dict)

    @property
    def displacement(self) -> np.ndarray:
        """Amplitude of the displacement [m]."""
        return np.asarray(self.velocity / (2.0 * math.pi * self.frequency))
