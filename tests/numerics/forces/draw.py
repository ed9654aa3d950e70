"""Random scenes for tests of the largest forces: all laws, from weak damping to overdamping, with drives from quiet to
loud and from slow to fast.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from granchain_core import Scene, scene
from tools.fuzzing.laws import with_every_law

STRUCTURES = with_every_law([
    ("linear", "allowed", False, False), ("tsuji", "allowed", False, False), ("linear", "cut", False, False),
    ("kuwabara-kono", "allowed", False, False), ("none", "allowed", False, False), ("linear", "allowed", True, False),
    ("linear", "allowed", False, True), ("tsuji", "cut", True, True), ("kuwabara-kono", "cut", False, False),
    ("kuwabara-kono", "allowed", True, True),
])
#: The structures that the test suite has time to compile.
FEW = STRUCTURES[:3]
#: Powers of ten, from and to: f [Hz], A0 [m], λ = D/(mφ), κ, preload [N], speed of a thrown bead [A0 φ].
RANGES = {"f": (0.0, 3.7), "A0": (-9.0, -5.0), "lambda": (-2.3, 0.7), "kappa": (-4.0, -1.0), "F0": (-2.0, 1.3), "thrown": (-1.0, 0.5)}
ACCURACIES = (1e-4, 1e-6, 1e-8)
MOST_BEADS, MOST_PERIODS, MOST_RECORDED = 40, 20, 3
#: A run of several periods lasts at most this many times 1/φ: its reference takes a hundred thousand steps.
LONGEST = 1e4
_WALLS = ("bead", "same-material", "rigid")


@dataclass(frozen=True)
class Draw:
    """A scene, and the periods of a run that are discarded and recorded."""

    index: int
    scene: Scene
    periods: int
    record: int


def draw(seed: int, index: int, structures: list, longest: float = LONGEST) -> Draw:
    """Return draw number `index` of a whole motion, which is always the same for the same arguments. A motion of
    several periods lasts at most `longest`.
    """
    rng = np.random.default_rng([seed, index])
    law, tension, founded, pressed = structures[rng.integers(len(structures))]
    chosen = scene("sec2").evolve(A0=_decade(rng, "A0"))
    chosen = chosen.evolve(
        f=_decade(rng, "f"), D=_damping(chosen, _decade(rng, "lambda")), N=round(MOST_BEADS ** rng.uniform()), wall=str(rng.choice(_WALLS)),
        dissipation=law, tension=tension, accuracy=float(rng.choice(ACCURACIES)),
        **({"kappa": _decade(rng, "kappa")} if founded else {}), **({"F0": _decade(rng, "F0")} if pressed else {}))
    if rng.random() < 0.3:
        speed = _rate(chosen) * chosen.A0 * _decade(rng, "thrown") * rng.choice([-1.0, 1.0])
        chosen = replace(chosen, start_velocity=((int(rng.integers(1, chosen.N + 1)), float(speed)),))
    periods, recorded = int(rng.integers(0, MOST_PERIODS + 1)), int(rng.integers(1, MOST_RECORDED + 1))
    return Draw(index, chosen, *_shortened(chosen, periods, recorded, longest))


def draw_steady(seed: int, index: int, structures: list) -> Scene:
    """Return a chain for a curve or a map of steady states: section 2's or the rig's, with D up to 400 N s/m and
    frequencies in the usual range of that scene.
    """
    rng = np.random.default_rng([seed, index, 1])
    law, tension, founded, pressed = structures[rng.integers(len(structures))]
    rig = rng.random() < 0.3
    chosen = scene("rig" if rig else "sec2").evolve(
        f=float(rng.uniform(20.0, 160.0) if rig else 10.0 ** rng.uniform(1.5, 3.5)), D=float(10.0 ** rng.uniform(1.3, np.log10(400.0))),
        A0=float(10.0 ** (rng.uniform(-5.5, -5.0) if rig else rng.uniform(-8.0, -5.5))), N=int(rng.integers(1, 21)),
        wall=str(rng.choice(_WALLS)), dissipation=law, tension=tension, accuracy=float(rng.choice(ACCURACIES)))
    kappa = _decade(rng, "kappa") if founded else 0.001 if rig else 0.0
    return chosen.evolve(kappa=kappa, **({"F0": _decade(rng, "F0")} if pressed else {}))


def _shortened(chosen: Scene, periods: int, record: int, longest: float) -> tuple[int, int]:
    """Return the numbers of discarded and recorded periods that fit into the longest time; at least one is recorded."""
    most = max(1, int(longest * chosen.f / _rate(chosen)))
    record = min(record, most)
    return min(periods, most - record), record


def _decade(rng: np.random.Generator, name: str) -> float:
    return float(10.0 ** rng.uniform(*RANGES[name]))


def _rate(chosen: Scene) -> float:
    """Return φ [1/s]."""
    return float(np.sqrt(chosen.K * np.sqrt(chosen.A0) / chosen.bead(1).mass))


def _damping(chosen: Scene, strength: float) -> float:
    return float(strength * chosen.bead(1).mass * _rate(chosen))


def strength(chosen: Scene) -> float:
    """Return λ = D/(mφ)."""
    return float(chosen.D / (chosen.bead(1).mass * _rate(chosen)))
