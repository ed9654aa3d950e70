"""A program that compares the errors that a curve states for periodic points with the true ones, for random drives, A₀,
D and k.

    python -m tests.numerics.curve_errors --count 1000 [--seed 1]

Points are computed in batches, from rest. The true forces are those of dop853 on the same orbit: the motion is
continued from the point's state until the orbit repeats itself to 1e-9, and then its largest input and output forces
are found.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granchain_core import Scene, scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.scene.laws import LAWS
from granchain_core.steady.batch.jobs_in_batch import batch_results

#: Section 2's chain with each damping law, and the rig.
BASES = (*LAWS, "rig")

#: The orbit must repeat itself to this relative difference within this many periods; otherwise the point is not judged.
REPEATS, PATIENCE = 1e-9, 3000
#: Samples per period of the true force: the top of a force that jumps is then missed by a few 1e-4 of its rise.
FINE = 8192


@dataclass(frozen=True)
class Point:
    """A periodic point: true and stated relative errors of input and output force (2,), scene and period."""

    error: np.ndarray
    stated: np.ndarray
    scene: Scene
    period: int


def random_scene(rng: np.random.Generator, base: str) -> Scene:
    """Return section 2's chain with a damping law, or the rig with random k and D; each base has one structure and one
    N.
    """
    if base in LAWS:
        return scene("sec2").evolve(dissipation=base, f=10.0 ** rng.uniform(2.0, 3.8), A0=10.0 ** rng.uniform(-7.0, -5.5),
                                    D=10.0 ** rng.uniform(1.3, 2.6), kappa=10.0 ** rng.uniform(-4.0, -2.0))
    return scene("rig").evolve(f=rng.uniform(20.0, 120.0), A0=rng.uniform(5e-6, 13e-6), D=rng.uniform(20.0, 150.0),
                               kappa=10.0 ** rng.uniform(-3.3, -2.0))


def true_forces(chosen: Scene, state, period: int) -> np.ndarray | None:
    """Return the largest input and output force (2,), scaled, on the orbit through `state`; None if it never repeats.
    """
    engine = Engine(chosen, MethodSetting("rk4-split", refine=16), 1)
    engine.start(state)
    for _ in range(PATIENCE // (8 * period)):
        strobes, _ = engine.periods(8 * period)
        change = np.abs(strobes[-1] - strobes[-1 - period]).max(axis=1) / np.abs(strobes).max(axis=(0, 2))
        if change.max() < REPEATS:
            exact = Engine(chosen, MethodSetting("dop853", tolerance=1e-11), FINE)
            exact.start(engine.state)
            exact.record(period * FINE)
            return exact.maxima[:2]
    return None


def points(count: int, seed: int, base: str) -> Iterator[Point]:
    """Yield the periodic points among `count` random scenes, with their true errors."""
    rng = np.random.default_rng(seed)
    for r in batch_results((random_scene(rng, base) for _ in range(count)), Stop()):
        if r.regime.name != "periodic" or r.failure or r.undecided:
            continue
        top = true_forces(r.scene, r.state, r.regime.period)
        if top is not None:
            unit = r.scene.K * r.scene.A0**1.5
            yield Point(np.abs(r.maxima[:2] / unit / top - 1.0), r.errors[:2], r.scene, r.regime.period)


def main() -> None:
    """Print how many errors are bounded, and the points where they are not."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    for base in BASES:
        found = list(points(args.count, args.seed, base))
        ratio = np.array([p.error / p.stated for p in found])  # (points, 2)
        print(f"{base}: {len(found)} periodic points of {args.count}, {np.mean(ratio <= 1.0):.2%} bounded; true/stated median "
              f"{np.median(ratio):.2g}, worst {ratio.max():.2g}; stated median {np.median([p.stated for p in found]):.1e}")
        for p in found:
            if (p.error > p.stated).any():
                s = p.scene
                print(f"  true {p.error} stated {p.stated} period {p.period}: f={s.f!r} A0={s.A0!r} D={s.D!r} k={s.k!r}")


if __name__ == "__main__":
    main()
