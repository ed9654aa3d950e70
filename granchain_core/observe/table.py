"""Numbers in columns from a text file, read strictly.

A lenient reader misreads ``0,5;1,5e-6`` silently. Here the separator is found once,
every line has to fit, and a file has one decimal mark: where a point and a comma both occur in numbers, 1.100 may be
1.1 or 1100, and only its writer knows which.
"""

from __future__ import annotations

import csv
import dataclasses
import re
from dataclasses import dataclass

from ..errors import BadInput
from ..text import number_in

_LIKE_A_NUMBER = re.compile(r"[+-]?[.,]*\d[\d.,]*([eE][+-]?\d+)?\Z", re.ASCII)
#: What may be a number with its thousands marked.
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}\Z", re.ASCII)


@dataclass(frozen=True)
class Expected:
    """What a file holds: header words of every column in its usual order, which are needed, and how sentences say it.

    `naming` and `short` describe in messages how columns are named, `content` what a line holds, `widths` how many
    columns there may be. `units` are those of a column, the usual one first; a header word may end in another.
    """

    columns: dict[str, set[str]]
    needed: tuple[str, ...]
    naming: str
    short: str
    content: str
    widths: str
    most_bytes: int
    most_rows: int
    units: dict[str, tuple[str, ...]] = dataclasses.field(default_factory=dict)


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
    separator = _separator(*lines[0])
    split = [(number, _fields(number, line, separator)) for number, line in lines]
    names = _header_words(split[0][1])
    meanings = _header(names, expected) if names else []
    data = split[bool(names) :]
    comma = _decimal_comma(data, meanings or list(expected.columns), names, expected)
    rows = [_row(number, fields, comma) for number, fields in data]
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
    size = len(text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass"))
    if size > expected.most_bytes:
        raise BadInput(f"The file has {size} bytes; at most {expected.most_bytes} are read.")
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


def _separator(number: int, line: str) -> str:
    for candidate in (";", "\t", ","):
        if candidate in line:
            return candidate
    raise BadInput(f"Line {number}, {line[:40]!r}, has no column separator; use a comma, a semicolon or a tab.")


def _fields(number: int, line: str, separator: str) -> list[str]:
    """The fields of a line; a separator in quotes belongs to its field."""
    if '"' not in line:
        return [field.strip() for field in line.split(separator)]
    try:
        return [field.strip() for field in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]
    except csv.Error as problem:
        raise BadInput(f"Line {number}: {line[:30]!r} cannot be split into columns: {problem}.") from None


def _decimal_comma(data: list[tuple[int, list[str]]], meanings: list[str], names: list[str],
                   expected: Expected) -> bool:
    """Whether the file's decimal mark is a comma; raises `BadInput` where a number has two readings."""
    marked = [(number, place, field) for number, fields in data for place, field in enumerate(fields)
              if ("." in field or "," in field) and _LIKE_A_NUMBER.match(field)]
    point = next((found for found in marked if "." in found[2]), None)
    comma = next((found for found in marked if "," in found[2]), None)
    if point is None or comma is None:
        return comma is not None
    read = [(*found, _with_point(found[2]), _with_comma(found[2])) for found in marked]
    twofold = [one for one in read if one[3] is not None and one[4] is not None and one[3] != one[4]]
    if not twofold:  # as 5. and 0,0: the same number either way
        return True
    number, place, field, pointed, with_comma = next((one for one in twofold if _GROUPED.match(one[2])), twofold[0])
    other = comma if "." in field else point
    unit = _unit_of(place, meanings, names, expected)
    raise BadInput(
        f"Line {number}: {field[:30]!r} is {pointed:.10g}{unit} if the point is the decimal mark and "
        f"{with_comma:.10g}{unit} if the comma is, and this file has both ({other[2][:30]!r} in line {other[0]}); "
        "write every number with the same decimal mark and without a mark for thousands.")


def _with_point(field: str) -> float | None:
    """What a number means where the point marks decimals and the comma thousands."""
    return number_in(field.replace(",", ""))


def _with_comma(field: str) -> float | None:
    """What a number means where the comma marks decimals and the point thousands."""
    return number_in(field.replace(".", "").replace(",", "."))


def _unit_of(place: int, meanings: list[str], names: list[str], expected: Expected) -> str:
    """A column's unit after a number: the one its header word ends in, else its usual one."""
    known = expected.units.get(meanings[place], ()) if place < len(meanings) else ()
    last = names[place].rsplit("_", 1)[-1] if place < len(names) else ""
    return next((f" {unit}" for unit in known if unit.lower() == last), f" {known[0]}" if known else "")


def _header_words(fields: list[str]) -> list[str]:
    """The first line's words, small and joined by underscores, if it is a header; else none."""
    if any(_LIKE_A_NUMBER.match(field) for field in fields):
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
        value = number_in(field.replace(",", ".") if comma_decimals else field)
        if value is None:
            raise BadInput(f"Line {number}: {field[:30]!r} is not a number.")
        values.append(value)
    return number, values
