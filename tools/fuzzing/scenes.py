"""Complete scenes drawn log-uniformly over stated ranges; seed and index determine each."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from granchain_core import Scene, scene

from .laws import Structure, with_every_law

#: Decades: f [Hz], A0 [m], D [N s/m], κ, preload [N], accuracy, wall (times K), thrown beads (in A0 φ), bead sizes
#: (times section 2's).
RANGES = {"f": (1.5, 4.0), "A0": (-9.0, -5.0), "D": (-0.5, 3.0), "kappa": (-4.0, -0.5), "F0": (-3.0, 2.0),
          "accuracy": (-9.0, -3.0), "wall": (-1.0, 1.0), "thrown": (-1.0, 1.0), "size": (-0.4, 0.4)}
MOST_BEADS = 40
STRUCTURES = with_every_law([
    ("linear", "allowed", False, False), ("tsuji", "allowed", False, False), ("linear", "cut", False, False),
    ("kuwabara-kono", "allowed", False, False), ("linear", "allowed", True, True), ("none", "allowed", True, False),
    ("tsuji", "cut", True, True)])
#: Fraction of the draws in which one knob gets a value that no scene can have.
_SPOILED = 0.03
_BAD: tuple[Any, ...] = (float("nan"), float("inf"), -1.0, 1e300, "word", None)


@dataclass(frozen=True, eq=False)
class Draw:
    """A draw: knobs for `evolve`, then beads and velocities, and whether a knob was spoiled on purpose."""

    seed: int
    index: int
    knobs: dict[str, Any]
    special: dict[str, Any]
    spoiled: bool

    def scene(self) -> Scene:
        """Return the scene; raise `BadInput` if a knob is spoiled."""
        return replace(scene("sec2").evolve(**self.knobs), **self.special)


def draw(seed: int, index: int, structures: list[Structure]) -> Draw:
    """Return draw number `index`, which depends only on the seed and the structures."""
    rng = np.random.default_rng([seed, index])

    def decade(name: str) -> float:
        return float(10.0 ** rng.uniform(*RANGES[name]))

    law, tension, founded, pressed = structures[rng.integers(len(structures))]
    beads = round(MOST_BEADS ** rng.uniform())
    knobs: dict[str, Any] = {"f": decade("f"), "A0": decade("A0"), "D": decade("D"), "N": beads, "dissipation": law,
                             "tension": tension, "accuracy": decade("accuracy")}
    kinds = ("bead", "same-material", "rigid", decade("wall"))
    knobs["wall"] = kinds[rng.integers(len(kinds))]
    if founded:
        knobs["kappa"] = decade("kappa")
    if pressed:
        knobs["F0"] = decade("F0")
    base = scene("sec2").evolve(**knobs)
    special = _special(rng, base, decade)
    spoiled = bool(rng.random() < _SPOILED)
    if spoiled:
        knobs[str(rng.choice(list(knobs)))] = _BAD[rng.integers(len(_BAD))]
    return Draw(seed, index, knobs, special, spoiled)


def _special(rng: np.random.Generator, base: Scene, decade: Any) -> dict[str, Any]:
    """Draw a dimer, an impurity and thrown beads, each for some scenes, as fields of a scene."""
    found: dict[str, Any] = {}
    bead = base.bead(1)

    def other() -> Any:
        size, soft = decade("size"), decade("size")
        return replace(bead, mass=bead.mass * size**3, radius=bead.radius * size, young=bead.young * soft)

    if rng.random() < 0.2:
        found["pattern"] = (bead, other())
    if rng.random() < 0.2:
        found["impurities"] = ((int(rng.integers(1, base.N + 1)), other()),)
    if rng.random() < 0.4:
        unit = base.A0 * np.sqrt(base.K * np.sqrt(base.A0) / bead.mass)
        places = sorted(rng.choice(np.arange(1, base.N + 1), size=min(base.N, int(rng.integers(1, 4))), replace=False))
        found["start_velocity"] = tuple((int(p), float(unit * decade("thrown") * rng.choice([-1.0, 1.0]))) for p in places)
    return found
