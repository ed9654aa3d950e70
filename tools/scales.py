"""The largest forces, energy and motion of every scene over its range of f, which scale the dashboard's pictures.

Every scene of `assets/scenes` is settled from rest at POINTS equally spaced frequencies of its slider, with the knobs
of its preset, and at further frequencies around each at which a value is largest, since a peak is between two points.
The largest values of all become its table in `assets/scales.toml`, along with a digest of the preset. `python -m
tools.update` does this for scenes that are new or changed. To compute some again, or without names all:

    python -m tools.scales NAME …
"""

from __future__ import annotations

import functools
import hashlib
import json
import sys
import tomllib
from dataclasses import MISSING, fields
from pathlib import Path

import numpy as np

from app.dashboard.scales import DIGEST, FILE
from app.frames import Extremes, samples_for, settled_frames
from app.session.scene_facts import slider_range
from granchain_core import Scene, scene, scene_names, settle

#: Number of frequencies over the range of f, and around each frequency at which a value is largest.
POINTS = 150
AROUND = 8
#: Fields of a scene that do not affect the values; f takes all values of its range, which is part of the digest.
_NO_PHYSICS = ("name", "title", "look_at", "paper", "ranges", "preset", "f")

_HEAD = """\
# The largest values of every scene over its range of f, from rest, at the knobs of its preset, in SI units
# (N, N, J, m, m, N, N), and a digest of that preset. Written by `python -m tools.scales`; do not edit.
"""


def over_frequencies(chain: Scene, points: int = POINTS) -> Extremes:
    """Return the largest values of a scene's settled pictures over its range of f."""
    grid = np.linspace(*slider_range(chain, "f"), points)
    coarse = [_at(chain, float(frequency)) for frequency in grid]
    found = functools.reduce(Extremes.widened, coarse)
    peaks = {max(range(points), key=lambda i: getattr(coarse[i], name)) for name, value in found.items() if value > 0.0}
    for i in sorted(peaks):
        for frequency in np.linspace(grid[max(i - 1, 0)], grid[min(i + 1, points - 1)], AROUND):
            found = found.widened(_at(chain, float(frequency)))
    return found


def digest_of(chain: Scene, with_f: bool = False) -> str:
    """Return a digest of what determines a scene's largest values: its physics and, unless `with_f`, its range of f.

    `with_f` includes the scene's own f instead. A field at its default is left out, so that a new effect, which is
    absent by default, changes no digest.
    """
    defaults = {field.name: field.default for field in fields(chain) if field.default is not MISSING}
    physics = {name: value for name, value in chain.to_json().items()
               if name not in _NO_PHYSICS and (name not in defaults or value != defaults[name])}
    text = json.dumps([physics, chain.f if with_f else slider_range(chain, "f")], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def table(name: str, digest: str, values: dict[str, float]) -> str:
    """Return a scene's table in the file."""
    lines = (f"{field} = {value:.3g}" for field, value in values.items())
    return "\n".join((f"[{name}]", f'{DIGEST} = "{digest}"', *lines)) + "\n"


def _at(chain: Scene, frequency: float) -> Extremes:
    at = chain.evolve(f=frequency)
    return settled_frames(settle(at, samples=samples_for(at)).run).extremes


def changed() -> list[str]:
    """Return the scenes without a table, and those whose table is of an earlier preset."""
    tables = tomllib.loads(Path(FILE).read_text(encoding="utf-8"))
    return [name for name in scene_names() if tables.get(name, {}).get(DIGEST) != digest_of(scene(name))]


def main(chosen: list[str]) -> None:
    """Write `assets/scales.toml`: compute the named scenes, or all, and keep the other tables."""
    old = tomllib.loads(Path(FILE).read_text(encoding="utf-8"))
    tables = [_HEAD]
    for name in scene_names():
        keep = chosen and name not in chosen
        if keep:
            values = dict(old[name])
            digest = values.pop(DIGEST)
        else:
            values, digest = dict(over_frequencies(scene(name)).items()), digest_of(scene(name))
        tables.append(table(name, digest, values))
        if not keep:
            print(tables[-1])
    Path(FILE).write_text("\n".join(tables), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
