"""The formats of measured data: how a file is recognised and read. docs/data.md has the same table."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import BadInput
from ..hdf5 import SIGNATURE
from .columns import NO_CONVENTION, Asked, Convention, answered, in_si
from .digitizer import datasets_in, is_project, is_two_headed
from .grid import Row, check_size, grid_of
from .labelled_files import read_labelled
from .measured import MOST_BYTES, MOST_ROWS, Measured
from .question import Answers, Guess, Question, Unclear, first_rows
from .series import Series, Shaker
from .text_table import decimal_of, number_of, read_text_table


@dataclass(frozen=True)
class Reading:
    """Instructions for reading a file.

    Attributes
    ----------
    answers : Answers
        The user's answers about the file.
    wanted : sequence of str
        The kinds of measurement that the reader can use.
    source : str
        Name of the file.
    most_bytes, most_rows : int
        Limits on the size of the content, and on lines of a text, numbers in a row of HDF5 or points of a dataset.
    convention : Convention
        The reader's assumptions.
    path : Path or None
        Location of the file. If it is given, the content passed along may be only the beginning of the file.
    """

    answers: Answers
    wanted: Sequence[str]
    source: str = ""
    most_bytes: int = MOST_BYTES
    most_rows: int = MOST_ROWS
    convention: Convention = NO_CONVENTION
    path: Path | None = None


@dataclass(frozen=True)
class Format:
    """A format of measured data.

    Attributes
    ----------
    name : str
        As in the table of docs/data.md.
    endings : tuple of str
        Suffixes of such files, which the dashboard's file dialog offers. A file is recognised only by its content.
    recognises : callable
        Returns whether a content (bytes) has this format.
    read : callable
        Returns the measurement in a content, read according to a `Reading`. Raises `Unclear` and `BadInput`.
    """

    name: str
    endings: tuple[str, ...]
    recognises: Callable[[bytes], bool]
    read: Callable[[bytes, Reading], Series | Shaker | Measured]


def format_of(content: bytes) -> Format:
    """Return the format of a file with this content: the first in the table that recognises it."""
    return next(one for one in FORMATS if one.recognises(content))


def _read_labelled(content: bytes, reading: Reading) -> Series | Shaker | Measured:
    if reading.path is not None:
        return read_labelled(reading.path, reading.answers, reading.wanted, reading.source, reading.most_rows)
    check_size(content, reading.most_bytes)
    with tempfile.TemporaryDirectory() as folder:  # HDF5 opens only files
        path = Path(folder) / "data.h5"
        path.write_bytes(content)
        return read_labelled(path, reading.answers, reading.wanted, reading.source, reading.most_rows)


def _read_project(content: bytes, reading: Reading) -> Series | Shaker | Measured:
    check_size(content, reading.most_bytes)
    return _digitised(datasets_in(content), reading, "a WebPlotDigitizer project")


def _read_text(content: bytes, reading: Reading) -> Series | Shaker | Measured:
    grid = grid_of(content, reading.most_bytes, reading.most_rows, reading.answers.separator)
    if is_two_headed(grid.rows):
        decimal = decimal_of([(n, f) for n, fields in grid.rows[2:] for f in fields if f], reading.answers)
        return _digitised(_pairs(grid.rows, decimal), reading, "a table of WebPlotDigitizer")
    return read_text_table(grid, reading.answers, reading.wanted, reading.source, reading.convention)


#: Text comes last, because it refuses any content that no format recognises, and says what kind of file it is.
TEXT = Format("table in text", (".csv", ".tsv", ".txt", ".dat"), lambda content: True, _read_text)
FORMATS = (
    Format("HDF5 or netCDF-4", (".h5", ".hdf5", ".nc"), lambda content: content.startswith(SIGNATURE), _read_labelled),
    Format("project of WebPlotDigitizer", (".json", ".tar"), is_project, _read_project),
    TEXT,
)


def _digitised(datasets: dict[str, list[tuple[float, float]]], reading: Reading,
               what: str) -> Series | Shaker | Measured:
    """Read one dataset of x and y; the digitiser does not know their quantities and units."""
    answers, names = reading.answers, tuple(datasets)
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
    if len(rows) > reading.most_rows:
        raise BadInput(f"The dataset {name[:40]!r} has {len(rows)} points; at most {reading.most_rows} are read.")
    question = Asked(guesses, first_rows(rows), True)
    chosen = answered(question, answers)
    points = np.array(datasets[name])
    values = {quantity: np.array([points[:, place] for place, _ in places]) for quantity, places in chosen.items()}
    return in_si(values, chosen, question, range(1, len(points) + 1), f"dataset {name[:40]!r} of {what}",
                 reading.wanted, answers.source or reading.source, answers.note, True)


def _pairs(rows: list[Row], decimal: str) -> dict[str, list[tuple[float, float]]]:
    """Return the datasets of a table with a row of names above pairs of X and Y; columns may differ in length."""
    points_by_name: dict[str, list[tuple[float, float]]] = {}
    names = rows[0][1]
    for place in range(0, len(rows[1][1]) - 1, 2):
        name = (names[place] if place < len(names) else "") or f"dataset {place // 2 + 1}"
        pairs = [(line, fields[place : place + 2]) for line, fields in rows[2:] if any(fields[place : place + 2])]
        if pairs:
            points_by_name[name] = [(number_of(line, pair[0], decimal), number_of(line, "".join(pair[1:]), decimal))
                           for line, pair in pairs]
    if not points_by_name:
        raise BadInput(f"Line {rows[1][0]}: there is no number below the names of the datasets.")
    return points_by_name
