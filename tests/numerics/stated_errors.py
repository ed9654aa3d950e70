"""A program that compares the error that `run` states with the true one: it prints a table for random scenes, and every
scene whose error is larger than stated.

    python -m tests.numerics.stated_errors --count 1000 [--seed 1] [--few]

Drive, amplitude, damping, foundation, 1 to 20 beads, wall, law, tension, preload, a thrown bead and the requested
accuracy are drawn at random. The reference is dop853 at 3e-15 per step. Its difference from dop853 at 3e-14 is the
uncertainty of the reference, and an error is judged to within three times that.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from granchain_core import ComputationError, Scene, run, scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.scene.state import rest
from tools.fuzzing.laws import with_every_law

PERIODS, SAMPLES = 3, 16
STRUCTURES = with_every_law([
    ("linear", "allowed", False, False), ("tsuji", "allowed", False, False), ("linear", "cut", False, False),
    ("kuwabara-kono", "allowed", False, False), ("none", "allowed", False, False),
    ("linear", "allowed", True, False), ("linear", "allowed", False, True), ("tsuji", "cut", True, True),
    ("kuwabara-kono", "cut", False, False), ("none", "allowed", True, True), ("kuwabara-kono", "allowed", True, True),
    ("tsuji", "allowed", True, True),
])
#: The structures that the test suite has time to compile.
FEW = STRUCTURES[:4]


@dataclass(frozen=True)
class Verdict:
    """A scene with relative errors: true, stated and requested ones, and the uncertainty of the reference."""

    scene: Scene
    error: float
    stated: float
    asked: float
    known: float
    status: str

    @property
    def judged(self) -> bool:
        """Whether the reference is known well enough to judge the stated error."""
        return self.known < 0.3 * self.stated

    @property
    def bounded(self) -> bool:
        """Whether the stated error is above the true one."""
        return self.error <= self.stated + 3.0 * self.known


def random_scene(rng: np.random.Generator, structures: list) -> Scene:
    """Draw a scene."""
    law, tension, founded, pressed = structures[rng.integers(len(structures))]
    chosen = scene("sec2").evolve(
        f=10.0 ** rng.uniform(1.7, 3.5), A0=10.0 ** rng.uniform(-7.5, -5.0), D=10.0 ** rng.uniform(0.5, 2.6),
        N=int(rng.integers(1, 21)), wall=str(rng.choice(["bead", "same-material", "rigid"])), dissipation=law,
        tension=tension, accuracy=10.0 ** rng.uniform(-9.0, -3.0))
    if founded:
        chosen = chosen.evolve(kappa=10.0 ** rng.uniform(-4.0, -1.0))
    if pressed:
        chosen = chosen.evolve(F0=10.0 ** rng.uniform(-2.0, 1.3))
    if rng.random() < 0.4:
        fast = chosen.A0 * np.sqrt(chosen.K * np.sqrt(chosen.A0) / chosen.bead(1).mass)
        thrown = (int(rng.integers(1, chosen.N + 1)), float(fast * rng.uniform(-1.0, 1.0)))
        chosen = replace(chosen, start_velocity=(thrown,))
    return chosen


def reference(chosen: Scene, tolerance: float) -> np.ndarray:
    """Return the displacements (T, N) [m] of dop853."""
    engine = Engine(chosen, MethodSetting("dop853", tolerance=tolerance), SAMPLES, account=True)
    engine.start(rest(chosen))
    return engine.record(PERIODS * SAMPLES).displacement * engine.scaled.scales.length


def judge(chosen: Scene) -> Verdict | None:
    """Judge one scene; None if the computation fails, which `run` reports."""
    try:
        found = run(chosen, periods=0, record=PERIODS, samples=SAMPLES)
        true, nearly = reference(chosen, 3e-15), reference(chosen, 3e-14)
    except ComputationError:
        return None
    largest = np.abs(true).max()
    return Verdict(chosen, float(np.abs(found.displacement - true).max() / largest), found.displacement_error,
                   chosen.accuracy, float(np.abs(true - nearly).max() / largest), found.status)


def verdicts(count: int, seed: int, structures: list) -> Iterator[Verdict | None]:
    """Judge `count` random scenes."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield judge(random_scene(rng, structures))


def main() -> None:
    """Print the table and the failures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--few", action="store_true", help="only the structures of the test suite")
    args = parser.parse_args()
    began = time.perf_counter()
    every = list(verdicts(args.count, args.seed, FEW if args.few else STRUCTURES))
    found = [v for v in every if v is not None]
    print(f"{len(found)} scenes, {len(every) - len(found)} failed and said so, {time.perf_counter() - began:.0f} s")
    print("    asked   scenes  judged  bounded  below what was asked  done  median true/stated  worst")
    for low in range(-9, -3):
        part = [v for v in found if 10.0**low <= v.asked < 10.0 ** (low + 1)]
        sure = [v for v in part if v.judged]
        if sure:
            ratio = np.array([v.error / v.stated for v in sure])
            print(f"1e{low}..1e{low + 1} {len(part):7} {len(sure):7} {np.mean([v.bounded for v in part]):8.1%} "
                  f"{np.mean([v.error <= v.asked for v in sure]):14.1%} "
                  f"{np.mean([v.status == 'done' for v in part]):12.0%} {np.median(ratio):12.2g} {ratio.max():12.2g}")
    print(f"bounded in all: {np.mean([v.bounded for v in found]):.2%}")
    for v in found:
        if not v.bounded:
            s = v.scene
            print(f"  true {v.error:.2e} stated {v.stated:.2e} asked {v.asked:.1e} known {v.known:.0e} {v.status}: f={s.f!r} "
                  f"A0={s.A0!r} D={s.D!r} k={s.k!r} N={s.N} {s.wall} {s.dissipation} {s.tension} F0={s.F0!r} "
                  f"thrown={s.start_velocity}")


if __name__ == "__main__":
    main()
