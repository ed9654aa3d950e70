"""The quantity and unit of each column of a file, from its titles, a reader's convention or the user's answers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..errors import BadInput
from .assembled import Columns, assembled, kinds_of
from .measured import Measured
from .question import Answers, Guess, Question, Unclear
from .series import Series, Shaker
from .units import QUANTITIES, UNITS, VOLTS, bracketed_unit, factor_of

#: A curve whose header names no unit is in Hz and N (docs/data.md). If all its frequencies are below this [Hz], the
#: user is asked for the unit, since they may be in kHz.
_TOO_SLOW = 5.0
#: If a force of such a curve exceeds this [N], the user is asked for the unit as well.
_TOO_STRONG = 1e4
_WORDS = {"curve": "a curve", "shaker": "shaker amplitudes", "series": "a series"}
_NEEDS = {"curve": "a curve needs frequency and force",
          "shaker": "shaker amplitudes need frequency and displacement, velocity or acceleration",
          "series": "a series needs time and velocity, displacement, input force or output force"}

#: Columns by quantity: (index from 0, unit or sensitivity).
Chosen = dict[str, list[tuple[int, str]]]


@dataclass(frozen=True)
class Convention:
    """Assumptions of a reader for anything that a file does not state.

    Attributes
    ----------
    untitled : tuple of str
        Quantities of the columns of a file without titles, from the first on. A file may have fewer columns.
    units : dict
        The unit of a quantity whose title gives none.
    insisted : tuple of str
        Quantities whose titles may not give a unit other than the one in `units`.
    same : dict
        Quantities that this reader takes to be another one, for example a force to be the input force.
    """

    untitled: tuple[str, ...] = ()
    units: dict[str, str] = field(default_factory=dict)
    insisted: tuple[str, ...] = ()
    same: dict[str, str] = field(default_factory=dict)


NO_CONVENTION = Convention()


@dataclass(frozen=True)
class Asked:
    """The columns of a file as far as they are known, its first rows, and whether the columns have titles."""

    guesses: Sequence[Guess]
    rows: tuple[tuple[int, tuple[str, ...]], ...]
    titled: bool

    def ask(self, reason: str) -> Unclear:
        """Return the question about these columns."""
        return Unclear(Question(reason, ("columns",), tuple(self.guesses), self.rows))


def chosen_columns(question: Asked, answers: Answers, wanted: Sequence[str], numeric: Sequence[int],
                   convention: Convention = NO_CONVENTION) -> Chosen:
    """Return the columns to be read. Raises `Unclear` if titles, answers and convention leave them open."""
    if answers.columns:
        return answered(question, answers)
    if not question.titled and 2 <= len(question.guesses) == len(numeric) <= len(convention.untitled):
        return {name: [(place, convention.units[name])]
                for place, name in enumerate(convention.untitled[: len(numeric)])}
    if not question.titled:
        if len(numeric) in (2, 3) and not any(one.unit for one in question.guesses):
            likely = [Guess(i + 1, "", quantity, unit) for i, (quantity, unit) in
                      enumerate((("frequency", "Hz"), ("force", "N"), ("error", "N"))[: len(question.guesses)])]
            question = replace(question, guesses=likely)
        raise question.ask("The columns have no titles.")
    chosen: Chosen = {}
    for place, guess in enumerate(question.guesses):
        if guess.quantity is None or place not in numeric:
            continue
        quantity = convention.same.get(guess.quantity, guess.quantity)
        usual = convention.units.get(quantity, "")
        if quantity in convention.insisted and guess.unit not in (None, usual):
            raise BadInput(f"The header says the {quantity.replace('_', ' ')} is in {guess.unit}, and {usual} was "
                           "asked for; they must agree.")
        known = guess.unit or ("" if bracketed_unit(guess.title) else usual)
        chosen.setdefault(quantity, []).append((place, known))
    kinds = [kind for kind in kinds_of(list(chosen)) if kind in wanted]
    if not kinds:
        raise question.ask(_missing(question, wanted))
    kind = kinds[0]
    needed = _needed(kind, chosen)
    chosen = {name: places for name, places in chosen.items() if name in needed}
    for name, places in chosen.items():
        _check_places(name, places, kind, question)
    return chosen


def _needed(kind: str, chosen: Chosen) -> tuple[str, ...]:
    """Return those of the available quantities that this kind of measurement uses."""
    if kind == "curve":
        return ("frequency", "force" if "force" in chosen else "output_force", "error")
    if kind == "shaker":
        return ("frequency", next(one for one in ("displacement", "velocity", "acceleration") if one in chosen))
    return ("time", "velocity", "displacement", "input_force", "output_force")


def _check_places(name: str, places: list[tuple[int, str]], kind: str, question: Asked) -> None:
    titles = [question.guesses[place].title for place, _ in places]
    numbered = len(set(titles)) == len(titles) and all(re.search(r"\d", one) for one in titles)
    repeats = numbered and kind == "curve" and name in ("force", "output_force")
    if len(places) > 1 and not repeats:
        raise question.ask(f"The columns {' and '.join(map(repr, titles))} both say {name.replace('_', ' ')}.")
    for place, unit in places:
        title = question.guesses[place].title
        if unit in VOLTS:
            raise question.ask(f"Column {title!r} is a voltage; its sensor's sensitivity is needed, e.g. 2.248V/kN.")
        strange = bracketed_unit(title)
        if not unit and strange:
            raise question.ask(f"The unit {strange[:20]!r} of column {title[:40]!r} is not known.")
        if not unit and kind != "curve":
            raise question.ask(f"Column {title[:40]!r} has no unit.")


def _missing(question: Asked, wanted: Sequence[str]) -> str:
    unknown = [one.title for one in question.guesses if one.quantity is None and one.title]
    ending = "" if len(unknown) > 1 else "s"
    sentence = (f"What {' and '.join(repr(one[:30]) for one in unknown[:4])} hold{ending} is not clear" if unknown
            else "These columns are not enough")
    return f"{sentence}: {'; '.join(_NEEDS[kind] for kind in wanted)}."


def answered(question: Asked, answers: Answers) -> Chosen:
    """Return the columns that the user has named."""
    chosen: Chosen = {}
    for quantity, places in answers.columns.items():
        for number, unit in places:
            if number > len(question.guesses):
                raise BadInput(f"There is no column {number}; the file has {len(question.guesses)}.")
            if any(place == number - 1 for columns in chosen.values() for place, _ in columns):
                raise BadInput(f"Column {number} is assigned to two quantities; name one.")
            chosen.setdefault(quantity, []).append((number - 1, unit))
    return chosen


def in_si(values: dict[str, np.ndarray], chosen: Chosen, question: Asked, lines: Sequence[int], layout: str,
          wanted: Sequence[str], source: str, note: str, asked_for: bool) -> Series | Shaker | Measured:
    """Convert the columns from the file's units and assemble the measurement."""
    scaled, units = {}, {}
    for quantity, places in chosen.items():
        factors = []
        for place, unit in places:
            stated = question.guesses[place].unit
            unit = unit or next(iter(UNITS[QUANTITIES[quantity]]))
            factor = factor_of(quantity, unit, stated)
            if factor is None:
                raise BadInput(f"{unit!r} is not a unit of {quantity.replace('_', ' ')}.")
            factors.append(factor)
            units[quantity] = unit
        scaled[quantity] = values[quantity] * np.array(factors)[:, None]
    kinds = [kind for kind in kinds_of(list(scaled)) if kind in wanted]
    if not kinds:
        quantities = " and ".join(one.replace("_", " ") for one in scaled)
        needed = " or ".join(_WORDS[kind] for kind in wanted)
        raise BadInput(f"{quantities[0].upper()}{quantities[1:]} are not enough for {needed}.")
    if not asked_for:
        _check_plausible(scaled, chosen, question)
    return assembled(Columns(scaled, lines, units), kinds[0], layout, source, note)


def _check_plausible(scaled: dict[str, np.ndarray], chosen: Chosen, question: Asked) -> None:
    """Ask for units that no title gives if Hz and N would be implausible."""
    for quantity, strange in (("frequency", f"all would be below {_TOO_SLOW:g} Hz"),
                              ("force", f"one would exceed {_TOO_STRONG:g} N")):
        if quantity not in chosen or chosen[quantity][0][1]:
            continue
        largest = float(scaled[quantity].max())
        if largest < _TOO_SLOW if quantity == "frequency" else largest > _TOO_STRONG:
            title = question.guesses[chosen[quantity][0][0]].title
            raise question.ask(f"Column {title[:40]!r} has no unit, and {strange}.")
