"""Checked access to a file: values of the right kind, arrays of the right shape, and a sentence for every error."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import BadInput
from ..scene import Scene
from .child import Child
from .plain import Plain, Refused, Stored, described
from .seal import is_sealed

#: Version of the layout of granchain's files.
SCHEMA = 1
#: Exceptions of h5py, HDF5, json and NumPy for damaged bytes. RuntimeError includes
#: RecursionError, ArithmeticError OverflowError, LookupError KeyError and IndexError.
_LIBRARIES = (OSError, RuntimeError, ArithmeticError, LookupError, ValueError, TypeError, AttributeError, MemoryError,
              AssertionError, EOFError)


class File:
    """An open file; every method raises `Refused` or `BadInput` where the file does not hold what is asked for."""

    def __init__(self, source: Plain | Child) -> None:
        self._source = source
        self._units: dict[str, str] = {}

    def expect_units(self, units: Mapping[str, str]) -> None:
        """Units by path: from now on `numbers` refuses a dataset that states another one."""
        self._units.update(units)

    def has(self, path: str) -> bool:
        """Whether there is a dataset."""
        return self._source.stored(path) is not None

    def names(self) -> list[str]:
        """The paths of all datasets that stand in the file itself."""
        return self._source.names()

    def described(self, path: str) -> Stored:
        """The type, shape and unit of a dataset that has to be there."""
        return self._stored(path)

    def shape(self, path: str) -> tuple[int, ...]:
        """The shape of a dataset that has to be there."""
        return self._stored(path).shape

    def numbers(self, path: str, shape: tuple[int, ...], kind: str = "f", rows: int | None = None) -> np.ndarray:
        """Numbers of a shape, checked before they are read: floats of eight bytes ("f"), whole numbers ("i") or both.

        A unit that the file states must be that of `expect_units`, if there is one for this path. With `rows`, only
        the first `rows` are read.
        """
        stored = self._stored(path)
        if stored.shape != shape:
            raise Refused(f"/{path} has shape {stored.shape}, expected {shape}")
        kinds = {"f": "f", "i": "iu"}.get(kind, "fiu")
        if stored.type == "text" or np.dtype(stored.type).kind not in kinds or (kind == "f" and stored.type[-1] != "8"):
            raise Refused(f"/{path} holds {stored.type}, expected {'whole numbers' if kind == 'i' else 'numbers'}")
        if stored.units is not None and stored.units != self._units.get(path, stored.units):
            raise Refused(f"/{path} is in {stored.units[:40]!r}, expected {self._units[path]!r}")
        values = self._source.numbers(path, rows)
        return values.astype({"i": np.int64}.get(kind, np.float64), copy=False)

    def words(self, path: str, count: int, known: tuple[str, ...]) -> list[str]:
        """One row of words, each one of `known`."""
        if self._stored(path).shape != (count,):
            raise Refused(f"/{path} has shape {self._stored(path).shape}, expected {(count,)}")
        return [one_of(f"/{path}", word, known) for word in self._source.words(path)]

    def text(self, name: str) -> str:
        """An attribute of the root that is a text."""
        value = self._attribute("", name)
        if not isinstance(value, str):
            raise Refused(f"attribute {name} is {value!r}, not a text")
        return value

    def number(self, name: str, absent: float | None = None) -> float:
        """An attribute of the root that is a number, or `absent` where there is none; NaN is one."""
        value = absent if absent is not None and not self.stated(name) else self._attribute("", name)
        if isinstance(value, str) or value is None:
            raise Refused(f"attribute {name} is {str(value)[:40]!r}, not a number")
        return float(value)

    def whole(self, name: str, low: int, path: str = "") -> int:
        """An attribute that is a whole number, not below `low`."""
        value = self._attribute(path, name)
        if not isinstance(value, int) or value < low:
            raise Refused(f"attribute {name} is {str(value)[:40]!r}, not a whole number from {low}")
        return value

    def json(self, name: str) -> Any:
        """An attribute of the root that is JSON."""
        text = self.text(name)
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as problem:
            raise Refused(f"attribute {name} is not JSON: {described(problem)}") from None

    def schema(self) -> None:
        """Refuse a layout that is not this version's."""
        number = self.whole("granchain_schema", 0)
        if number != SCHEMA:
            raise Refused(f"its schema is {number}, and this version reads {SCHEMA}")

    def scene(self) -> Scene:
        """The scene, its values checked like those of the command line and against the knobs that the file repeats."""
        scene = Scene.from_json(self.json("scene"))
        for name, value in scene.knobs.items():
            repeated = self._source.attribute("", f"knob_{name}")
            if name != "kappa" and repeated not in (None, value):  # kappa follows from k
                raise Refused(f"its scene has {name} = {value!r} and its attribute knob_{name} is {repeated!r:.60}")
        return scene

    def stated(self, name: str) -> bool:
        """Whether the root has an attribute."""
        return self._source.attribute("", name) is not None

    def _attribute(self, path: str, name: str) -> float | int | str:
        value = self._source.attribute(path, name)
        if value is None:
            raise Refused(f"there is no attribute {name}")
        return value

    def _stored(self, path: str) -> Stored:
        stored = self._source.stored(path)
        if stored is None:
            raise Refused(f"there is no /{path}")
        return stored


@contextlib.contextmanager
def opened(path: str | Path, fault: str, *, called: str = "", foreign: bool = False) -> Iterator[File]:
    """Open the file at `path`; every error becomes a `BadInput`: what it is `called` (its path if not
    given), then `fault`, then the reason.

    A file whose seal fits is what granchain wrote, and is read here. One of an earlier version has no seal: HDF5
    parses it in a child, because a single damaged bit can keep HDF5 busy for ever or end its process. A file that may
    be anybody's (`foreign`) needs no seal and is parsed in a child even with one, which anybody can forge.
    """
    source: Plain | Child | None = None
    try:
        sealed = is_sealed(Path(path), required=not foreign)
        source = Plain(str(path)) if sealed and not foreign else Child(str(path))
        yield File(source)
    except _LIBRARIES as problem:  # Refused and BadInput are ValueErrors
        cause = str(problem) if isinstance(problem, BadInput) else reason(problem)
        raise BadInput(f"{called or str(path)[:200]} {fault}: {cause.rstrip('.')}.") from None
    finally:
        if source is not None:
            source.close()


def reason(problem: BaseException) -> str:
    """An error in a few words."""
    if isinstance(problem, OSError) and problem.strerror:
        return problem.strerror
    return str(problem) if isinstance(problem, Refused) else described(problem)


# --- values within JSON and rows ---------------------------------------------------------------------------


def one_of(what: str, value: object, known: tuple[str, ...]) -> str:
    """`value` if it is one of the known words."""
    if not isinstance(value, str) or value not in known:
        raise Refused(f"{what} is {str(value)[:40]!r}, not one of {', '.join(map(repr, known))}")
    return value


def entries(what: str, value: object, kinds: Mapping[str, str]) -> dict[str, Any]:
    """The entries of a JSON object, each of the kind that is named for it.

    A kind is "number", "whole" (from 0), "text" or "flag"; with a "?" at its end null and absence are allowed.
    """
    if not isinstance(value, dict):
        raise Refused(f"{what} is {str(value)[:40]!r}, not an object")
    for name in value:
        if name not in kinds:
            raise Refused(f"{what} has an entry {name[:40]!r}, which is unknown")
    return {name: _entry(f"{what}.{name}", value.get(name), kind) for name, kind in kinds.items()}


_CALLED = {"number": "a number", "whole": "a whole number from 0", "text": "a text", "flag": "true or false"}


def _entry(what: str, value: object, kind: str) -> Any:
    if value is None and kind.endswith("?"):
        return None
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    fits = {"number": number, "whole": number and isinstance(value, int) and value >= 0,
            "text": isinstance(value, str), "flag": isinstance(value, bool)}[kind.rstrip("?")]
    if not fits:
        raise Refused(f"{what} is {str(value)[:40]!r}, not {_CALLED[kind.rstrip('?')]}")
    return value


def finite(what: str, value: float) -> float:
    """`value` if it is a finite number."""
    if not math.isfinite(value):
        raise Refused(f"{what} is {value}, not a finite number")
    return value


def within(what: str, values: np.ndarray, low: int, high: int) -> np.ndarray:
    """Whole numbers of which none is outside a range."""
    if values.size and not (low <= values.min() and values.max() <= high):
        raise Refused(f"{what} holds {values.min()} to {values.max()}, expected {low} to {high}")
    return values
