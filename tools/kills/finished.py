"""The pieces that a killed command has finished, read from its files without continuing the computation."""

from __future__ import annotations

import hashlib
import io
import json
from collections.abc import Callable, Hashable, Iterator
from pathlib import Path

import h5py
import numpy as np

#: Attributes in the root of a result that differ between two computations of the same result.
_TIMES = {"created", "wall_s", "cost"}


def finished_in(name: str, out: Path) -> set[Hashable]:
    """Return the names of the finished pieces, those in the blocks and those of the result if it exists."""
    pieces = {piece for content in _blocks(Path(f"{out}.blocks")) for piece in _PIECES[name](content)}
    if out.exists():
        with h5py.File(out, "r") as file:
            pieces |= set(_IN_FILE[name](file))
    return pieces


def _blocks(folder: Path) -> Iterator[bytes]:
    for path in sorted(folder.glob("*.block")):
        stored = path.read_bytes()
        if hashlib.sha256(stored[32:]).digest() == stored[:32]:
            yield stored[32:]


def _periods(content: bytes) -> Iterator[Hashable]:
    with np.load(io.BytesIO(content)) as there:
        for name in there.files:
            if name.endswith(" done"):
                yield from ((name, done) for done in range(int(there[name])))


def _orbits(content: bytes) -> Iterator[Hashable]:
    for piece in json.loads(content):
        yield from ((piece["direction"], point["knob"]) for point in piece["points"])


def _orbits_in_file(file: h5py.File) -> Iterator[Hashable]:
    arms = [arm["direction"] for arm in json.loads(file.attrs["branch"])["arms"]]
    for arm, knob in zip(file["branch/arm"][()], file["branch/knob"][()], strict=True):
        yield arms[arm], float(knob)


def _all_periods(file: h5py.File) -> Iterator[Hashable]:
    periods = round(float(file["run/time"][0]) * float(file.attrs["knob_f"]))
    for computation in range(1, 10):  # more than a run has; a finished run has them all
        yield from ((f"{computation} done", done) for done in range(periods))


_PIECES: dict[str, Callable[[bytes], Iterator[Hashable]]] = {
    "run": _periods,
    "curve": lambda content: (point["frequency"] for point in json.loads(content)),
    "branch": _orbits,
    "map": lambda content: (int(row["number"]) for row in np.load(io.BytesIO(content))),
}
_IN_FILE: dict[str, Callable[[h5py.File], Iterator[Hashable]]] = {
    "run": _all_periods,
    "curve": lambda file: (float(f) for f in file["curve/frequency"][()]),
    "branch": _orbits_in_file,
    "map": lambda file: iter(range(file["map/regime"].size)),
}


def differing(whole: Path, out: Path) -> str:
    """Say where a result differs, bit by bit, from that of the undisturbed command; return "" if it does not."""
    with h5py.File(whole, "r") as one, h5py.File(out, "r") as other:
        found = [key for key in one.attrs if key not in _TIMES and repr(one.attrs[key]) != repr(other.attrs.get(key))]

        def compare(path: str, item: object) -> None:
            if isinstance(item, h5py.Dataset) and not _same(item, other[path]):
                found.append(path)

        one.visititems(compare)
    return ", ".join(found)


def _same(one: h5py.Dataset, other: h5py.Dataset) -> bool:
    mine, its = np.asarray(one[()]), np.asarray(other[()])
    if mine.dtype == object:
        return bool((mine == its).all())
    return mine.dtype == its.dtype and mine.tobytes() == its.tobytes()
