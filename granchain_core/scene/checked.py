"""Checks of a scene read from a file: its knobs as on the command line, its beads one by one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import MISSING, fields
from typing import Any

from ..errors import BadInput, unknown_name
from ..quantities import QUANTITIES
from .description import Bead, Description

#: Longest text of a scene [characters].
_LONGEST = 10_000
#: Most entries of a list: as many as beads.
_MOST = int(QUANTITIES["N"].high)
#: What a bead's values must be above, and may be at most. Poisson's ratio of a stable material is from −1 to 0.5.
_BEAD = {"mass": (0.0, math.inf), "radius": (0.0, math.inf), "young": (0.0, math.inf), "poisson": (-1.0, 0.5)}


def checked_fields(data: object) -> dict[str, Any]:
    """The fields of a scene from what `Scene.to_json` gives; `BadInput` says which one cannot be used."""
    if not isinstance(data, dict):
        raise _bad("a scene", data, "an object with its fields")
    known = {field.name: field for field in fields(Description)}
    for name in data:
        if name not in known:
            raise unknown_name("field of a scene", name, known)
    for name, field in known.items():
        if name not in data and field.default is MISSING:
            raise BadInput(f"The scene has no field {name}.")
    found = {name: _field(name, value) for name, value in data.items()}
    for name in ("impurities", "start_velocity"):
        for place, _ in found.get(name, ()):
            if not 1 <= place <= found["N"]:
                raise BadInput(f"The scene's {name} name bead {place}, and its beads are 1 to {found['N']}.")
    return found


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
    """A knob's value; a text that looks like a number is none in a file."""
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
    if not isinstance(value, dict) or set(value) != set(_BEAD):
        raise _bad(name, value, f"beads with {', '.join(_BEAD)}")
    return Bead(**{entry: _number(f"{name} {entry}", value[entry], *bounds) for entry, bounds in _BEAD.items()})


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
