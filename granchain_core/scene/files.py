"""Scene files: TOML text, checked section by section, and the scene that it describes (docs/scene-file.md)."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from ..errors import BadInput
from ..inputs.checks import unknown_name
from .checked import checked_fields
from .description import Bead
from .model import Scene
from .quantities import QUANTITIES

#: Longest scene file [bytes].
MOST_BYTES = 100_000
#: Sections of a scene file that are tables, with the names that each may contain.
TABLES = {"chain": ("pattern", "impurities", "start_velocity", "reference_overlap"), "knobs": tuple(QUANTITIES),
          "ranges": tuple(QUANTITIES)}
#: Further entries of a scene file: texts, and the place in the list of scenes.
WORDS = ("parent", "title", "look_at", "question", "paper", "order")
_BEAD = tuple(field.name for field in fields(Bead))
#: Names of the entry with the number of a bead: the present one and that of older files.
_SITE = ("site", "place")


def toml_of(path: Path) -> dict[str, Any]:
    """Return the content of a scene file with known sections only. Raises `BadInput` for anything unusable."""
    try:
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except OSError as problem:
        raise BadInput(f"{path.name}: cannot be read ({problem.strerror or problem}).") from None
    if len(raw) > MOST_BYTES:
        raise BadInput(f"{path.name}: a scene file has at most {MOST_BYTES} bytes.")
    try:
        data = tomllib.loads(raw.decode("utf-8-sig"))
    except UnicodeDecodeError:
        raise BadInput(f"{path.name}: is not UTF-8 text.") from None
    except (tomllib.TOMLDecodeError, RecursionError) as problem:
        why = str(problem)
        raise BadInput(f"{path.name}: the text is not TOML; {why[:1].lower()}{why[1:]}.") from None
    try:
        _check_sections(data)
    except BadInput as problem:
        raise BadInput(f"{path.name}: {problem}") from None
    return data


def _check_sections(data: dict[str, Any]) -> None:
    _only(data, "section", (*TABLES, *WORDS))
    for section, names in TABLES.items():
        table = data.get(section, {})
        if not isinstance(table, dict):
            raise BadInput(f"[{section}] must be a table, not {str(table)[:40]!r}.")
        _only(table, f"name in [{section}]", names)
    for name in WORDS[:-1]:
        if not isinstance(data.get(name, ""), str):
            raise BadInput(f"{name} must be a text, not {str(data[name])[:40]!r}.")
    order = data.get("order", 0)
    if isinstance(order, bool) or not isinstance(order, (int, float)) or not math.isfinite(order):
        raise BadInput(f"order must be a number, not {str(order)[:40]!r}.")
    if {"k", "kappa"} <= set(data.get("knobs", {})):
        raise BadInput("[knobs] has k and kappa, which are the same quantity: give one of them.")


def built(name: str, data: dict[str, Any]) -> Scene:
    """Build a scene from merged sections; each value is checked like user input. Raises `BadInput` for a bad one."""
    chain, knobs = data.get("chain", {}), dict(data.get("knobs", {}))
    kappa = knobs.pop("kappa", None)
    for needed, section in (("pattern", chain), ("reference_overlap", chain), ("N", knobs), ("f", knobs),
                            ("A0", knobs), ("D", knobs)):
        if needed not in section:
            raise BadInput(f"there is no {needed}; give it, or a parent that has it.")
    beads = [_bead(entry, "pattern") for entry in _list(chain["pattern"], "pattern")]
    fields = checked_fields({
        "k": 0.0, "F0": 0.0, "wall": "bead", "dissipation": "linear", "tension": "allowed", "accuracy": 1e-6, **knobs,
        "name": name, "title": data.get("title", name), "look_at": data.get("look_at", ""),
        "paper": data.get("paper", ""), "reference_overlap": chain["reference_overlap"], "pattern": beads,
        "impurities": [_impurity(entry, beads) for entry in _list(chain.get("impurities", ()), "impurities")],
        "start_velocity": [_start(entry) for entry in _list(chain.get("start_velocity", ()), "start_velocity")],
        "ranges": [_range(knob, ends) for knob, ends in data.get("ranges", {}).items()]})
    ranges = tuple((knob, float(low), float(high)) for knob, low, high in fields["ranges"])
    new = Scene(**{**fields, "ranges": ranges})
    new = new.evolve(**{n: v for n, v in new.knobs.items() if n != "kappa"})
    if kappa is not None:
        new = new.evolve(kappa=kappa)
    return replace(new, preset=tuple((n, new.knobs[n]) for n in QUANTITIES))


def _only(names: Iterable[str], kind: str, known: Iterable[str]) -> None:
    for name in names:
        if name not in tuple(known):
            raise unknown_name(kind, name, known)


def _list(value: Any, name: str) -> Any:
    if not isinstance(value, (list, tuple)):
        raise BadInput(f"{name} must be a list of tables in braces, not {str(value)[:40]!r}.")
    return value


def _table(value: Any, name: str, known: tuple[str, ...]) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise BadInput(f"an entry of {name} must be a table in braces, not {str(value)[:40]!r}.")
    _only(value, f"name in {name}", known)
    return value


def _bead(entry: Any, name: str) -> dict[str, Any]:
    values = _table(entry, name, _BEAD)
    for needed in _BEAD:
        if needed not in values:
            raise BadInput(f"a bead of {name} has no {needed}; it needs {', '.join(_BEAD)}.")
    return values


def _site(entry: dict[str, Any], name: str) -> int:
    """Return the number of an entry's bead, `site` as in the knobs; `place` is its name in older files."""
    if all(name in entry for name in _SITE):
        raise BadInput(f"an entry of {name} has site and place, which mean the same; give one of them.")
    site = entry.get("site", entry.get("place"))
    if not isinstance(site, int) or isinstance(site, bool) or site < 1:
        raise BadInput(f"an entry of {name} needs site, the number of a bead from 1 on, not {str(site)[:40]!r}.")
    return site


def _impurity(entry: Any, beads: list[dict[str, Any]]) -> list[Any]:
    """Return site and bead; values that the entry does not give are those of the pattern's bead at that site."""
    values = _table(entry, "impurities", (*_SITE, *_BEAD))
    site = _site(values, "impurities")
    own = {name: value for name, value in values.items() if name not in _SITE}
    return [site, {**beads[(site - 1) % len(beads)], **own}] if beads else [site, own]


def _start(entry: Any) -> list[Any]:
    values = _table(entry, "start_velocity", (*_SITE, "velocity"))
    if "velocity" not in values:
        raise BadInput("an entry of start_velocity has no velocity [m/s].")
    return [_site(values, "start_velocity"), values["velocity"]]


def _range(knob: str, ends: Any) -> list[Any]:
    numbers = isinstance(ends, list) and len(ends) == 2 and all(
        isinstance(end, (int, float)) and not isinstance(end, bool) for end in ends)
    if not numbers or not ends[0] < ends[1]:
        raise BadInput(f"the range of {knob} must be two ascending numbers, not {str(ends)[:40]!r}.")
    return [knob, *ends]
