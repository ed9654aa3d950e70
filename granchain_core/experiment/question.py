"""Questions about a file whose columns, units or number format are ambiguous, and the user's answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..errors import BadInput
from ..inputs.checks import unknown_name
from ..inputs.text import whole_in
from .units import QUANTITIES, SHORT, UNITS, VOLTS, factor_of

#: Words for the marks between columns and before decimals.
SEPARATORS = {"semicolon": ";", "tab": "\t", "comma": ",", "bar": "|", "space": " "}
DECIMALS = ("point", "comma")
_FIRST_ROWS = 5


@dataclass(frozen=True)
class Answers:
    """A person's answers about a file.

    `columns` has for every quantity the columns that hold it, numbered from 1, with a unit or a sensitivity each;
    columns that are not named are left out. `dataset` names one of a digitiser's.
    """

    columns: dict[str, tuple[tuple[int, str], ...]] = field(default_factory=dict)
    decimal: str | None = None
    separator: str | None = None
    dataset: str | None = None
    source: str = ""
    note: str = ""


@dataclass(frozen=True)
class Guess:
    """A column: its number from 1, its title, and what it may hold (None where nothing is known)."""

    number: int
    title: str
    quantity: str | None = None
    unit: str | None = None

    @property
    def likely_unit(self) -> str:
        """The unit or, where none is known, the SI unit of the quantity; for a voltage a sensitivity as an example."""
        usual = next(iter(UNITS[QUANTITIES[self.quantity or "frequency"]]))
        if self.unit in VOLTS:
            return f"2.248{self.unit}/{usual}"
        return self.unit or usual


@dataclass(frozen=True)
class Question:
    """A question about a file: `about` is "columns", "decimal" or "dataset"; the first rows are (line, fields)."""

    reason: str
    about: tuple[str, ...]
    columns: tuple[Guess, ...] = ()
    rows: tuple[tuple[int, tuple[str, ...]], ...] = ()
    datasets: tuple[str, ...] = ()

    @property
    def options(self) -> str:
        """The options of a command line that would answer it."""
        options = []
        if "dataset" in self.about:
            options.append(f"--dataset '{self.datasets[0]}'")
        if "decimal" in self.about:
            options.append("--decimal comma or --decimal point")
        if "columns" in self.about:
            known = [one for one in self.columns if one.quantity] or [Guess(1, "", "frequency"), Guess(2, "", "force")]
            options += [f"--column {one.quantity}={one.number}:{one.likely_unit}" for one in known]
        return " ".join(options)

    @property
    def table(self) -> str:
        """The first rows with their lines and the columns' numbers, for a terminal."""
        head = [f"{one.number}: {one.title or '?'}"[:24] for one in self.columns]
        cells = [[f"line {line}", *(field[:24] for field in fields)] for line, fields in self.rows]
        rows = ([["", *head]] if head else []) + cells
        width = [max(len(row[i]) for row in rows if i < len(row)) for i in range(max(map(len, rows), default=0))]
        return "\n".join("  ".join(cell.ljust(width[i]) for i, cell in enumerate(row)).rstrip() for row in rows)


class Unclear(BadInput):
    """A file that can be read in more than one way; `question` has its first rows and what is asked.

    Examples
    --------
    >>> from granchain_core.experiment import Unclear, read_data
    >>> try:
    ...     read_data(b"60,1.5")
    ... except Unclear as unclear:
    ...     print(unclear.question.rows)
    ((1, ('60', '1.5')),)
    """

    def __init__(self, question: Question) -> None:
        super().__init__(f"{question.reason} Say it by {question.options}.")
        self.question = question


def first_rows(rows: Sequence[tuple[int, Sequence[str]]]) -> tuple[tuple[int, tuple[str, ...]], ...]:
    """The rows that a question shows."""
    return tuple((number, tuple(fields)) for number, fields in rows[:_FIRST_ROWS])


def answers_of(columns: Sequence[str] = (), decimal: str | None = None, separator: str | None = None,
               dataset: str | None = None, source: str = "", note: str = "") -> Answers:
    """Answers from words: columns as QUANTITY=COLUMN:UNIT, for example f=1:kHz or force=2:2.248V/kN.

    Raises `BadInput` for what is not one.
    """
    columns_by_quantity: dict[str, tuple[tuple[int, str], ...]] = {}
    for text in columns:
        name, _, rest = text.partition("=")
        place, _, unit = rest.partition(":")
        quantity = SHORT.get(name, name)
        if quantity not in QUANTITIES:
            raise unknown_name("quantity", name, [*QUANTITIES, *SHORT])
        number = whole_in(place)
        if number is None or number < 1:
            raise BadInput(f"--column {text!r}: {place!r} is not the number of a column; write {name}=1:UNIT.")
        known = UNITS[QUANTITIES[quantity]]
        unit = unit or next(iter(known))
        if factor_of(quantity, unit) is None:
            raise BadInput(f"--column {text!r}: {unit!r} is not a unit of {quantity.replace('_', ' ')}; known: "
                           f"{', '.join(known)}, or a sensitivity as 2.248V/{next(iter(known))}.")
        columns_by_quantity[quantity] = (*columns_by_quantity.get(quantity, ()), (number, unit))
    if decimal is not None and decimal not in DECIMALS:
        raise unknown_name("decimal mark", decimal, DECIMALS)
    if separator is not None and separator not in SEPARATORS:
        raise unknown_name("separator", separator, SEPARATORS)
    return Answers(columns_by_quantity, decimal, separator, dataset, source, note)
