"""Measurements in HDF5 and netCDF-4 files: rows of numbers with names and units."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..errors import BadInput
from ..hdf5 import File, opened
from ..hdf5.plain import Refused, Stored
from .columns import Asked, chosen_columns, in_si
from .measured import MOST_ROWS, Measured
from .question import Answers, Guess
from .series import Series, Shaker
from .units import heading, unit_named


def read_labelled(path: str | Path, answers: Answers, wanted: Sequence[str], source: str,
                  most_rows: int = MOST_ROWS) -> Series | Shaker | Measured:
    """Return the measurement in a file. Its columns are rows of equal length; of several lengths, the one with an axis.

    HDF5 parses the file in a child process, because in the dashboard it comes from a visitor.

    Raises `Unclear` and `BadInput`.
    """
    with opened(path, "is not a measurement that can be read", called="The file", foreign=True) as file:
        stored, refused = _rows(file, most_rows)
        if not stored:
            raise Refused(refused or "it has no two rows of numbers of one length")
        names = _group(stored)
        guesses = [_guess(i, name, stored[name].units) for i, name in enumerate(names)]
        columns = [np.asarray(file.numbers(name, stored[name].shape, "any"), dtype=float) for name in names]
        note = answers.note or _note(file)
    rows = tuple((i + 1, tuple(f"{values[i]:.6g}" for values in columns)) for i in range(min(5, len(columns[0]))))
    question = Asked(guesses, rows, True)
    chosen = chosen_columns(question, answers, wanted, range(len(columns)))
    values = {}
    for quantity, places in chosen.items():
        values[quantity] = np.array([columns[place] for place, _ in places])
        bad = np.argwhere(~np.isfinite(values[quantity]))
        if len(bad):
            raise BadInput(f"Row {bad[0][1] + 1} of {names[places[bad[0][0]][0]]} is not a finite number.")
    used = {place for places in chosen.values() for place, _ in places}
    left = [name for place, name in enumerate(names) if place not in used]
    layout = "HDF5" + (f"; left out: {', '.join(left)[:200]}" if left else "")
    return in_si(values, chosen, question, range(1, len(columns[0]) + 1), layout, wanted,
                 answers.source or source, note, bool(answers.columns))


def _rows(file: File, most_rows: int) -> tuple[dict[str, Stored], str]:
    """Return the rows of numbers in a file, and why others are not read."""
    datasets, refused = {}, ""
    for name in file.names():
        try:
            stored = file.described(name)
        except Refused as problem:
            refused = refused or str(problem)
            continue
        if len(stored.shape) != 1 or stored.shape[0] < 2 or stored.type == "text":
            continue
        if stored.shape[0] > most_rows:
            refused = refused or f"/{name} has {stored.shape[0]} numbers; at most {most_rows} are read"
            continue
        datasets[name] = stored
    return datasets, refused


def _group(stored: dict[str, Stored]) -> list[str]:
    """Return the rows of one group and length, preferably with an axis (frequency or time), otherwise the most rows."""
    groups: dict[tuple[str, int], list[str]] = {}
    for name, one in stored.items():
        groups.setdefault((name.rpartition("/")[0], one.shape[0]), []).append(name)
    axis = ("frequency", "time")
    return max(groups.values(), key=lambda names: (
        any(_guess(0, name, stored[name].units).quantity in axis for name in names) and len(names) > 1, len(names)))


def _guess(place: int, name: str, units: str | None) -> Guess:
    """Guess the quantity and unit of a row from its name and its attribute `units`."""
    bare = name.rpartition("/")[2]
    if not units:
        quantity, unit, _ = heading(bare)
        return Guess(place + 1, bare, quantity, unit)
    title = f"{bare} ({units})"
    quantity, unit, _ = heading(title)
    return Guess(place + 1, title, quantity, unit or unit_named(units))


def _note(file: File) -> str:
    """Return the file's description of itself, from the attributes of the CF conventions."""
    notes = []
    for name in ("title", "source", "comment", "history"):
        try:
            notes.append(file.text(name))
        except Refused:
            continue
    return " ".join(notes)[:500]
