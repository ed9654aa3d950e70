"""A user's measured resonance curve from a simple CSV, read strictly.

The lines are read by table.py; this file defines the columns and the limits of a measurement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from .table import Expected, Table, read_table

#: Largest file accepted [bytes].
MOST_BYTES = 2_000_000
#: Most rows accepted.
MOST_ROWS = 20_000
_EXPECTED = Expected(
    columns={
        "frequency": {"frequency", "frequency_hz", "f", "f_hz", "freq", "freq_hz"},
        "force": {"force", "force_n", "max_force", "max_output_force", "f_out", "output_force"},
        "error": {"error", "error_n", "uncertainty", "sigma", "err"},
    },
    needed=("frequency", "force"), naming="frequency_Hz, force_N and, if there is one, error_N",
    short="frequency_Hz, force_N, error_N", content="frequency in Hz and force in N",
    widths="2 (frequency in Hz, force in N) or 3 (and error in N)", most_bytes=MOST_BYTES, most_rows=MOST_ROWS,
    units={"frequency": ("Hz",), "force": ("N",), "error": ("N",)},
)


@dataclass(frozen=True, eq=False)
class Measured:
    """Measured points in ascending frequency [Hz]: force [N], error [N] or None; `understood` describes the file."""

    frequency: np.ndarray
    force: np.ndarray
    error: np.ndarray | None
    understood: str


def read_measured_csv(text: str | bytes) -> Measured:
    """Two or three columns: frequency in Hz, force in N, and optionally its error in N; a header line is optional.

    Raises `BadInput` naming the line.
    """
    return _checked(read_table(text, _EXPECTED))


def _checked(found: Table) -> Measured:
    """Columns by their meaning, checked against the limits of a measurement."""
    rows, at = found.rows, {meaning: place for place, meaning in enumerate(found.order)}
    for number, row in rows:
        if row[at["frequency"]] <= 0.0:
            raise BadInput(f"Line {number}: frequency {row[at['frequency']]:g} Hz must be above 0.")
        if row[at["force"]] < 0.0:
            raise BadInput(f"Line {number}: force {row[at['force']]:g} N must not be negative; give its maximum.")
        if "error" in at and row[at["error"]] < 0.0:
            raise BadInput(f"Line {number}: error {row[at['error']]:g} N must not be negative.")
    table = np.array(sorted(row for _, row in rows))
    table = table[np.argsort(table[:, at["frequency"]], kind="stable")]
    frequency, force = table[:, at["frequency"]], table[:, at["force"]]
    error = table[:, at["error"]] if "error" in at else None
    understood = (f"{len(table)} points, {frequency[0]:g} to {frequency[-1]:g} Hz, force {force.min():g} to "
                  f"{force.max():g} N, {'with' if error is not None else 'no'} errors; {found.layout}")
    return Measured(frequency, force, error, understood)
