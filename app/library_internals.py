"""Undocumented parts of libraries that the dashboard uses, checked at startup.

Each module that uses any of them has a table `INTERNALS`, made by `internals`. `python -m tools.update` writes the
tables into docs/libraries.md.
"""

from __future__ import annotations

import dis
import importlib
import inspect
import logging
import re
from collections.abc import Iterable, Iterator
from functools import cache
from types import CodeType
from typing import Any, NamedTuple

log = logging.getLogger("granchain")

#: The libraries of the tables.
LIBRARIES = ("bokeh", "panel", "param", "tornado")
#: The tables of the modules that have been imported.
_TABLES: dict[str, tuple[Internal, ...]] = {}


class Internal(NamedTuple):
    """Names that a library does not document, and what is lost if a release lacks one of them.

    `owner` is the dotted name of the module, class or method that has them: attributes of the class or of its
    instances, or keyword arguments of the method. Without them the page still works and keeps the promises of
    docs/security.md; `without` says what is lost.
    """

    owner: str
    names: tuple[str, ...]
    without: str


class MissingPart(RuntimeError):
    """The installed release of a library lacks something that the server needs to start; the text is a sentence."""

    def __init__(self, name: str, without: str = "") -> None:
        library = name.partition(".")[0].capitalize()
        super().__init__(f"This release of {library} has no {name}; granchain does not start without it"
                         f"{f' ({without})' if without else ''}. The releases that work are in pyproject.toml.")


def internals(module: str, *rows: Internal) -> tuple[Internal, ...]:
    """Register and return the table of a module; at startup, the tables of all imported modules are checked."""
    _TABLES[module] = rows
    return rows


def tables() -> dict[str, tuple[Internal, ...]]:
    """Return the table of each imported module that has one, by module name."""
    return dict(sorted(_TABLES.items()))


def check_releases() -> None:
    """Log what the installed releases lack, one line per row."""
    for row, name in (missed for table in tables().values() for missed in missing(table)):
        log.warning("a library has no %s: %s", name, row.without)


def missing_in_import(problem: ImportError) -> MissingPart | None:
    """Return a failed import as an error with a sentence; None if the import was not from a library of the tables."""
    if (problem.name or "").partition(".")[0] not in LIBRARIES:
        return None
    name = re.search(r"cannot import name '(\w+)'", str(problem))
    return MissingPart(f"{problem.name}.{name[1]}" if name else str(problem.name))


def missing(table: Iterable[Internal]) -> list[tuple[Internal, str]]:
    """Return the rows for which the installed release lacks a name, with the first dotted name that it lacks."""
    first_missing = ((row, next(_missing(row), None)) for row in table)
    return [(row, name) for row, name in first_missing if name is not None]


def _missing(row: Internal) -> Iterator[str]:
    owner = _find(row.owner)
    if owner is None:
        yield from (f"{row.owner}.{name}" for name in row.names)
        return
    others = _attributes(owner) if isinstance(owner, type) else _keywords(owner) if callable(owner) else ()
    yield from (f"{row.owner}.{name}" for name in row.names if name not in others and not hasattr(owner, name))


def _find(path: str) -> Any:
    """Return the module, or object in a module, that a dotted name refers to; None if there is none."""
    parts = path.split(".")
    for length in range(len(parts), 0, -1):
        try:
            value: Any = importlib.import_module(".".join(parts[:length]))
        except ImportError:
            continue
        for name in parts[length:]:
            value = getattr(value, name, None)
        return value
    return None


@cache
def _attributes(owner: type) -> frozenset[str]:
    """Return the instance attributes of a class that are not class attributes, as far as its code shows them."""
    names: set[str] = set()
    for base in owner.__mro__:
        names.update(vars(base).get("__annotations__", ()))
        for method in vars(base).values():
            function = getattr(method, "__func__", method)  # of a class method
            names.update(_set_by(getattr(function, "__code__", None)))
    return frozenset(names)


def _set_by(code: CodeType | None) -> Iterator[str]:
    """Yield the attributes that a method sets, with a dot or with `setattr`."""
    if code is not None:
        yield from (step.argval for step in dis.get_instructions(code) if step.opname == "STORE_ATTR")
        if "setattr" in code.co_names:
            yield from (value for value in code.co_consts if isinstance(value, str))


def _keywords(function: Any) -> tuple[str, ...]:
    return tuple(inspect.signature(function).parameters)
