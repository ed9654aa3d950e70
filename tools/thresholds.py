"""The tables of thresholds in docs/regimes.md and other pages, written by `python -m tools.update`.

A threshold is a constant in `granchain_core` whose `#:` comment begins with a mark. A mark such as `[period n]` names
the regimes to which it belongs. `[rotation]` puts it into the table of docs/rotation-number.md, `[response]` into that
of docs/orbits.md, `[fit]` into that of docs/fit.md and `[safety factor]` into that of docs/accuracy.md. `[step size]`,
`[branch]` and `[attractors]` put it into the tables of docs/constants.md.

The comment's first sentence becomes its row; the rest, the reason, stays in the code. A number next to thresholds that
is not a threshold itself is marked `[no threshold]`.
"""

from __future__ import annotations

import importlib
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path

_CORE = Path(__file__).resolve().parents[1] / "granchain_core"
#: A comment with a mark, and the name of the constant below it.
_MARKED = re.compile(r"^#: \[([a-z, -]+)\] ((?:.*\n)(?:#: .*\n)*)(\w+)\b.*=", re.MULTILINE)
#: The first two lines of a table.
_HEAD = ("| what | threshold | constant and file |", "|---|---|---|")
_REGIMES = ("period n", "followed", "chaotic", "quasi-periodic", "unsettled", "all")
#: Marks that the table spells out: `followed` is the name of the regime's key in JSON and files.
_IN_WORDS = {"followed": "an orbit that the motion still approaches", "all": "every regime"}


@dataclass(frozen=True)
class Marked:
    """A constant with a mark: the mark, what the constant is, its file below `granchain_core`, its name."""

    mark: str
    what: str
    file: str
    name: str

    @property
    def value(self) -> float:
        """Its value in the code."""
        return getattr(importlib.import_module("granchain_core." + self.file[:-3].replace("/", ".")), self.name)

    @property
    def cells(self) -> str:
        """Its cells in every table."""
        return f"{self.what} | {printed(self.value)} | `{self.name}` in `{self.file}` |"


@cache
def marked_constants() -> tuple[Marked, ...]:
    """Return all constants with a mark, file by file."""
    found = []
    for path in sorted(_CORE.rglob("*.py")):
        for mark, comment, name in _MARKED.findall(path.read_text(encoding="utf-8")):
            first, *_ = re.split(r"(?<=\.) (?=[A-Z])", comment.replace("\n#:", "").strip())
            what = first.rstrip(".").replace("|", r"\|")
            found.append(Marked(mark, what, path.relative_to(_CORE).as_posix(), name))
    return tuple(found)


def printed(value: float | tuple[float, ...]) -> str:
    """Return a number to six digits, or as a fraction if it has more; several numbers are separated by commas."""
    if isinstance(value, tuple):
        return ", ".join(map(printed, value))
    short = re.sub(r"e([+-])0*", lambda power: "e" + power[1].strip("+"), f"{value:g}")
    return short if float(short) == value else str(Fraction(value).limit_denominator(100))


#: The beginning of the text of a `period n` threshold that applies to only one of the two ways to a steady state, and
#: the regime in the table.
_WAYS = {"A batch: ": "period n, in a batch", "A chain alone: ": "period n, settled alone"}
#: The constants that decide the label of a motion, in the order of the definitions: the first rows of the table.
DECIDING = ("SETTLED_DISTANCE", "LONGEST_LOCKED_PERIOD", "STANDARD_ERRORS", "_BOUNDED_GROWTH", "CLEAR_GROWTH",
            "_LARGEST_NEUTRAL_EXPONENT", "_RETURN_FACTOR", "_SHRINK_FACTOR", "_EXPONENT_DIFFERENCE")


def table_of_regimes() -> str:
    """Return the table of docs/regimes.md: the thresholds that decide a label, then the others, regime by regime."""
    rows = [one for one in marked_constants() if one.mark.split(", ")[0] in _REGIMES]
    ways = ["", *_WAYS]
    deciding = sorted((one for one in rows if one.name in DECIDING), key=lambda one: DECIDING.index(one.name))
    others = sorted((one for one in rows if one.name not in DECIDING),
                    key=lambda one: ([_REGIMES.index(mark) for mark in one.mark.split(", ")], ways.index(_way(one))))
    return "\n".join(["| regime | decides | what | threshold | constant and file |", "|---|---|---|---|---|",
                      *(_row(one, "the label") for one in deciding), *(_row(one, "evidence") for one in others)])


def _way(one: Marked) -> str:
    """Return the beginning of a threshold's text if it is a key of `_WAYS`."""
    return next((begin for begin in _WAYS if one.mark == "period n" and one.what.startswith(begin)), "")


def _row(one: Marked, decides: str) -> str:
    """Return a row, without the words at the beginning of its text that are in its first column."""
    begin = _way(one)
    regimes = _WAYS[begin] if begin else ", ".join(_IN_WORDS.get(mark, mark) for mark in one.mark.split(", "))
    cells = one.cells.removeprefix(begin)
    return f"| {regimes} | {decides} | {cells[0].upper()}{cells[1:]}"


def table_of_responses() -> str:
    """Return the table of docs/orbits.md: the rules for a curve, then those for an orbit alone."""
    return _table("response", reverse=True)


def table_of_rotation_numbers() -> str:
    """Return the table of docs/rotation-number.md."""
    return _table("rotation")


def table_of_safety_factors() -> str:
    """Return the table of docs/accuracy.md."""
    return _table("safety factor")


def table_of_branches() -> str:
    """Return the table of branch constants in docs/constants.md."""
    return _table("branch")


def table_of_fits() -> str:
    """Return the table of docs/fit.md."""
    return _table("fit")


def table_of_attractors() -> str:
    """Return the table of constants of the attractor search in docs/constants.md."""
    return _table("attractors")


def table_of_step_sizes() -> str:
    """Return the table of step sizes in docs/constants.md, method by method."""
    rows = sorted((one for one in marked_constants() if one.mark == "step size"), key=lambda one: _METHODS.index(_method(one)))
    table = ["| method | what | value | constant and file |", "|---|---|---|---|"]
    for one in rows:
        what = one.cells.removeprefix(f"{_method(one)}: ")
        table.append(f"| {_method(one)} | {what}")
    return "\n".join(table)


#: The methods in the table of step sizes, in its order; the comment of such a constant begins with one of them.
_METHODS = ("Fixed steps", "Error control", "dop853", "dop853, tension cut", "dop853-root", "flow")


def _method(one: Marked) -> str:
    """Return the method whose steps a constant sets."""
    return one.what.partition(":")[0]


def _table(mark: str, reverse: bool = False) -> str:
    """Return the table of all constants with a mark, file by file."""
    rows = sorted((one for one in marked_constants() if one.mark == mark), key=lambda one: one.file, reverse=reverse)
    return "\n".join([*_HEAD, *(f"| {one.cells}" for one in rows)])
