"""Reader for the permitted parts of an HDF5 file: numbers and text in this file, each in one contiguous block.

HDF5 can lead a reader elsewhere, by links to other objects and files, numbers in external files, virtual datasets,
filters that are loaded as plug-ins, and shapes of terabytes that were never written. None of these is followed. Every
part of a path is inspected before it is opened, and a size is checked against that of the file before memory is
allocated.

The module imports nothing from granchain, because it is also a program: child.py runs it in a separate process, which
answers requests on its standard output, with one JSON object per line.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import sys
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from typing import Any, BinaryIO

import h5py
import numpy as np
from h5py import h5a, h5d, h5g, h5l, h5o, h5s, h5t

#: Largest attribute [bytes]: a scene of ten thousand different beads has about one million.
_MOST_ATTRIBUTE = 16_000_000
#: Maximum number of words in a dataset.
_MOST_WORDS = 100_000
#: Maximum number of dimensions of a dataset.
_MOST_DIMENSIONS = 3
#: Maximum number of objects listed in a file.
_MOST_OBJECTS = 2000
#: Maximum depth of nested groups.
_DEEPEST = 5
#: Size of the reference to a variable-length string [bytes].
_REFERENCE = 16
_NUMBERS = (h5t.FLOAT, h5t.INTEGER)
#: Memory that a child process may use in addition to its initial memory and three times the size of the file [bytes].
_BESIDE = 256_000_000


class Refused(ValueError):
    """Part of a file that is not followed or not read; the message says which part and why."""


@dataclass(frozen=True)
class Stored:
    """Description of a dataset: NumPy type ("text" for words), shape and, if present, the attribute `units`."""

    type: str
    shape: tuple[int, ...]
    units: str | None = None


class Plain:
    """An open file, read by `attribute`, `stored`, `numbers` and `words`."""

    def __init__(self, path: str) -> None:
        self._size = os.path.getsize(path)
        self._file = h5py.File(path, "r")
        self._stored: dict[str, Stored | None] = {}

    def close(self) -> None:
        """Close the file. A damaged file may fail to close, and is then left open until the process ends."""
        with contextlib.suppress(Exception):
            self._file.close()

    def attribute(self, path: str, name: str) -> float | int | str | None:
        """Return an attribute of the root or of a dataset, which must be one number or text; None if it is absent."""
        item = self._find(path)
        if item is None or not h5a.exists(item, name.encode()):
            return None
        attribute, called = h5a.open(item, name.encode()), f"attribute {name} of /{path}"
        if attribute.get_space().get_simple_extent_type() != h5s.SCALAR:
            raise Refused(f"{called} is not one value")
        if attribute.get_type().get_class() not in (*_NUMBERS, h5t.STRING):
            raise Refused(f"{called} is neither a number nor a text")
        if attribute.get_storage_size() > min(_MOST_ATTRIBUTE, self._size):
            raise Refused(f"{called} has {attribute.get_storage_size()} bytes, more than are read")
        return _value(h5py.AttributeManager(h5py.Group(item) if isinstance(item, h5g.GroupID) else
                                            h5py.Dataset(item))[name], called)

    def stored(self, path: str) -> Stored | None:
        """Return a dataset's type and shape without reading it; None if absent. Raises `Refused` if it is not plain."""
        if path not in self._stored:
            self._stored[path] = self._look(path)
        return self._stored[path]

    def _look(self, path: str) -> Stored | None:
        item = self._find(path)
        if item is None:
            return None
        if not isinstance(item, h5d.DatasetID):
            raise Refused(f"/{path} is not a dataset")
        kind = item.get_type().get_class()
        if kind == h5t.STRING:
            name = "text"
        elif kind in _NUMBERS and item.dtype.kind in "fiu" and item.dtype.itemsize <= 8:
            name = item.dtype.str
        else:
            raise Refused(f"/{path} holds neither numbers nor words")
        shape = self._shape(item, path)
        units = self.attribute(path, "units")
        return Stored(name, shape, None if units is None else str(units))

    def names(self) -> list[str]:
        """Return the paths of all datasets reached by hard links only, in the order of their names."""
        listed = []
        for count, (path, item, depth) in enumerate(_links(h5g.open(self._file.id, b"/")), start=1):
            if count > _MOST_OBJECTS or depth > _DEEPEST:
                raise Refused(f"it has more than {_MOST_OBJECTS} objects, or groups deeper than {_DEEPEST}")
            if isinstance(item, h5d.DatasetID):
                listed.append(path)
        return listed

    def numbers(self, path: str, rows: int | None = None) -> np.ndarray:
        """Return the numbers of a dataset, or of its first `rows` rows, in the stored type."""
        stored = self._described(path)
        if stored.type == "text":
            raise Refused(f"/{path} holds words where numbers are expected")
        data = h5py.Dataset(self._find(path))
        return np.ascontiguousarray(data[()] if rows is None else data[:rows])

    def words(self, path: str) -> list[str]:
        """Return the words of a one-dimensional dataset, read one by one because many may refer to the same text."""
        stored, total, listed = self._described(path), 0, []
        if stored.type != "text" or len(stored.shape) != 1 or stored.shape[0] > _MOST_WORDS:
            raise Refused(f"/{path} is not one row of at most {_MOST_WORDS} words")
        data = h5py.Dataset(self._find(path))
        for place in range(stored.shape[0]):
            listed.append(str(_value(data[place], f"/{path}")))
            total += len(listed[-1])
            if total > self._size:
                raise Refused(f"/{path} holds more text than the file has bytes")
        return listed

    def _described(self, path: str) -> Stored:
        stored = self.stored(path)
        if stored is None:
            raise Refused(f"there is no /{path}")
        return stored

    def _find(self, path: str) -> Any:
        """Return the identifier of an object reached by hard links only; None if a part of the path is absent."""
        here, walked = h5g.open(self._file.id, b"/"), ""
        for part in filter(None, path.split("/")):
            if not isinstance(here, h5g.GroupID):
                raise Refused(f"{walked} is not a group")
            walked += f"/{part}"
            if not here.links.exists(part.encode()):
                return None
            if here.links.get_info(part.encode()).type != h5l.TYPE_HARD:
                raise Refused(f"{walked} is a link, and only data in the file itself are read")
            here = h5o.open(here, part.encode())
        return here

    def _shape(self, dataset: h5d.DatasetID, path: str) -> tuple[int, ...]:
        """Return the shape of a dataset, which must be one block within this file."""
        properties, type_ = dataset.get_create_plist(), dataset.get_type()
        variable = type_.get_class() == h5t.STRING and type_.is_variable_str()
        size = _REFERENCE if variable else type_.get_size()
        if properties.get_external_count():
            raise Refused(f"/{path} is stored in another file, and only data in the file itself are read")
        if properties.get_layout() not in (h5d.CONTIGUOUS, h5d.COMPACT):
            raise Refused(f"/{path} is virtual, compressed or in pieces, and only data in one block of the file "
                          "itself are read")
        if dataset.get_space().get_simple_extent_type() != h5s.SIMPLE or len(dataset.shape) > _MOST_DIMENSIONS:
            raise Refused(f"/{path} is not a row or a table")
        needed = math.prod(dataset.shape) * size  # in Python integers, which do not overflow
        if needed > self._size:
            raise Refused(f"/{path} has shape {dataset.shape}, {needed} bytes in a file of {self._size}")
        if needed and dataset.get_storage_size() != needed:
            raise Refused(f"/{path} has shape {dataset.shape}, of which not everything is stored")
        offset = dataset.get_offset() if properties.get_layout() == h5d.CONTIGUOUS else 0
        if needed and (offset is None or offset + needed > self._size):
            raise Refused(f"/{path} ends beyond the file")
        return tuple(int(n) for n in dataset.shape)


def _links(group: h5g.GroupID, path: str = "", depth: int = 0) -> Iterator[tuple[str, h5o.ObjectID | None, int]]:
    """Yield path, object and depth of each link in a group and its groups; of links that are not hard, no object."""
    for name in group:
        below = f"{path}/{name.decode('utf-8')}".lstrip("/")
        if group.links.get_info(name).type != h5l.TYPE_HARD:
            yield below, None, depth
            continue
        item = h5o.open(group, name)
        yield below, item, depth
        if isinstance(item, h5g.GroupID):
            yield from _links(item, below, depth + 1)


def _value(value: Any, called: str) -> float | int | str:
    """Convert a number or text to a Python value."""
    if isinstance(value, bytes):
        value = value.decode("utf-8")
    if isinstance(value, str):
        value.encode("utf-8")  # HDF5 does not check that a text is valid
        return value
    if isinstance(value, np.integer):
        return int(value)
    if isinstance(value, np.floating):
        return float(value)
    raise Refused(f"{called} is neither a number nor a text")


# --- the same as a program --------------------------------------------------------------------------------


def answer_requests(file: Plain, requests: Iterable[bytes], out: BinaryIO) -> None:
    """Answer each request with one line of JSON, followed by the bytes if numbers were requested."""
    for line in requests:
        name, *args = json.loads(line)
        content: bytes | memoryview = b""
        try:
            value = getattr(file, name)(*args)
            if isinstance(value, np.ndarray):
                content = value.data.cast("B") if value.size else b""
                value = {"type": value.dtype.str, "shape": value.shape}
            elif isinstance(value, Stored):
                value = asdict(value)
            answer = {"found": value}
        except Exception as problem:  # whatever HDF5 raises for damaged bytes; the parent reports it
            answer = {"refused": str(problem) if isinstance(problem, Refused) else described(problem)}
        out.write(json.dumps(answer).encode() + b"\n")
        out.write(content)
        out.flush()


def described(problem: BaseException) -> str:
    """Describe a library's error in a few words."""
    if isinstance(problem, MemoryError):
        return "it asks for more memory than there is"
    if isinstance(problem, RecursionError):
        return "it is nested too deeply"
    return " ".join(str(problem).split())[:200].rstrip(".") or type(problem).__name__


def limit(seconds: int, size: int) -> None:
    """Limit this process's processor time, and its memory to the needs of a file of `size` bytes.

    Systems other than Linux do not report how much memory a process has, so only the time is limited there.
    """
    try:
        import resource
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
    with contextlib.suppress(OSError), open("/proc/self/statm", encoding="ascii") as pages:
        most = int(pages.read().split()[0]) * resource.getpagesize() + _BESIDE + 3 * size
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def main() -> None:
    """Open the file given as an argument, under limits, and answer requests until the parent closes the pipe."""
    path = sys.argv[1]
    limit(int(sys.argv[2]), os.path.getsize(path))
    try:
        file = Plain(path)
    except Exception as problem:  # as above
        sys.stdout.buffer.write(json.dumps({"refused": described(problem)}).encode() + b"\n")
        return
    sys.stdout.buffer.write(b'{"found": null}\n')
    sys.stdout.buffer.flush()
    answer_requests(file, sys.stdin.buffer, sys.stdout.buffer)
    os._exit(0)  # a damaged file may fail to close


if __name__ == "__main__":
    main()
