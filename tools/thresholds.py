"""The tables of thresholds in docs/regimes.md and other pages, which `python -m tools.update` writes.

A threshold is a constant in `granchain_core` whose `#:` comment begins with a mark: `[period n]` names the regimes that
it decides, `[rotation]` puts it into the table of docs/rotation-number.md, `[response]` into that of docs/orbits.md,
`[fit]` into that of docs/fit.md and `[safety factor]` into that of docs/accuracy.md. `[step size]`, `[branch]` and
`[attractors]` put it into the tables of docs/constants.md.
The comment's first sentence is its row; what follows, the reason, stays in the code. A number beside thresholds that is
none itself is marked `[no threshold]`.
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
#: Marks that a heading has in other words: `followed` is the name of the regime's key in JSON and files.
_IN_WORDS = {"followed": "an orbit that the motion still approaches", "all": "every regime"}


@dataclass(frozen=True)
class Marked:
    """A constant with a mark: the regimes it decides, what it is, its file below `granchain_core`, its name."""

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
        """Its row without the column of regimes."""
        return f"{self.what} | {printed(self.value)} | `{self.name}` in `{self.file}` |"


@cache
def marked_constants() -> tuple[Marked, ...]:
    """All constants with a mark, file by file."""
    found = []
    for path in sorted(_CORE.rglob("*.py")):
        for mark, comment, name in _MARKED.findall(path.read_text(encoding="utf-8")):
            first, *_ = re.split(r"(?<=\.) (?=[A-Z])", comment.replace("\n#:", "").strip())
            what = first.rstrip(".").replace("|", r"\|")
            found.append(Marked(mark, what, path.relative_to(_CORE).as_posix(), name))
    return tuple(found)


def printed(value: float | tuple[float, ...]) -> str:
    """A number to six digits, as a fraction where these are not all; several numbers one after another."""
    if isinstance(value, tuple):
        return ", ".join(map(printed, value))
    short = re.sub(r"e([+-])0*", lambda power: "e" + power[1].strip("+"), f"{value:g}")
    return short if float(short) == value else str(Fraction(value).limit_denominator(100))


#: How the text of a threshold of `period n` begins if it holds for one of the two ways to a steady state, and the
#: heading of the table of these.
_WAYS = {"": "period n", "A batch: ": "period n, in a batch", "A chain alone: ": "period n, of a chain settled alone"}


def tables_of_regimes() -> str:
    """The tables of docs/regimes.md, one below a heading for each set of regimes, in their order."""
    parts: dict[str, list[str]] = {}
    rows = sorted((one for one in marked_constants() if one.mark.split(", ")[0] in _REGIMES),
                  key=lambda one: [_REGIMES.index(regime) for regime in one.mark.split(", ")])
    period_n = [one for one in rows if one.mark == "period n"]
    for begin, heading in _WAYS.items():
        parts[heading] = [_row(one, begin) for one in period_n if _way(one) == begin]
    for one in rows:
        if one.mark != "period n":
            heading = ", ".join(_IN_WORDS.get(mark, mark) for mark in one.mark.split(", "))
            parts.setdefault(heading, []).append(_row(one))
    return "\n\n".join("\n".join([f"### Thresholds: {heading}", "", *_HEAD, *cells]) for heading, cells in parts.items())


def _way(one: Marked) -> str:
    """How the text of a threshold begins: a key of `_WAYS`."""
    return next((begin for begin in _WAYS if begin and one.what.startswith(begin)), "")


def _row(one: Marked, begin: str = "") -> str:
    """A row without the words that the heading above it has."""
    cells = one.cells.removeprefix(begin)
    return f"| {cells[0].upper()}{cells[1:]}"


#: The constants that decide what a motion is called, in the order of the definitions.
_DECIDING = ("SETTLED_DISTANCE", "STANDARD_ERRORS", "_BOUNDED_GROWTH", "_LARGEST_NEUTRAL_EXPONENT", "_RETURN_FACTOR",
             "_SHRINK_FACTOR", "CLEAR_GROWTH", "_EXPONENT_DIFFERENCE", "LONGEST_LOCKED_PERIOD")


def table_of_deciding() -> str:
    """The short table of docs/regimes.md: the thresholds that decide what a motion is called."""
    rows = {one.name: one for one in marked_constants()}
    return "\n".join(["| regime | what | threshold | constant and file |", "|---|---|---|---|",
                      *(f"| {rows[name].mark} | {rows[name].cells}" for name in _DECIDING)])


def table_of_responses() -> str:
    """The table of docs/orbits.md: the rules on a curve, then those of an orbit alone."""
    return _table("response", reverse=True)


def table_of_rotation_numbers() -> str:
    """The table of docs/rotation-number.md."""
    return _table("rotation")


def table_of_safety_factors() -> str:
    """The table of docs/accuracy.md."""
    return _table("safety factor")


def table_of_branches() -> str:
    """The table of docs/constants.md."""
    return _table("branch")


def table_of_fits() -> str:
    """The table of docs/fit.md."""
    return _table("fit")


def table_of_attractors() -> str:
    """The table of docs/constants.md."""
    return _table("attractors")


def table_of_step_sizes() -> str:
    """The table of docs/constants.md: what sets the steps of each method, method by method."""
    rows = sorted((one for one in marked_constants() if one.mark == "step size"), key=lambda one: _METHODS.index(_method(one)))
    table = ["| method | what | value | constant and file |", "|---|---|---|---|"]
    for one in rows:
        what = one.cells.removeprefix(f"{_method(one)}: ")
        table.append(f"| {_method(one)} | {what}")
    return "\n".join(table)


#: What the steps in the table of docs/constants.md belong to, in its order: how the comment of such a constant begins.
_METHODS = ("Fixed steps", "Error control", "dop853", "dop853, tension cut", "dop853-root", "flow")


def _method(one: Marked) -> str:
    """Whose steps a constant sets."""
    return one.what.partition(":")[0]


def _table(mark: str, reverse: bool = False) -> str:
    """All constants with a mark, file by file."""
    rows = sorted((one for one in marked_constants() if one.mark == mark), key=lambda one: one.file, reverse=reverse)
    return "\n".join([*_HEAD, *(f"| {one.cells}" for one in rows)])
