"""Checks of a scene. A scene read from a file is checked in full, a changed one only for impossible values."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import MISSING, fields
from typing import Any

from ..errors import BadInput
from ..inputs.checks import unknown_name
from .description import BEAD_LIMITS, Bead, Description, is_number
from .quantities import QUANTITIES, WALL_FACTORS, Quantity

#: Longest text of a scene [characters].
_LONGEST = 10_000
#: Largest number of entries in a list: the largest number of beads.
_MOST = int(QUANTITIES["N"].high)
#: The smallest number above 0.
_TINIEST = math.ulp(0.0)


def _least(quantity: Quantity) -> float:
    """Return the least value of a knob in a scene; its range may start higher."""
    if quantity.low > 0.0:
        return _TINIEST
    return 0.0 if quantity.low == 0.0 else -sys.float_info.max


#: The knobs that are fields of a scene; κ is computed. The wall, which may be a name or a number, is checked
#: separately.
_KNOBS = tuple(quantity for name, quantity in QUANTITIES.items()
               if name in {field.name for field in fields(Description)} and name != "wall")
#: Numeric knobs with their lower limits: above 0, 0 or above, or any finite number.
_NUMBERS = (*((quantity.name, _least(quantity)) for quantity in _KNOBS if quantity.numeric and not quantity.whole),
            ("reference_overlap", _TINIEST))
#: Knobs that are whole numbers.
_COUNTS = tuple(quantity.name for quantity in _KNOBS if quantity.whole)
#: Knobs that are words, with the choices of each.
_WORDS = tuple((quantity.name, frozenset(quantity.choices)) for quantity in _KNOBS if not quantity.numeric)


def checked_values(scene: Description) -> dict[str, Any]:
    """Return fields whose numbers are not `float` or `int`, converted to these; `BadInput` for impossible values.

    It is called for every scene created, tens of thousands for a map, and takes about 8 µs. The ranges of the knobs are
    not checked, because a branch may leave them by a step.
    """
    values: dict[str, Any] = vars(scene)
    converted: dict[str, Any] = {}
    for name, lowest in _NUMBERS:
        value = values[name]
        if type(value) is not float:
            if not is_number(value):
                raise _refused(name, value)
            converted[name] = value = float(value)
        if not lowest <= value < math.inf:
            raise _refused(name, value)
    for name in _COUNTS:
        value = values[name]
        if type(value) is not int:
            if not is_number(value) or not math.isfinite(value) or int(value) != value:
                raise _refused(name, value)
            converted[name] = value = int(value)
        if value < 1:
            raise _refused(name, value)
    for name, choices in _WORDS:
        if values[name] not in choices:
            raise _refused(name, values[name])
    wall = values["wall"]
    if not (wall in WALL_FACTORS if isinstance(wall, str) else is_number(wall) and 0.0 < wall < math.inf):
        raise _refused("wall", wall)
    pattern = converted["pattern"] = tuple(values["pattern"])
    if set(map(type, pattern)) != {Bead}:
        raise _bad("pattern", values["pattern"], "a tuple of one or more values of Bead")
    for name in ("impurities", "start_velocity"):
        if values[name]:
            _check_special(name, values[name], int(values["N"]))
    return converted


def _refused(name: str, value: object) -> BadInput:
    """Return the error for an impossible value, in the words of the knob's own check if that refuses the value too."""
    try:
        _field(name, value)
    except BadInput as problem:
        return problem
    return _bad(name, value, "a finite number above 0")


def _check_special(name: str, entries: Any, beads: int) -> None:
    """Raise `BadInput` if impurities or start velocities name a bead that does not exist, or one bead twice."""
    places = [place for place, _ in entries]
    for place in places:
        if not 1 <= place <= beads:
            raise BadInput(f"The scene's {name} name bead {place}, and its beads are 1 to {beads}.")
    if len(set(places)) < len(places):
        place = max(places, key=places.count)
        raise BadInput(f"The scene's {name} name bead {place} more than once; give it one entry.")


def checked_fields(data: object) -> dict[str, Any]:
    """Return the fields of a scene from the output of `Scene.to_json`; `BadInput` says which one cannot be used."""
    if not isinstance(data, dict):
        raise _bad("a scene", data, "an object with its fields")
    known = {field.name: field for field in fields(Description)}
    for name in data:
        if name not in known:
            raise unknown_name("field of a scene", name, known)
    for name, field in known.items():
        if name not in data and field.default is MISSING:
            raise BadInput(f"The scene has no field {name}.")
    return {name: _field(name, value) for name, value in data.items()}


def _field(name: str, value: object) -> Any:
    if name in QUANTITIES:
        return _knob(name, value)
    if name == "reference_overlap":
        return _number(name, value, 0.0, math.inf)
    if name in _LISTS:
        if not isinstance(value, (list, tuple)) or len(value) > _MOST or (name == "pattern" and not value):
            raise _bad(name, value, f"a list of at most {_MOST} entries")
        return tuple(_LISTS[name](name, entry) for entry in value)
    if not isinstance(value, str) or len(value) > _LONGEST:
        raise _bad(name, value, f"a text of at most {_LONGEST} characters")
    return value


def _knob(name: str, value: object) -> float | int | str:
    """Return a knob's value; in a file, a text that looks like a number does not count as one."""
    quantity = QUANTITIES[name]
    if (isinstance(value, str) and value not in quantity.choices) or isinstance(value, bool):
        raise _bad(name, value, f"one of {', '.join(quantity.choices)}" if quantity.choices else "a number")
    return quantity.check(value)


def _number(name: str, value: object, above: float, most: float) -> float:
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not number or not math.isfinite(value) or not above < value <= most:  # type: ignore[arg-type,operator]
        raise _bad(name, value, f"a finite number above {above:g}" + (f", at most {most:g}" if most < math.inf else ""))
    return value  # type: ignore[return-value]


def _place(name: str, value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool):
        raise _bad(name, value, "the number of a bead")
    return value


def _bead(name: str, value: object) -> Bead:
    if not isinstance(value, dict) or set(value) != set(BEAD_LIMITS):
        raise _bad(name, value, f"beads with {', '.join(BEAD_LIMITS)}")
    return Bead(**{entry: _number(f"{name} {entry}", value[entry], *bounds) for entry, bounds in BEAD_LIMITS.items()})


def _row(name: str, value: object, count: int) -> Any:
    if not isinstance(value, (list, tuple)) or len(value) != count:
        raise _bad(name, value, f"rows of {count}")
    return value


def _impurity(name: str, value: object) -> tuple[int, Bead]:
    place, bead = _row(name, value, 2)
    return _place(name, place), _bead(name, bead)


def _start(name: str, value: object) -> tuple[int, float]:
    place, velocity = _row(name, value, 2)
    return _place(name, place), _number(name, velocity, -math.inf, math.inf)


def _range(name: str, value: object) -> tuple[str, float, float]:
    knob, low, high = _row(name, value, 3)
    return _known(knob), _number(name, low, -math.inf, math.inf), _number(name, high, -math.inf, math.inf)


def _preset(name: str, value: object) -> tuple[str, float | int | str]:
    knob, chosen = _row(name, value, 2)
    return _known(knob), _knob(knob, chosen)


def _known(knob: object) -> str:
    if not isinstance(knob, str) or knob not in QUANTITIES:
        raise unknown_name("knob", knob, QUANTITIES)
    return knob


_LISTS: dict[str, Callable[[str, object], Any]] = {
    "pattern": _bead, "impurities": _impurity, "start_velocity": _start, "ranges": _range, "preset": _preset}


def _bad(name: str, value: object, allowed: str) -> BadInput:
    return BadInput(f"The scene's {name} must be {allowed}, not {str(value)[:40]!r}.")
