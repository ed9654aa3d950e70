"""Assembly of columns in SI units into a measured curve, shaker amplitudes or a time series, checked row by row."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import BadInput
from .measured import VIRTUAL, Measured
from .series import Series, Shaker

_MOVES = ("velocity", "displacement", "acceleration")
_IN_TIME = ("velocity", "displacement", "input_force", "output_force")
#: Minimum number of samples in a series.
_FEWEST = 8


@dataclass(frozen=True)
class Columns:
    """Values in SI units by quantity, each (columns, rows), with the line of every row and the file's own units."""

    values: dict[str, np.ndarray]
    lines: Sequence[int]
    units: dict[str, str]

    def has(self, *names: str) -> bool:
        """Return whether all of these quantities are present."""
        return all(name in self.values for name in names)

    def one(self, name: str) -> np.ndarray:
        """Return the only column of a quantity."""
        columns = self.values[name]
        if len(columns) != 1:
            raise BadInput(f"{len(columns)} columns hold the {name.replace('_', ' ')}; name one of them.")
        return np.asarray(columns[0])

    def check(self, wrong: np.ndarray, sentence: str, values: np.ndarray | None = None) -> None:
        """Raise `BadInput` for the first row in which `wrong` is true."""
        bad = np.flatnonzero(wrong)
        if len(bad):
            value = f" {values[bad[0]]:g}" if values is not None else ""
            raise BadInput(f"Line {self.lines[int(bad[0])]}: {sentence.format(value)}")


def kinds_of(quantities: Sequence[str]) -> list[str]:
    """Return the kinds of measurement that a file with these quantities can contain, the likeliest first."""
    present = set(quantities)
    kinds = []
    if "frequency" in present and "time" not in present:
        kinds += ["curve"] if present & {"force", "output_force"} else []
        kinds += ["shaker"] if present & set(_MOVES) else []
    if "time" in present and "frequency" not in present and present & set(_IN_TIME):
        kinds.append("series")
    return kinds


def assembled(columns: Columns, kind: str, layout: str, source: str, note: str) -> Measured | Series | Shaker:
    """Return the measurement of the given kind. Raises `BadInput` with the line number."""
    about = {"source": source, "note": note, "units": columns.units}
    named = ", ".join(f"{name.replace('_', ' ')} in {unit}" for name, unit in columns.units.items())
    layout = f"{named}; {layout}"
    made: dict[str, Callable[..., Measured | Series | Shaker]] = {"curve": _curve, "shaker": _shaker, "series": _series}
    measurement = made[kind](columns, layout, about)
    if not measurement.virtual:
        return measurement
    return replace(measurement, understood=f"{VIRTUAL}, nothing measured: {measurement.understood}")


def _curve(at: Columns, layout: str, about: dict[str, Any]) -> Measured:
    name = "force" if at.has("force") else "output_force"
    frequency, forces = at.one("frequency"), at.values[name]
    at.check(frequency <= 0.0, "frequency{} Hz must be above 0.", frequency)
    for force in forces:
        at.check(force < 0.0, "force{} N must not be negative; give its maximum.", force)
    error = at.one("error") if at.has("error") else None
    if error is not None:
        at.check(error < 0.0, "error{} N must not be negative.", error)
    points, of = np.unique(frequency, return_inverse=True)
    count = np.bincount(of) * len(forces)
    mean = sum(np.bincount(of, force) for force in forces) / count
    low, high = np.full(len(points), np.inf), np.full(len(points), -np.inf)
    for force in forces:
        np.minimum.at(low, of, force)
        np.maximum.at(high, of, force)
    spread = sum(np.bincount(of, (force - mean[of]) ** 2) for force in forces)
    both = None if error is None else np.sqrt(np.bincount(of, error**2)) / np.bincount(of)
    repeated = f", means of up to {count.max()} repeats with their extremes" if count.max() > 1 else ""
    understood = (f"{len(points)} points, {points[0]:g} to {points[-1]:g} Hz, force {mean.min():g} to {mean.max():g} N"
                  f"{repeated}, {'with' if both is not None else 'no'} errors; {layout}")
    return Measured(points, force=mean, error=both, understood=understood, low=low, high=high, repeats=count,
                    scatter=np.sqrt(spread / np.maximum(count - 1, 1)), **about)


def _shaker(at: Columns, layout: str, about: dict[str, Any]) -> Shaker:
    frequency = at.one("frequency")
    name = next(one for one in _MOVES if at.has(one))
    size, rate = at.one(name), 2.0 * math.pi * frequency
    at.check((frequency <= 0.0) | (size < 0.0), "a frequency must be above 0, an amplitude not negative.")
    velocity = {"velocity": size, "displacement": size * rate, "acceleration": size / rate}[name]
    points, of = np.unique(frequency, return_inverse=True)
    mean = np.bincount(of, velocity) / np.bincount(of)
    repeated = ", means of repeats" if len(points) < len(frequency) else ""
    return Shaker(points, mean, f"{len(points)} amplitudes of {name} from {points[0]:g} to {points[-1]:g} Hz"
                                f"{repeated}; {layout}", **about)


def _series(at: Columns, layout: str, about: dict[str, Any]) -> Series:
    time = at.one("time")
    if len(time) < _FEWEST:
        raise BadInput(f"Line {at.lines[-1]}: a series has at least {_FEWEST} samples; this one ends after "
                       f"{len(time)}.")
    at.check(np.diff(time, prepend=-np.inf) <= 0.0, "time{} s does not come after that of the line before; times must "
             "ascend.", time)
    quantities = ", ".join(name.replace("_", " ") for name in at.values if name != "time")
    velocity, input_force, output_force = (at.one(name) if at.has(name) else None
                                           for name in ("velocity", "input_force", "output_force"))
    return Series(time - time[0], velocity, input_force, output_force,
                  f"{len(time)} samples over {time[-1] - time[0]:.4g} s of {quantities}; {layout}",
                  at.one("displacement") if at.has("displacement") else None, **about, lines=at.lines,
                  began=float(time[0]))
