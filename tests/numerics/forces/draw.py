"""Random scenes for the largest forces: all laws, from hardly damped to overdamped, from quiet to loud, slow to fast.
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
#: Those that the test suite has time to compile.
FEW = STRUCTURES[:3]
#: Decades: f [Hz], A0 [m], λ = D/(mφ), κ, preload [N], thrown beads (in A0 φ).
RANGES = {"f": (0.0, 3.7), "A0": (-9.0, -5.0), "lambda": (-2.3, 0.7), "kappa": (-4.0, -1.0), "F0": (-2.0, 1.3), "thrown": (-1.0, 0.5)}
ACCURACIES = (1e-4, 1e-6, 1e-8)
MOST_BEADS, MOST_PERIODS, MOST_RECORDED = 40, 20, 3
#: A run of several periods is not longer than so many times 1/φ: its truth takes a hundred thousand steps.
LONGEST = 1e4
_WALLS = ("bead", "same-material", "rigid")


@dataclass(frozen=True)
class Draw:
    """A scene and, for a run, its periods."""

    index: int
    scene: Scene
    periods: int
    record: int


def draw(seed: int, index: int, structures: list, longest: float = LONGEST) -> Draw:
    """Draw number `index` of a whole motion, of several periods only within `longest`: the same for the same words."""
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
    """A chain whose steady states a curve or a map looks for: section 2's or the rig's, D up to 400, f as there."""
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
    """Periods discarded and recorded, at least one of these, within the longest time."""
    most = max(1, int(longest * chosen.f / _rate(chosen)))
    record = min(record, most)
    return min(periods, most - record), record


def _decade(rng: np.random.Generator, name: str) -> float:
    return float(10.0 ** rng.uniform(*RANGES[name]))


def _rate(chosen: Scene) -> float:
    """φ."""
    return float(np.sqrt(chosen.K * np.sqrt(chosen.A0) / chosen.bead(1).mass))


def _damping(chosen: Scene, strength: float) -> float:
    return float(strength * chosen.bead(1).mass * _rate(chosen))


def strength(chosen: Scene) -> float:
    """λ = D/(mφ)."""
    return float(chosen.D / (chosen.bead(1).mass * _rate(chosen)))
