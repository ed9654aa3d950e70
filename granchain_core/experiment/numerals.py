"""Numbers as spreadsheets write them: decimal point or comma; thousands separated by the other mark, ' or a space.

A file has one decimal mark. It is certain if only one reading fits every number and no number has a different value
under the other reading. Otherwise the user is asked.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from ..errors import BadInput
from ..inputs.text import number_in
from .grid import LIKE_A_NUMBER

_EXPONENT = r"(?:[eEdD][+-]?\d+)?"
_WHOLE = r"[+-]?(?:\d+|[1-9]\d{0,2}(?:(MARKS)\d{3})(?:\1\d{3})*)?"
_READ_AS = {
    "point": re.compile(_WHOLE.replace("MARKS", "[, '’]") + rf"(?:\.\d*)?{_EXPONENT}", re.ASCII),
    "comma": re.compile(_WHOLE.replace("MARKS", "[. '’]") + rf"(?:,\d*)?{_EXPONENT}", re.ASCII),
}
_OTHER = {"point": ",", "comma": "."}
#: A number whose mark may separate thousands or decimals, with nothing to show which.
_BARE_GROUP = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}", re.ASCII)


def number_as(field: str, decimal: str) -> float | None:
    """Return the finite number in a field, read with this decimal mark; None for anything else."""
    if not _READ_AS[decimal].fullmatch(field):
        return None
    plain = re.sub(rf"[{re.escape(_OTHER[decimal])} '’]", "", field).replace(",", ".")
    return number_in(re.sub("[dD]", "e", plain))


def decimal_mark(fields: Iterable[tuple[int, str]]) -> str | None:
    """Return the decimal mark of numbers given with their lines; None if the user has to be asked.

    Raises `BadInput` if neither reading fits all of them.
    """
    marked = [(line, field) for line, field in fields
              if ("." in field or "," in field) and LIKE_A_NUMBER.fullmatch(field)]
    misfits = {mark: next(((line, field) for line, field in marked if not _READ_AS[mark].fullmatch(field)), None)
               for mark in _READ_AS}
    possible = [mark for mark, misfit in misfits.items() if misfit is None]
    if not possible:
        (line, no_point), (other_line, no_comma) = misfits["point"], misfits["comma"]  # type: ignore[misc]  # not None
        raise BadInput(f"Line {line}: {no_point[:30]!r} does not have a decimal point, and {no_comma[:30]!r} in line "
                       f"{other_line} no decimal comma; write every number with the same decimal mark.")
    different = [field for _, field in marked if number_as(field, "point") != number_as(field, "comma")]
    if not different:
        return possible[0] if len(possible) == 1 else "point"
    if len(possible) == 2:
        return None
    mark = possible[0]
    groups = [one for one in different if _OTHER[mark] in one]
    proven = not groups or any(not _BARE_GROUP.fullmatch(one) for one in groups)
    return mark if proven else None
