"""A small picture of every scene for the gallery: its chain, its energy map, and the force on its wall.

Every scene of `assets/scenes` is settled from rest with the knobs of its preset, and drawn on the scale of its own
largest values as `assets/gallery/NAME.svg`, with a digest of the preset. `python -m tools.update` draws scenes that are
new or changed. To draw some again, or without names all:

    python -m tools.gallery NAME …
"""

from __future__ import annotations

import base64
import struct
import sys
import zlib
from collections.abc import Sequence

import numpy as np

from app.dashboard.gallery import FOLDER
from app.frames import Frames, samples_for, settled_frames
from app.plots.energies import ENERGY_COLOURS
from app.plots.theme import THEMES
from granchain_core import Scene, scene, scene_names, settle
from tools.scales import digest_of

#: Rows of an energy map, which browsers do not smooth.
ROWS = 72
#: Colours of an energy map.
COLOURS = 32
#: The edges of the map and of the force next to it, in units of the picture, which is 160 wide and 100 high.
LEFT, RIGHT, TOP, BOTTOM = 12.0, 108.0, 24.0, 97.0
FORCE_FROM, FORCE_TO = 116.0, 157.0
STEEL = "#8a93a6"


def drawn(chain: Scene) -> str:
    """Draw the picture of a scene as SVG."""
    frames = settled_frames(settle(chain, samples=samples_for(chain)).run)
    picture = base64.b64encode(energy_png(frames.kinetic_energy)).decode()
    high = BOTTOM - TOP
    return (f'<svg xmlns="http://www.w3.org/2000/svg" {digest_in(chain)} viewBox="0 0 160 100">{bodies(chain)}'
            f'<image x="{LEFT:g}" y="{TOP:g}" width="{RIGHT - LEFT:g}" height="{high:g}" preserveAspectRatio="none" '
            f'style="image-rendering:pixelated" href="data:image/png;base64,{picture}"/>'
            f'<polyline points="{force_line(frames)}" fill="none" stroke="{THEMES["light"].output}" stroke-width="1.4"/>'
            "</svg>\n")


def bodies(chain: Scene) -> str:
    """Draw driver, beads and wall above the columns of the map."""
    radii = np.array([bead.radius for bead in chain.beads])
    long = RIGHT - LEFT
    sizes = radii * long / (2.0 * radii.sum())
    places = LEFT + np.cumsum(2.0 * sizes) - sizes
    beads = "".join(f'<circle cx="{x:.1f}" cy="11" r="{0.96 * size:.2f}"/>' for x, size in zip(places, sizes, strict=True))
    driver = f'<rect x="6" y="4" width="6" height="14" fill="{THEMES["light"].drive}"/>' if chain.is_driven else ""
    return f'{driver}<g fill="{STEEL}">{beads}<rect x="{RIGHT:g}" y="4" width="2" height="14"/></g>'


def force_line(frames: Frames) -> str:
    """Return the points of the output force over time, which runs downwards; each is the largest of several rows."""
    force = _largest_of(frames.output_force[:, None], 2 * ROWS)[:, 0]
    low, high = min(float(force.min()), 0.0), float(force.max())
    across = FORCE_FROM + (FORCE_TO - FORCE_FROM) * (force - low) / max(high - low, 1e-300)
    down = TOP + (BOTTOM - TOP) * (np.arange(len(force)) + 0.5) / len(force)
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, down, strict=True))


def energy_png(energy: np.ndarray) -> bytes:
    """Return the map of the kinetic energy (T, N) in the page's colours as a PNG, with one pixel per bead."""
    rows = _largest_of(energy, ROWS)
    steps = np.rint((COLOURS - 1) * np.sqrt(rows / rows.max())).astype(np.uint8)
    palette = bytes.fromhex("".join(
        ENERGY_COLOURS[round((len(ENERGY_COLOURS) - 1) * (step / (COLOURS - 1)) ** 2)][1:7] for step in range(COLOURS)))
    height, width = steps.shape
    lines = b"".join(b"\0" + line.tobytes() for line in steps)
    parts = ((b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)), (b"PLTE", palette),
             (b"IDAT", zlib.compress(lines, 9)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts)


def _largest_of(values: np.ndarray, most: int) -> np.ndarray:
    """Return at most `most` rows, each with the largest values of its share of the rows."""
    edges = np.linspace(0, len(values), min(most, len(values)) + 1).round().astype(int)[:-1]
    return np.maximum.reduceat(values, edges, axis=0)


def digest_in(chain: Scene) -> str:
    """Return the attribute of a picture that identifies its preset."""
    return f'data-scene-digest="{digest_of(chain, with_f=True)}"'


def changed() -> list[str]:
    """Return the scenes without a picture, and those whose picture is of an earlier preset."""
    paths = {name: FOLDER / f"{name}.svg" for name in scene_names()}
    return [name for name, path in paths.items()
            if not path.exists() or digest_in(scene(name)) not in path.read_text(encoding="utf-8")]


def main(names: Sequence[str]) -> None:
    """Write the pictures of these scenes, or of all."""
    for name in names or scene_names():
        path = FOLDER / f"{name}.svg"
        path.write_text(drawn(scene(name)), encoding="utf-8")
        print(f"{path}: {path.stat().st_size / 1000:.1f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
