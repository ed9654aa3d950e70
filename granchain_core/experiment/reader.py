"""The reader of measured tables, which asks about ambiguous columns, units and numbers, and gives the line of an error.

`FORMATS` in formats.py lists the formats that it knows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ..errors import BadInput
from .columns import NO_CONVENTION, Convention
from .formats import Reading, format_of
from .measured import MOST_BYTES, MOST_ROWS, Measured
from .question import Answers, Unclear
from .series import Series, Shaker

#: Kinds of files: a resonance curve, the shaker's amplitudes over frequency, a time series.
TABLE_KINDS = ("curve", "shaker", "series")


def read_experiment(path: str | Path, answers: Answers | None = None,
                    wanted: Sequence[str] = TABLE_KINDS) -> Series | Shaker | Measured:
    """Return the series, shaker amplitudes or resonance curve in a file.

    Raises `Unclear` if the user has to be asked, and `BadInput` with the line number.
    """
    path = Path(path)
    content = content_of(path)
    try:
        measurement = format_of(content).read(content, Reading(answers or Answers(), wanted, path.name, path=path))
    except Unclear as unclear:
        raise Unclear(replace(unclear.question, reason=f"{path.name}: {unclear.question.reason}")) from None
    except BadInput as problem:
        raise BadInput(f"{path.name}: {problem}") from None
    return replace(measurement, understood=f"{path.name}: {measurement.understood}")


def read_data(content: bytes, answers: Answers | None = None, wanted: Sequence[str] = TABLE_KINDS,
              source: str = "", most_bytes: int = MOST_BYTES, most_rows: int = MOST_ROWS,
              convention: Convention = NO_CONVENTION) -> Series | Shaker | Measured:
    """Return the measurement in the bytes of a file; `wanted` lists the kinds of measurement that the caller can use.

    `most_rows` applies to every format, `convention` only to text tables. Raises `Unclear` if the user has to be asked,
    and `BadInput` with the line number.
    """
    reading = Reading(answers or Answers(), wanted, source, most_bytes, most_rows, convention)
    return format_of(content).read(content, reading)


def content_of(path: Path) -> bytes:
    """Return the first bytes of a file, one more than is allowed. Raises `BadInput` if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return file.read(MOST_BYTES + 1)
    except OSError as problem:
        raise BadInput(f"Cannot read {str(path)[:200]}: {problem.strerror or problem}.") from None
