"""The largest forces, energy and motion of every scene over its range of f: what the dashboard draws its pictures to.

Every scene of `assets/scenes` is settled from rest at POINTS equally spaced frequencies of its slider, with the knobs
of its preset, and at some more around each where a value is largest: a peak lies between them. The largest values over
all become its table in `assets/scales.toml`. Run it when a scene is new or changed; without names all scenes are
computed again:

    python -m tools.scales NAME …
"""

from __future__ import annotations

import functools
import sys
import tomllib
from pathlib import Path

import numpy as np

from app.dashboard.scales import FILE
from app.frames import Extremes, samples_for, settled_frames
from app.session.session import slider_range
from granchain_core import Scene, scene, scene_names, settle

POINTS, AROUND = 150, 8

_HEAD = """\
# The largest values of every scene over its range of f, from rest, at the knobs of its preset, in SI units
# (N, N, J, m, m). Written by `python -m tools.scales`; do not edit.
"""


def over_frequencies(chain: Scene, points: int = POINTS) -> Extremes:
    """The largest values of a scene's settled pictures over its range of f."""
    grid = np.linspace(*slider_range(chain, "f"), points)
    coarse = [_at(chain, float(frequency)) for frequency in grid]
    found = functools.reduce(Extremes.widened, coarse)
    peaks = {max(range(points), key=lambda i: getattr(coarse[i], name)) for name, value in found.items() if value > 0.0}
    for i in sorted(peaks):
        for frequency in np.linspace(grid[max(i - 1, 0)], grid[min(i + 1, points - 1)], AROUND):
            found = found.widened(_at(chain, float(frequency)))
    return found


def _at(chain: Scene, frequency: float) -> Extremes:
    at = chain.evolve(f=frequency)
    return settled_frames(settle(at, samples=samples_for(at)).run).extremes


def main(chosen: list[str]) -> None:
    """Write `assets/scales.toml`: the scenes named afresh, or all, and the others as they are."""
    old = tomllib.loads(Path(FILE).read_text(encoding="utf-8"))
    tables = [_HEAD]
    for name in scene_names():
        keep = chosen and name not in chosen
        values = old[name].items() if keep else over_frequencies(scene(name)).items()
        tables.append("\n".join((f"[{name}]", *(f"{field} = {value:.3g}" for field, value in values))) + "\n")
        if not keep:
            print(tables[-1])
    Path(FILE).write_text("\n".join(tables), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
