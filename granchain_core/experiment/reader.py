"""The reader of measured tables: it asks about ambiguous columns, units and numbers, and names the line of an error.

CSV and what spreadsheets make of it, projects and tables of WebPlotDigitizer, HDF5 and netCDF-4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import BadInput
from ..hdf5 import SIGNATURE
from .columns import NO_CONVENTION, Asked, Convention, answered, in_si
from .digitizer import datasets_in, is_project, is_two_headed
from .grid import Row, grid_of
from .labelled import read_labelled
from .measured import MOST_BYTES, MOST_ROWS, Measured
from .question import Answers, Guess, Question, Unclear, first_rows
from .series import Series, Shaker
from .text_table import decimal_of, number_of, read_text_table

#: What a file can hold: a resonance curve, the shaker's amplitudes over frequency, a time series.
TABLE_KINDS = ("curve", "shaker", "series")


def read_experiment(path: str | Path, answers: Answers | None = None,
                    wanted: Sequence[str] = TABLE_KINDS) -> Series | Shaker | Measured:
    """The series, shaker amplitudes or resonance curve in a file.

    Raises `Unclear` for what has to be asked, and `BadInput` naming the line.
    """
    path = Path(path)
    try:
        with open(path, "rb") as file:
            content = file.read(MOST_BYTES + 1)
    except OSError as problem:
        raise BadInput(f"Cannot read {str(path)[:200]}: {problem.strerror or problem}.") from None
    try:
        if content.startswith(SIGNATURE):
            found = read_labelled(path, answers or Answers(), wanted, path.name)
        else:
            found = read_data(content, answers, wanted, path.name)
    except Unclear as unclear:
        raise Unclear(replace(unclear.question, reason=f"{path.name}: {unclear.question.reason}")) from None
    except BadInput as problem:
        raise BadInput(f"{path.name}: {problem}") from None
    return replace(found, understood=f"{path.name}: {found.understood}")


def read_data(content: bytes, answers: Answers | None = None, wanted: Sequence[str] = TABLE_KINDS,
              source: str = "", most_bytes: int = MOST_BYTES, most_rows: int = MOST_ROWS,
              convention: Convention = NO_CONVENTION) -> Series | Shaker | Measured:
    """The measurement in the bytes of a text file; `wanted` are the kinds that its reader can use.

    Raises `Unclear` for what has to be asked, and `BadInput` naming the line.
    """
    answers = answers or Answers()
    if len(content) <= most_bytes and is_project(content):
        datasets = datasets_in(content)
        return _digitised(datasets, answers, wanted, source, "a WebPlotDigitizer project")
    grid = grid_of(content, most_bytes, most_rows, answers.separator)
    if is_two_headed(grid.rows):
        decimal = decimal_of([(n, f) for n, fields in grid.rows[2:] for f in fields if f], answers)
        return _digitised(_pairs(grid.rows, decimal), answers, wanted, source, "a table of WebPlotDigitizer")
    return read_text_table(grid, answers, wanted, source, convention)


def _digitised(datasets: dict[str, list[tuple[float, float]]], answers: Answers, wanted: Sequence[str], source: str,
               what: str) -> Series | Shaker | Measured:
    """One dataset of x and y, whose quantities and units a digitiser does not know."""
    names = tuple(datasets)
    name = answers.dataset or (names[0] if len(names) == 1 else "")
    rows = [(i, (f"{x:.9g}", f"{y:.9g}")) for i, (x, y) in enumerate(datasets.get(name, datasets[names[0]]), 1)]
    guesses = (Guess(1, "x", "frequency", "Hz"), Guess(2, "y", "force", "N"))
    about = (*(("dataset",) if len(names) > 1 else ()), "columns")
    if name not in datasets:
        known = ", ".join(map(repr, names))
        raise Unclear(Question(f"This is {what} with {len(names)} datasets: {known[:200]}.", about, guesses,
                               first_rows(rows), names))
    if not answers.columns:
        raise Unclear(Question(f"This is {what}, which does not say what x and y are.", about, guesses,
                               first_rows(rows), names))
    asked = Asked(guesses, first_rows(rows), True)
    chosen = answered(asked, answers)
    points = np.array(datasets[name])
    values = {quantity: np.array([points[:, place] for place, _ in places]) for quantity, places in chosen.items()}
    return in_si(values, chosen, asked, range(1, len(points) + 1), f"dataset {name[:40]!r} of {what}", wanted,
                 answers.source or source, answers.note, True)


def _pairs(rows: list[Row], decimal: str) -> dict[str, list[tuple[float, float]]]:
    """The datasets of a table with a row of names over pairs of X and Y; columns may end early."""
    found: dict[str, list[tuple[float, float]]] = {}
    names = rows[0][1]
    for place in range(0, len(rows[1][1]) - 1, 2):
        name = (names[place] if place < len(names) else "") or f"dataset {place // 2 + 1}"
        pairs = [(line, fields[place : place + 2]) for line, fields in rows[2:] if any(fields[place : place + 2])]
        if pairs:
            found[name] = [(number_of(line, pair[0], decimal), number_of(line, "".join(pair[1:]), decimal))
                           for line, pair in pairs]
    if not found:
        raise BadInput(f"Line {rows[1][0]}: there is no number below the names of the datasets.")
    return found
