"""A user's measured resonance curve from a simple CSV, read strictly.

A lenient reader takes ``0,5;1,5e-6`` for numbers of another meaning without a word. Here the separator is found once,
the decimal mark must be a point unless the separator is a semicolon or tab, and every line has to fit.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from ..errors import BadInput

#: Largest file and most rows accepted.
MOST_BYTES, MOST_ROWS = 2_000_000, 20_000
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\Z")
_HEADERS = {
    "frequency": {"frequency", "frequency_hz", "f", "f_hz", "freq", "freq_hz"},
    "force": {"force", "force_n", "max_force", "max_output_force", "f_out", "output_force"},
    "error": {"error", "error_n", "uncertainty", "sigma", "err"},
}


@dataclass(frozen=True, eq=False)
class Measured:
    """Measured points in ascending frequency [Hz]: force [N], error [N] or None; `understood` says what was read."""

    frequency: np.ndarray
    force: np.ndarray
    error: np.ndarray | None
    understood: str


def read_measured_csv(text: str | bytes) -> Measured:
    """Two or three columns: frequency in Hz, force in N, and optionally its error in N; a header line is optional.

    Raises `BadInput` naming the line.
    """
    lines = _lines(text)
    separator = _separator(lines[0][1])
    comma_decimals = separator in (";", "\t") and any("," in line for _, line in lines)
    header = _header(_fields(lines[0][1], separator))
    rows = [_row(number, _fields(line, separator), comma_decimals) for number, line in lines[header is not None :]]
    if not rows:
        raise BadInput("The file has a header but no data line; expected frequency in Hz and force in N.")
    width = len(header) if header else len(rows[0][1])
    for number, row in rows:
        if len(row) != width:
            raise BadInput(f"Line {number} has {len(row)} columns where {width} were expected.")
    order = header or ["frequency", "force", "error"][:width]
    if width not in (2, 3):
        raise BadInput(f"Line {rows[0][0]} has {width} columns; expected 2 (frequency in Hz, force in N) or 3 "
                       f"(and error in N).")
    return _checked(rows, order, separator, comma_decimals)


def _lines(text: str | bytes) -> list[tuple[int, str]]:
    """Numbered lines that are neither empty nor comments."""
    if len(text) > MOST_BYTES:
        raise BadInput(f"The file has {len(text)} bytes; at most {MOST_BYTES} are read.")
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise BadInput("The file is not UTF-8 text; save it as plain CSV.") from None
    found = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1)]
    found = [(i, line) for i, line in found if line and not line.startswith("#")]
    if not found:
        raise BadInput("The file is empty; expected lines of frequency in Hz and force in N.")
    if len(found) > MOST_ROWS:
        raise BadInput(f"The file has {len(found)} lines; at most {MOST_ROWS} are read.")
    return found


def _separator(line: str) -> str:
    for candidate in (";", "\t", ","):
        if candidate in line:
            return candidate
    raise BadInput(f"Line 1, {line[:40]!r}, has no column separator; use a comma, a semicolon or a tab.")


def _fields(line: str, separator: str) -> list[str]:
    return [field.strip().strip('"') for field in line.split(separator)]


def _header(fields: list[str]) -> list[str] | None:
    """The columns' meanings if the first line is a header, else None."""
    if any(_NUMBER.match(f.replace(",", ".")) for f in fields):
        return None
    meanings = []
    for field in fields:
        word = re.sub(r"[^a-z0-9]+", "_", field.lower()).strip("_")
        meaning = next((m for m, words in _HEADERS.items() if word in words), None)
        if meaning is None or meaning in meanings:
            raise BadInput(f"Line 1: column {field[:30]!r} is not understood; name the columns frequency_Hz, force_N "
                           f"and, if there is one, error_N.")
        meanings.append(meaning)
    for needed in ("frequency", "force"):
        if needed not in meanings:
            raise BadInput(f"Line 1: there is no {needed} column; name the columns frequency_Hz, force_N, error_N.")
    return meanings


def _row(number: int, fields: list[str], comma_decimals: bool) -> tuple[int, list[float]]:
    values = []
    for field in fields:
        plain = field.replace(",", ".") if comma_decimals else field
        if not _NUMBER.match(plain) or not math.isfinite(float(plain)):
            raise BadInput(f"Line {number}: {field[:30]!r} is not a number.")
        values.append(float(plain))
    return number, values


def _checked(rows: list[tuple[int, list[float]]], order: list[str], separator: str, comma: bool) -> Measured:
    """Columns in their meaning, checked for what a measurement can be."""
    at = {meaning: place for place, meaning in enumerate(order)}
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
    names = {";": "semicolon", "\t": "tab", ",": "comma"}
    understood = (f"{len(table)} points, {frequency[0]:g} to {frequency[-1]:g} Hz, force {force.min():g} to "
                  f"{force.max():g} N, {'with' if error is not None else 'no'} errors; columns separated by "
                  f"{names[separator]}, decimal {'comma' if comma else 'point'}")
    return Measured(frequency, force, error, understood)
