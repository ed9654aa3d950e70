"""A user's measured time series and shaker amplitudes from CSV files whose header names columns and units.

A series has time and any of shaker velocity, input force, output force; a shaker file has frequency and the amplitude
of velocity or displacement. Which of them a file is, or a resonance curve, its first column's name says.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import BadInput
from .measured import Measured, read_measured_csv
from .table import Expected, Table, read_table

#: Largest file accepted [bytes] and most rows of it.
MOST_BYTES, MOST_ROWS = 50_000_000, 1_000_000
#: Units in SI by the end of a header word.
_UNITS = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6},
    "frequency": {"hz": 1.0, "khz": 1e3},
    "velocity": {"m_s": 1.0, "mm_s": 1e-3, "um_s": 1e-6, "µm_s": 1e-6},
    "displacement": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6},
    "force": {"n": 1.0, "mn": 1e-3, "kn": 1e3},
}


def _words(quantity: str, *names: str) -> set[str]:
    return {f"{name}_{unit}" for name in names for unit in _UNITS[quantity]}


_FORCES = {"input_force": ("input_force", "f_in", "force_in"), "output_force": ("output_force", "f_out", "force_out")}
_QUANTITY = {"time": "time", "velocity": "velocity", "input_force": "force", "output_force": "force",
             "frequency": "frequency", "displacement": "displacement"}
_SERIES = Expected(
    columns={"time": _words("time", "time", "t"), "velocity": _words("velocity", "velocity", "shaker_velocity", "v"),
             **{meaning: _words("force", *names) for meaning, names in _FORCES.items()}},
    needed=("time",), naming="time_s, velocity_m_s, input_force_N and output_force_N, those that there are",
    short="time_s, velocity_m_s, input_force_N, output_force_N", content="time and what was measured at it",
    widths="2 to 4", most_bytes=MOST_BYTES, most_rows=MOST_ROWS)
_SHAKER = Expected(
    columns={"frequency": _words("frequency", "frequency", "freq", "f"),
             "velocity": _words("velocity", "velocity", "v0"),
             "displacement": _words("displacement", "displacement", "amplitude", "a0")},
    needed=("frequency",), naming="frequency_Hz and velocity_m_s or displacement_m",
    short="frequency_Hz, velocity_m_s", content="frequency in Hz and the amplitude of the shaker's velocity in m/s",
    widths="2", most_bytes=MOST_BYTES, most_rows=MOST_ROWS)


@dataclass(frozen=True, eq=False)
class Series:
    """A measured time series: time (T,) [s] from 0 and, where measured, velocity [m/s] and forces [N], else None."""

    time: np.ndarray
    velocity: np.ndarray | None
    input_force: np.ndarray | None
    output_force: np.ndarray | None
    understood: str


@dataclass(frozen=True, eq=False)
class Shaker:
    """The shaker's amplitude over frequency [Hz], ascending: velocity V0 [m/s]; displacement A0 = V0/(2πf) [m]."""

    frequency: np.ndarray
    velocity: np.ndarray
    understood: str

    @property
    def displacement(self) -> np.ndarray:
        """Amplitude of the displacement [m]."""
        return np.asarray(self.velocity / (2.0 * math.pi * self.frequency))


def read_experiment(path: str | Path) -> Series | Shaker | Measured:
    """The series, shaker amplitudes or resonance curve in a CSV file. Raises `BadInput` naming the line."""
    path = Path(path)
    try:
        with open(path, "rb") as file:
            content = file.read(MOST_BYTES + 1)
    except OSError as problem:
        raise BadInput(f"Cannot read {str(path)[:200]}: {problem.strerror or problem}.") from None
    try:
        found = _read(content)
    except BadInput as problem:
        raise BadInput(f"{path.name}: {problem}") from None
    return replace(found, understood=f"{path.name}: {found.understood}")


def _read(content: bytes) -> Series | Shaker | Measured:
    first = _first_line(content)
    if first.startswith(("time", "t_", "t ", "t(")):
        return _series(read_table(content, _SERIES))
    if any(word in first for word in ("veloc", "v0", "displac", "amplitude", "a0")):
        return _shaker(read_table(content, _SHAKER))
    if first.startswith(("f", "max")):
        return read_measured_csv(content)
    raise BadInput("Line 1 does not name its columns; begin with time_s (a series: velocity_m_s, input_force_N, "
                   "output_force_N) or with frequency_Hz (a curve: force_N; the shaker: velocity_m_s).")


def _first_line(content: bytes) -> str:
    """The first line that is neither empty nor a comment, in small letters."""
    for line in content[:10_000].decode("utf-8-sig", "replace").splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            return line.strip().strip('"').lower()
    return ""


def _columns(table: Table) -> dict[str, np.ndarray]:
    """Columns in SI by their meaning; every header word ends in its unit."""
    values = np.array([row for _, row in table.rows])
    found = {}
    for place, (meaning, word) in enumerate(zip(table.order, table.header, strict=True)):
        units = _UNITS[_QUANTITY[meaning]]
        unit = max((unit for unit in units if word.endswith(f"_{unit}")), key=len)
        found[meaning] = values[:, place] * units[unit]
    return found


def _series(table: Table) -> Series:
    at = _columns(table)
    if len(at) < 2:
        raise BadInput(f"Line 1: there is nothing but time; name the columns {_SERIES.short}.")
    steps = np.diff(at["time"])
    if len(steps) < 8 or (steps <= 0.0).any():
        number = table.rows[int(np.argmax(steps <= 0.0)) + 1][0] if len(steps) else table.rows[0][0]
        raise BadInput(f"Line {number}: times must ascend, and there must be at least 9 of them.")
    told = ", ".join(name.replace("_", " ") for name in at if name != "time")
    return Series(at["time"] - at["time"][0], at.get("velocity"), at.get("input_force"), at.get("output_force"),
                  f"{len(steps) + 1} samples over {at['time'][-1] - at['time'][0]:.4g} s of {told}; {table.layout}")


def _shaker(table: Table) -> Shaker:
    at = _columns(table)
    if len(at) != 2:
        raise BadInput(f"Line 1: name the columns {_SHAKER.naming}.")
    frequency = at["frequency"]
    bad = np.flatnonzero((frequency <= 0.0) | (at.get("velocity", at.get("displacement", frequency)) < 0.0))
    if len(bad):
        raise BadInput(f"Line {table.rows[int(bad[0])][0]}: a frequency must be above 0, an amplitude not negative.")
    velocity = at["velocity"] if "velocity" in at else 2.0 * math.pi * frequency * at["displacement"]
    order = np.argsort(frequency, kind="stable")
    return Shaker(frequency[order], velocity[order],
                  f"{len(order)} amplitudes of {'velocity' if 'velocity' in at else 'displacement'} from "
                  f"{frequency.min():g} to {frequency.max():g} Hz; {table.layout}")
