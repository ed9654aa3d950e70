"""The drive amplitude as a function of the frequency: a formula or a measured table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import BadInput
from ..inputs.checks import unknown_name

#: Formulas: the quantity that stays constant, its unit, and its ratio to A0 as a power of 2πf.
FORMULAS = {"constant-displacement": ("m", 0), "constant-velocity": ("m/s", 1), "constant-acceleration": ("m/s²", 2)}


@dataclass(frozen=True)
class Amplitude:
    """The drive amplitude A0 over the frequency.

    Attributes
    ----------
    formula : str
        "constant-displacement", "constant-velocity", "constant-acceleration" or "table".
    values : tuple of float
        The constant [m, m/s or m/s²], or the table's amplitudes [m].
    frequencies : tuple of float
        The table's frequencies [Hz], ascending; empty for a formula.
    source : str
        Source of a table.

    Examples
    --------
    >>> from granchain_core import Amplitude
    >>> round(Amplitude("constant-velocity", (3e-3,)).at(60.0) * 1e6, 3)
    7.958
    >>> Amplitude.table([50.0, 100.0], [8e-6, 6e-6]).at(75.0)
    7e-06
    """

    formula: str
    values: tuple[float, ...]
    frequencies: tuple[float, ...] = ()
    source: str = ""

    def __post_init__(self) -> None:
        if self.formula != "table" and self.formula not in FORMULAS:
            raise unknown_name("drive", self.formula, (*FORMULAS, "table"))
        if self.formula == "table" and not (
                len(self.values) == len(self.frequencies) > 0 and all(np.diff(self.frequencies) > 0)):
            raise BadInput("A table of drive amplitudes has as many amplitudes as frequencies, which ascend.")
        if self.formula != "table" and (len(self.values) != 1 or self.frequencies):
            raise BadInput(f"A drive of {self.formula.replace('-', ' ')} has one value.")
        if wrong := [value for value in self.values if not (math.isfinite(value) and value > 0.0)]:
            unit = FORMULAS.get(self.formula, ("m", 0))[0]
            raise BadInput(f"The drive amplitude ({self.formula.replace('-', ' ')}) is {wrong[0]:g} {unit}; it must be "
                           "a number above 0, and any such number is valid.")

    @classmethod
    def table(cls, frequencies: Sequence[float] | np.ndarray, amplitudes: Sequence[float] | np.ndarray,
              source: str = "") -> Amplitude:
        """Return a table of amplitudes [m] at ascending frequencies [Hz], interpolated linearly."""
        return cls("table", tuple(map(float, amplitudes)), tuple(map(float, frequencies)), source)

    def at(self, f: float) -> float:
        """Return A0 [m] at a frequency [Hz]. Raises `BadInput` outside a table, where it was not measured."""
        if self.formula in FORMULAS:
            return float(self.values[0] / (2.0 * math.pi * f) ** FORMULAS[self.formula][1])
        low, high = self.frequencies[0], self.frequencies[-1]
        if not low * (1.0 - 1e-9) <= f <= high * (1.0 + 1e-9):
            raise BadInput(f"The drive amplitude is given from {low:g} to {high:g} Hz, not at {f:g} Hz; the nearest "
                           f"valid value is {min(max(f, low), high):g}.")
        return float(np.interp(f, self.frequencies, self.values))

    def held(self, f: float) -> float:
        """Like `at`, but constant beyond a table's ends, for steps past the end of a range."""
        return self.at(min(max(f, self.frequencies[0]), self.frequencies[-1]) if self.frequencies else f)

    def check_knobs(self, *knobs: str) -> None:
        """Raise `BadInput` unless f is among the knobs that vary and A0 is not."""
        if "f" not in knobs:
            raise BadInput("A drive amplitude over the frequency needs a frequency that varies: make f a knob.")
        if "A0" in knobs:
            raise BadInput("The drive amplitude follows the frequency, so A0 cannot vary independently; leave one out.")

    @property
    def words(self) -> str:
        """Description of the drive."""
        if self.formula == "table":
            return (f"A0 from {min(self.values) * 1e6:.4g} to {max(self.values) * 1e6:.4g} µm over {len(self.values)} "
                    f"frequencies{f' of {self.source}' if self.source else ''}")
        return f"{self.formula.replace('-', ' ')} {self.values[0]:g} {FORMULAS[self.formula][0]}"

    def to_json(self) -> dict[str, Any]:
        """Return plain data from which the amplitude can be rebuilt."""
        return {"formula": self.formula, "values": list(self.values), "frequencies": list(self.frequencies),
                "source": self.source}

    @classmethod
    def from_json(cls, data: Any) -> Amplitude:
        """Return the amplitude that `to_json` wrote. Raises `BadInput` for anything else."""
        if not isinstance(data, dict) or set(data) != {"formula", "values", "frequencies", "source"}:
            raise BadInput("A drive amplitude has formula, values, frequencies and source.")
        rows = [data["values"], data["frequencies"]]
        listed = all(isinstance(row, list) for row in rows)
        numbers = listed and all(isinstance(value, (int, float)) and not isinstance(value, bool)
                                 for row in rows for value in row)
        if not isinstance(data["formula"], str) or not isinstance(data["source"], str) or not numbers:
            raise BadInput("A drive amplitude has a formula, numbers, and a source in words.")
        return cls(data["formula"], tuple(map(float, rows[0])), tuple(map(float, rows[1])), data["source"])
