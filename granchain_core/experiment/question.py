"""Questions about a file whose columns, units or number format are ambiguous, and the user's answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..errors import BadInput
from ..inputs.checks import unknown_name
from ..inputs.text import whole_in
from .units import QUANTITIES, SHORT, UNITS, VOLTS, factor_of

#: Words for the separators of columns and for the decimal marks.
SEPARATORS = {"semicolon": ";", "tab": "\t", "comma": ",", "bar": "|", "space": " "}
DECIMALS = ("point", "comma")
_FIRST_ROWS = 5


@dataclass(frozen=True)
class Answers:
    """The user's answers about a file.

    `columns` maps every quantity to its columns, numbered from 1, each with a unit or a sensitivity; columns that are
    not named are left out. `dataset` is the name of one of a digitiser's datasets.
    """

    columns: dict[str, tuple[tuple[int, str], ...]] = field(default_factory=dict)
    decimal: str | None = None
    separator: str | None = None
    dataset: str | None = None
    source: str = ""
    note: str = ""


@dataclass(frozen=True)
class Guess:
    """A column: its number from 1, its title, and its likely quantity and unit (None if unknown)."""

    number: int
    title: str
    quantity: str | None = None
    unit: str | None = None

    @property
    def likely_unit(self) -> str:
        """The unit or, if it is unknown, the SI unit of the quantity; for a voltage, a sensitivity as an example."""
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
        """The command-line options that would answer the question."""
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
        """Return the first rows with their line numbers and the columns' numbers, for a terminal."""
        head = [f"{one.number}: {one.title or '?'}"[:24] for one in self.columns]
        cells = [[f"line {line}", *(field[:24] for field in fields)] for line, fields in self.rows]
        rows = ([["", *head]] if head else []) + cells
        width = [max(len(row[i]) for row in rows if i < len(row)) for i in range(max(map(len, rows), default=0))]
        return "\n".join("  ".join(cell.ljust(width[i]) for i, cell in enumerate(row)).rstrip() for row in rows)


class Unclear(BadInput):
    """A file that can be read in more than one way; `question` has its first rows and the question for the user.

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
        super().__init__(f"{question.reason} Specify it with {question.options}.")
        self.question = question


def first_rows(rows: Sequence[tuple[int, Sequence[str]]]) -> tuple[tuple[int, tuple[str, ...]], ...]:
    """Return the rows that a question shows."""
    return tuple((number, tuple(fields)) for number, fields in rows[:_FIRST_ROWS])


def answers_of(columns: Sequence[str] = (), decimal: str | None = None, separator: str | None = None,
               dataset: str | None = None, source: str = "", note: str = "") -> Answers:
    """Parse answers: columns as QUANTITY=COLUMN:UNIT, for example f=1:kHz or force=2:2.248V/kN.

    Raises `BadInput` for anything else.
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
