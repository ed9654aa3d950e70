"""Numbers in columns from a text file, read strictly.

A lenient reader takes ``0,5;1,5e-6`` for numbers of another meaning without a word. Here the separator is found once,
the decimal mark must be a point unless the separator is a semicolon or tab, and every line has to fit.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ..errors import BadInput

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\Z")


@dataclass(frozen=True)
class Expected:
    """What a file holds: header words of every column in its usual order, which are needed, and how sentences say it.

    `naming` and `short` are how columns are to be named, `content` what a line holds, `widths` how many columns there
    may be.
    """

    columns: dict[str, set[str]]
    needed: tuple[str, ...]
    naming: str
    short: str
    content: str
    widths: str
    most_bytes: int
    most_rows: int


@dataclass(frozen=True)
class Table:
    """Rows as (line number, values), the columns' meanings and header words (empty without a header), the layout."""

    rows: list[tuple[int, list[float]]]
    order: list[str]
    header: list[str]
    layout: str


def read_table(text: str | bytes, expected: Expected) -> Table:
    """All rows of `text`; a header line is optional. Raises `BadInput` naming the line."""
    lines = _lines(text, expected)
    separator = _separator(lines[0][1])
    comma = separator in (";", "\t") and any("," in line for _, line in lines)
    names = _header_words(_fields(lines[0][1], separator))
    meanings = _header(names, expected) if names else []
    rows = [_row(number, _fields(line, separator), comma) for number, line in lines[bool(names) :]]
    if not rows:
        raise BadInput(f"The file has a header but no data line; expected {expected.content}.")
    width = len(meanings) if meanings else len(rows[0][1])
    for number, row in rows:
        if len(row) != width:
            raise BadInput(f"Line {number} has {len(row)} columns where {width} were expected.")
    if not len(expected.needed) <= width <= len(expected.columns):
        raise BadInput(f"Line {rows[0][0]} has {width} columns; expected {expected.widths}.")
    mark = {";": "semicolon", "\t": "tab", ",": "comma"}[separator]
    return Table(rows, meanings or list(expected.columns)[:width], names,
                 f"columns separated by {mark}, decimal {'comma' if comma else 'point'}")


def _lines(text: str | bytes, expected: Expected) -> list[tuple[int, str]]:
    """Numbered lines that are neither empty nor comments."""
    if len(text) > expected.most_bytes:
        raise BadInput(f"The file has {len(text)} bytes; at most {expected.most_bytes} are read.")
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise BadInput("The file is not UTF-8 text; save it as plain CSV.") from None
    found = [(i, line.strip()) for i, line in enumerate(text.splitlines(), 1)]
    found = [(i, line) for i, line in found if line and not line.startswith("#")]
    if not found:
        raise BadInput(f"The file is empty; expected lines of {expected.content}.")
    if len(found) > expected.most_rows:
        raise BadInput(f"The file has {len(found)} lines; at most {expected.most_rows} are read.")
    return found


def _separator(line: str) -> str:
    for candidate in (";", "\t", ","):
        if candidate in line:
            return candidate
    raise BadInput(f"Line 1, {line[:40]!r}, has no column separator; use a comma, a semicolon or a tab.")


def _fields(line: str, separator: str) -> list[str]:
    return [field.strip().strip('"') for field in line.split(separator)]


def _header_words(fields: list[str]) -> list[str]:
    """The first line's words, small and joined by underscores, if it is a header; else none."""
    if any(_NUMBER.match(f.replace(",", ".")) for f in fields):
        return []
    return [re.sub(r"[^a-z0-9µ]+", "_", field.lower()).strip("_") or field[:30] for field in fields]


def _header(names: list[str], expected: Expected) -> list[str]:
    """The columns' meanings."""
    meanings: list[str] = []
    for name in names:
        meaning = next((m for m, words in expected.columns.items() if name in words), None)
        if meaning is None or meaning in meanings:
            raise BadInput(f"Line 1: column {name[:30]!r} is not understood; name the columns {expected.naming}.")
        meanings.append(meaning)
    for needed in expected.needed:
        if needed not in meanings:
            raise BadInput(f"Line 1: there is no {needed} column; name the columns {expected.short}.")
    return meanings


def _row(number: int, fields: list[str], comma_decimals: bool) -> tuple[int, list[float]]:
    values = []
    for field in fields:
        plain = field.replace(",", ".") if comma_decimals else field
        if not _NUMBER.match(plain) or not math.isfinite(float(plain)):
            raise BadInput(f"Line {number}: {field[:30]!r} is not a number.")
        values.append(float(plain))
    return number, values
