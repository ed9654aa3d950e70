"""The harms done to a file: damage, which changes its bytes, and forgeries, made with h5py and sealed again."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from granchain_core.hdf5 import seal

from .kinds import names_of

#: A number that occurs in no result, for the files that a forged file leads to.
ELSEWHERE = 7.25e77
_BLOCK = 4096


def _flip(content: bytearray, rng: np.random.Generator) -> None:
    content[rng.integers(len(content))] ^= 1 << int(rng.integers(8))


def _cut(content: bytearray, rng: np.random.Generator) -> None:
    del content[rng.integers(len(content)) :]


def _zero(content: bytearray, rng: np.random.Generator) -> None:
    size = int(rng.integers(1, _BLOCK))
    at = int(rng.integers(len(content)))
    content[at : at + size] = bytes(len(content[at : at + size]))


def _exchange(content: bytearray, rng: np.random.Generator) -> None:
    size = int(rng.integers(8, min(_BLOCK, len(content) // 3)))
    one, other = (int(at) for at in sorted(rng.integers(len(content) - size, size=2)))
    content[one : one + size], content[other : other + size] = content[other : other + size], content[one : one + size]


def _grow(content: bytearray, rng: np.random.Generator) -> None:
    content += rng.bytes(int(rng.integers(1, _BLOCK)))


DAMAGE: dict[str, Callable[[bytearray, np.random.Generator], None]] = {
    "one bit flipped": _flip, "cut short": _cut, "a block of zeros": _zero, "two blocks exchanged": _exchange,
    "bytes appended": _grow}


# --- forgeries --------------------------------------------------------------------------------------------


def _replaced(file: h5py.File, name: str, make: Callable[[], Any]) -> None:
    del file[name]
    make()


def _external_link(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    shape, other = file[name].shape, folder / "elsewhere.h5"
    with h5py.File(other, "w") as elsewhere:
        elsewhere["x"] = np.full(shape, ELSEWHERE)
    part = name if rng.integers(2) else name.split("/")[0]
    _replaced(file, part, lambda: file.__setitem__(part, h5py.ExternalLink(str(other), "x" if part == name else "/")))


def _soft_link(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    target = rng.choice([f"/{name}", f"/{name}/..", "/", "/nothing", f"/{rng.choice(_names(file))}"])
    _replaced(file, name, lambda: file.__setitem__(name, h5py.SoftLink(str(target))))


def _external_storage(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    shape, other = file[name].shape, folder / "elsewhere.bin"
    other.write_bytes(np.full(shape, ELSEWHERE).tobytes())
    _replaced(file, name, lambda: file.create_dataset(name, shape, "f8", external=[(str(other), 0, max(8, other.stat().st_size))]))


def _virtual(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    shape, other = file[name].shape, folder / "elsewhere.h5"
    with h5py.File(other, "w") as elsewhere:
        elsewhere["x"] = np.full(shape, ELSEWHERE)
    layout = h5py.VirtualLayout(shape, "f8")
    layout[...] = h5py.VirtualSource(str(other), "x", shape)
    _replaced(file, name, lambda: file.create_virtual_dataset(name, layout))


def _huge(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    size = int(10 ** rng.uniform(6, 17))
    shape = (size, *file[name].shape[1:]) if rng.integers(2) else (size,)
    pieces = {"chunks": True, "compression": "gzip"} if rng.integers(2) and np.prod(shape, dtype=float) < 1e15 else {}
    if np.prod(shape, dtype=float) < 1e18:
        _replaced(file, name, lambda: file.create_dataset(name, shape, "f8", **pieces))


def _another_kind(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    shape = file[name].shape
    choices: list[Callable[[], Any]] = [
        lambda: file.create_dataset(name, shape, h5py.string_dtype()), lambda: file.create_group(name),
        lambda: file.create_dataset(name, data=np.zeros(shape, [("a", "f8"), ("b", "i4")])),
        lambda: file.create_dataset(name, data=np.zeros(shape, complex)), lambda: file.create_dataset(name, data=3.0),
        lambda: file.create_dataset(name, data=h5py.Empty("f8")), lambda: file.create_dataset(name, shape, h5py.ref_dtype),
        lambda: file.create_dataset(name, data=np.zeros((*shape, 2))), lambda: file.create_dataset(name, data=np.zeros((2, 0))),
        lambda: file.create_dataset(name, shape, h5py.vlen_dtype("f8")), lambda: file.__setitem__(name, np.dtype("f8")),
        lambda: file.create_dataset(name, data=np.zeros(shape, "f4")), lambda: None]
    _replaced(file, name, choices[rng.integers(len(choices))])


def _circle(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    _replaced(file, name, lambda: file.__setitem__(name, file["/"] if rng.integers(2) else file[name.split("/")[0]]))


_VALUES: tuple[Callable[[], Any], ...] = (
    lambda: float("nan"), lambda: -1, lambda: 1e300, lambda: "nowall", lambda: "", lambda: np.zeros(3), lambda: "x" * 100_000,
    lambda: np.bytes_(b"\xff\xfe\x80"), lambda: "[" * 30_000, lambda: "{}", lambda: "[]", lambda: "1" * 5000, lambda: 10**18,
    lambda: "null", lambda: h5py.Empty("f8"), lambda: np.array([b"a", b"b"]), lambda: '{"self": 1}')


def _attribute(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    owner = file if rng.random() < 0.8 or not len(file[name].attrs) else file[name]
    attribute = str(rng.choice(list(owner.attrs)))
    del owner.attrs[attribute]
    if rng.random() < 0.9:
        owner.attrs[attribute] = _VALUES[rng.integers(len(_VALUES))]()


def _inner(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    """Replace one value inside the JSON of an attribute."""
    texts = [a for a, value in file.attrs.items() if isinstance(value, str) and value[:1] in "[{"]
    attribute = str(rng.choice(texts))
    text = file.attrs[attribute]
    places = [at for at, sign in enumerate(text) if sign == ":"]
    if places:
        at = int(rng.choice(places)) + 1
        end = min((text.find(sign, at) for sign in ",}]" if text.find(sign, at) > 0), default=len(text))
        bad = ("NaN", "-1", "Infinity", '"x"', "null", "[]", "{}", "true", "1e999", "9" * 4000, '"１"', "")
        file.attrs[attribute] = text[:at] + str(rng.choice(bad)) + text[end:]


def _swap(file: h5py.File, name: str, folder: Path, rng: np.random.Generator) -> None:
    """Exchange the names of two datasets, of the same shape if possible."""
    alike = [other for other in _names(file) if other != name and file[other].shape == file[name].shape]
    other = str(rng.choice(alike or _names(file)))
    if other != name:
        file.move(name, "aside")
        file.move(other, name)
        file.move("aside", other)


def _names(file: h5py.File) -> list[str]:
    return names_of(Path(file.filename))


FORGERIES: dict[str, Callable[[h5py.File, str, Path, np.random.Generator], None]] = {
    "external link": _external_link, "soft link": _soft_link, "external storage": _external_storage, "virtual dataset": _virtual,
    "huge shape": _huge, "another kind or shape": _another_kind, "circle of groups": _circle, "attribute": _attribute,
    "value within JSON": _inner}
#: Forgeries whose numbers would come from elsewhere; the others only state other values, which no reader can detect.
LEADING = ("external link", "soft link", "external storage", "virtual dataset", "huge shape", "circle of groups")
#: Datasets that h5py exchanged, without the file being sealed again.
SWAPPED = "two datasets exchanged"
HARMS = (*DAMAGE, SWAPPED, *FORGERIES)


def harm(source: Path, target: Path, name: str, sealed: bool, rng: np.random.Generator) -> None:
    """Write a harmed copy of a file. A forgery of a sealed file is sealed again, so that it passes the seal."""
    content = bytearray(source.read_bytes())
    if name in DAMAGE:
        DAMAGE[name](content, rng)
        target.write_bytes(content)
        return
    target.write_bytes(content)
    datasets = names_of(source)
    with h5py.File(target, "a") as file:
        (_swap if name == SWAPPED else FORGERIES[name])(file, str(rng.choice(datasets)), target.parent, rng)
    if sealed and name != SWAPPED:
        seal(target)
