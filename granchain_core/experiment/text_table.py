"""Text tables: their lines before the header, titles, units and numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import BadInput
from .columns import NO_CONVENTION, Asked, Convention, chosen_columns, in_si
from .grid import LIKE_A_NUMBER, Row, TextGrid
from .measured import Measured, note_of
from .numerals import decimal_mark, number_as
from .question import Answers, Guess, Question, Unclear, first_rows
from .series import Series, Shaker
from .units import dimension_of, heading, unit_named

_SEPARATED = {";": "semicolons", "\t": "tabs", ",": "commas", "|": "bars", " ": "spaces"}


@dataclass(frozen=True)
class _Parts:
    """Parts of a grid: lines before the header, titles (empty without a header), units row, data rows."""

    preface: list[str]
    titles: list[str]
    units: list[str]
    data: list[Row]
    header_line: int


def _parted(grid: TextGrid) -> _Parts:
    rows = grid.rows
    width = _width(rows)
    begin = next((i for i, (_, fields) in enumerate(rows) if len(fields) == width and (
        _is_data(fields) or (i > 0 and _has_number(fields) and any(heading(one)[0] for one in rows[i - 1][1])))), None)
    if begin is None:
        numbers = next((i for i, (_, one) in enumerate(rows) if _has_number(one)), None)
        where = f"Line {rows[numbers][0]}" if numbers is not None else f"Line {rows[-1][0]}"
        raise BadInput(f"{where}: there are no two numbers side by side; expected frequency and force, or time and "
                       "a measured quantity.")
    head, data = rows[:begin], rows[begin:]
    units: list[str] = []
    titles: list[str] = []
    line = data[0][0]
    if head and _is_units(head[-1][1], width):
        units = _wide(head[-1][1], width)
        head = head[:-1]
    if head and (merged := _header(head[-1][1], width)):
        titles, line = merged, head[-1][0]
        head = head[:-1]
    elif head and len(head[-1][1]) > 1 and any(heading(one)[0] for one in head[-1][1]):
        raise BadInput(f"Line {head[-1][0]} has {len(head[-1][1])} titles over the {width} columns of line "
                       f"{data[0][0]}; separate columns by a mark that occurs in no number or title.")
    preface = [" ".join(one for one in fields if one) for _, fields in head]
    return _Parts(preface, titles, units, _trimmed(data, width), line)


def _width(rows: list[Row]) -> int:
    """Return the number of fields that most rows with two numbers have."""
    numeric = [len(fields) for _, fields in rows if _is_data(fields)]
    return max(set(numeric), key=numeric.count) if numeric else 0


def _is_data(fields: list[str]) -> bool:
    return sum(bool(LIKE_A_NUMBER.fullmatch(one)) for one in fields) >= 2


def _has_number(fields: list[str]) -> bool:
    """Return whether the fields may be a row of data in which one entry is not a number."""
    return any(LIKE_A_NUMBER.fullmatch(one) for one in fields)


def _is_units(fields: list[str], width: int) -> bool:
    """Return whether a row contains only units, in brackets or not, at least one of which is known."""
    bare = [one.strip("[]() ") for one in fields]
    known, filled = sum(unit_named(one) is not None for one in bare), sum(bool(one) for one in bare)
    return len(fields) == width and (known >= 2 or known == filled == 1)


def _header(fields: list[str], width: int) -> list[str]:
    """Return the titles of the columns, rejoining units that a space separated; empty if this is not a header."""
    if len(fields) != width:
        joined: list[str] = []
        for title in fields:
            if joined and title.startswith(("(", "[", "/")):
                joined[-1] += f" {title}"
            else:
                joined.append(title)
        fields = joined
    if len(fields) == width - 1 or (len(fields) == width + 1 and not fields[-1]):
        fields = [*fields, ""][:width]
    return list(fields) if len(fields) == width and any(re.search(r"[^\W\d_]", title) for title in fields) else []


def _wide(fields: list[str], width: int) -> list[str]:
    return [one.strip("[]() ") for one in (*fields, *[""] * width)][:width]


def _trimmed(data: list[Row], width: int) -> list[Row]:
    """Remove empty fields beyond the width at the ends of rows; refuse rows that are too short or too long."""
    rows = []
    for number, fields in data:
        while len(fields) > width and not fields[-1]:
            fields = fields[:-1]
        if len(fields) != width:
            raise BadInput(f"Line {number} has {len(fields)} columns where {width} were expected.")
        rows.append((number, fields))
    return rows


def read_text_table(grid: TextGrid, answers: Answers, wanted: Sequence[str], source: str,
                    convention: Convention = NO_CONVENTION) -> Series | Shaker | Measured:
    """Return the measurement in a grid."""
    parts = _parted(grid)
    width = len(parts.data[0][1])
    guesses = [_guess(i, parts) for i in range(width)]
    numeric = [i for i in range(width) if any(LIKE_A_NUMBER.fullmatch(fields[i]) for _, fields in parts.data)]
    while width and not parts.titles and guesses and not any(fields[width - 1] for _, fields in parts.data):
        width -= 1
        guesses.pop()  # a separator ends every line
    header = [(parts.header_line, parts.titles)] if parts.titles else []
    question = Asked(guesses, first_rows([*header, *parts.data]), bool(parts.titles))
    chosen = chosen_columns(question, answers, wanted, numeric, convention)
    used = sorted({place for places in chosen.values() for place, _ in places})
    fields = [(number, row[place]) for number, row in parts.data for place in used]
    if grid.separator == "," and not any("," in field for _, field in fields):
        decimal = answers.decimal or "point"  # a comma cannot separate both columns and decimals
    else:
        decimal = decimal_of(fields, answers, question.rows, guesses)
    values: dict[str, np.ndarray] = {}
    for quantity, places in chosen.items():
        values[quantity] = np.array([[number_of(number, row[place], decimal) for number, row in parts.data]
                                     for place, _ in places])
    layout = (f"columns separated by {_SEPARATED.get(grid.separator, repr(grid.separator))}, decimal {decimal}"
              + (f", {grid.encoding}" if grid.encoding != "UTF-8" else ""))
    left = [guess.title or str(guess.number) for i, guess in enumerate(guesses) if i not in used]
    layout += f"; left out: {', '.join(left)}" if left else ""
    note = note_of(" ".join((*parts.preface, *grid.comments))[:500], answers.note)
    measurement = in_si(values, chosen, question, [number for number, _ in parts.data], layout, wanted,
                        answers.source or source, note, bool(answers.columns))
    return replace(measurement, left_out=tuple(left)) if isinstance(measurement, Series) else measurement


def _guess(place: int, parts: _Parts) -> Guess:
    """Guess the quantity and unit of a column from its title and the units row."""
    title = parts.titles[place] if parts.titles else ""
    quantity, unit, _ = heading(title) if title else (None, None, "")
    below = parts.units[place] if parts.units else ""
    if below:
        unit = unit_named(below)
        quantity = heading(f"{title} ({below})")[0] if unit else quantity
        title = f"{title} ({below})"
    if quantity is None and unit is not None and dimension_of(unit) in ("frequency", "time"):
        quantity = dimension_of(unit)
    return Guess(place + 1, title, quantity, unit)


def decimal_of(fields: list[tuple[int, str]], answers: Answers, rows: Sequence[tuple[int, tuple[str, ...]]] = (),
               guesses: Sequence[Guess] = ()) -> str:
    """Return the decimal mark of fields with their lines, or the user's answer. Raises `Unclear` and `BadInput`."""
    if answers.decimal is not None:
        return answers.decimal
    decimal = decimal_mark(fields)
    if decimal is not None:
        return decimal
    line, field = next((line, one) for line, one in fields if number_as(one, "point") != number_as(one, "comma")
                       and ("," in one or "." in one))
    read = [number_as(field, mark) for mark in ("point", "comma")]
    raise Unclear(Question(
        f"Line {line}: {field[:30]!r} is {_shown(read[0])} with a decimal point and {_shown(read[1])} with a decimal "
        "comma.", ("decimal",), tuple(guesses), tuple(rows)))


def _shown(value: float | None) -> str:
    return "no number" if value is None else f"{value:.10g}"


def number_of(line: int, field: str, decimal: str) -> float:
    """Return the number in a field. Raises `BadInput` with its line."""
    value = number_as(field, decimal)
    if value is None:
        why = ("is empty where a number is expected" if not field else
               f"{field[:30]!r} is a formula; save values" if field.startswith(("=", "@")) else
               f"{field[:30]!r} is not a finite number" if LIKE_A_NUMBER.fullmatch(field) and "e" in field.lower() else
               f"{field[:30]!r} is not a number")
        raise BadInput(f"Line {line}: {'a column ' if not field else ''}{why}.")
    return value
