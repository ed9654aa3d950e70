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
    """An open file; every method raises `Refused` or `BadInput` if the file does not contain what is requested."""

    def __init__(self, source: Plain | Child) -> None:
        self._source = source
        self._units: dict[str, str] = {}

    def expect_units(self, units: Mapping[str, str]) -> None:
        """Set the units by path: from now on, `numbers` refuses a dataset that states a different unit."""
        self._units.update(units)

    def has(self, path: str) -> bool:
        """Return whether a dataset exists."""
        return self._source.stored(path) is not None

    def names(self) -> list[str]:
        """Return the paths of all datasets stored in the file itself."""
        return self._source.names()

    def described(self, path: str) -> Stored:
        """Return the type, shape and unit of a required dataset."""
        return self._stored(path)

    def shape(self, path: str) -> tuple[int, ...]:
        """Return the shape of a required dataset."""
        return self._stored(path).shape

    def numbers(self, path: str, shape: tuple[int, ...], kind: str = "f", rows: int | None = None) -> np.ndarray:
        """Read numbers of a given shape, checked first: eight-byte floats ("f"), integers ("i") or both.

        A unit stated in the file must agree with `expect_units`, if that has one for this path. With `rows`, only that
        many of the dataset's rows are read.
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
        """Read one row of words, each of which must be in `known`."""
        if self._stored(path).shape != (count,):
            raise Refused(f"/{path} has shape {self._stored(path).shape}, expected {(count,)}")
        return [one_of(f"/{path}", word, known) for word in self._source.words(path)]

    def text(self, name: str) -> str:
        """Read a text attribute of the root."""
        value = self._attribute("", name)
        if not isinstance(value, str):
            raise Refused(f"attribute {name} is {value!r}, not a text")
        return value

    def number(self, name: str, absent: float | None = None) -> float:
        """Read a numeric attribute of the root (NaN is allowed), or return `absent` if it is missing."""
        value = absent if absent is not None and not self.stated(name) else self._attribute("", name)
        if isinstance(value, str) or value is None:
            raise Refused(f"attribute {name} is {str(value)[:40]!r}, not a number")
        return float(value)

    def whole(self, name: str, low: int, path: str = "") -> int:
        """Read an integer attribute that is not below `low`."""
        value = self._attribute(path, name)
        if not isinstance(value, int) or value < low:
            raise Refused(f"attribute {name} is {str(value)[:40]!r}, not a whole number from {low}")
        return value

    def json(self, name: str) -> Any:
        """Read a JSON attribute of the root."""
        text = self.text(name)
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as problem:
            raise Refused(f"attribute {name} is not JSON: {described(problem)}") from None

    def schema(self) -> None:
        """Refuse a file whose layout is of another version."""
        number = self.whole("granchain_schema", 0)
        if number != SCHEMA:
            raise Refused(f"its schema is {number}, and this version reads {SCHEMA}")

    def scene(self) -> Scene:
        """Read the scene; check its values like the command line's, and against the knobs that the file repeats."""
        scene = Scene.from_json(self.json("scene"))
        for name, value in scene.knobs.items():
            repeated = self._source.attribute("", f"knob_{name}")
            if name != "kappa" and repeated not in (None, value):  # kappa follows from k
                raise Refused(f"its scene has {name} = {value!r} and its attribute knob_{name} is {repeated!r:.60}")
        return scene

    def stated(self, name: str) -> bool:
        """Return whether the root has an attribute."""
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
    """Open the file at `path`; every error becomes a `BadInput` with `called` (or the path), `fault` and the reason.

    A file with a valid seal is unchanged since granchain wrote it, and is read in this process. A file of an earlier
    version has no seal and is parsed in a child process, because a single damaged bit can hang or crash HDF5. A file of
    unknown origin (`foreign`) needs no seal, and is always parsed in a child process because anyone can forge a seal.
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
    """Describe an error in a few words."""
    if isinstance(problem, OSError) and problem.strerror:
        return problem.strerror
    return str(problem) if isinstance(problem, Refused) else described(problem)


# --- values within JSON and rows ---------------------------------------------------------------------------


def one_of(what: str, value: object, known: tuple[str, ...]) -> str:
    """Return `value` if it is one of the known words."""
    if not isinstance(value, str) or value not in known:
        raise Refused(f"{what} is {str(value)[:40]!r}, not one of {', '.join(map(repr, known))}")
    return value


def entries(what: str, value: object, kinds: Mapping[str, str]) -> dict[str, Any]:
    """Return the entries of a JSON object, each checked to be of the kind given in `kinds`.

    A kind is "number", "whole" (from 0), "text" or "flag"; a trailing "?" allows null and absence.
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
    """Return `value` if it is finite."""
    if not math.isfinite(value):
        raise Refused(f"{what} is {value}, not a finite number")
    return value


def within(what: str, values: np.ndarray, low: int, high: int) -> np.ndarray:
    """Return integers, none of which may be outside a range."""
    if values.size and not (low <= values.min() and values.max() <= high):
        raise Refused(f"{what} holds {values.min()} to {values.max()}, expected {low} to {high}")
    return values
