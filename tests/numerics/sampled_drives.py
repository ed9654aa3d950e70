"""A program that compares the errors that `drive` states for sampled motions with the true ones, for random chains and
tones.

    python -m tests.numerics.sampled_drives --count 100 [--seed 12]

The true motion is the one under the formula, with an accuracy of 1e-7. Samples are taken at its knots.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granchain_core import Scene, Signal, drive, scene
from granchain_core.prescribed_drive.signal import KNOTS
from granchain_core.tables import MAXIMA

#: Knots from sample to sample.
SPACINGS = (1, 2, 5, 10, 20)
#: Errors of the true motion itself: from its steps and, in the largest input force, from the formula's velocity.
_KNOWN = np.array([2e-6, 3e-5, 2e-6, 2e-6])


@dataclass(frozen=True)
class Sampled:
    """A sampled motion: the sampled quantity, samples per period, true and stated errors (4,), and its scene."""

    kind: str
    samples: float
    errors: np.ndarray
    stated: np.ndarray
    scene: Scene

    @property
    def worst(self) -> float:
        """The largest ratio of a true error to the stated one."""
        return float(((self.errors - _KNOWN) / self.stated).max())


def random_scene(rng: np.random.Generator) -> Scene:
    """Return a chain of one to eight beads with any damping, sometimes precompressed."""
    return scene("sec2").evolve(N=int(rng.integers(1, 9)), dissipation=str(rng.choice(["linear", "tsuji", "none"])),
                                F0=float(rng.choice([0.0, 0.0, 1.0])), accuracy=1e-7)


def random_tones(rng: np.random.Generator, amplitude: float) -> tuple[Signal, dict[str, np.ndarray]]:
    """Return two sines of random phases, the faster one from 200 Hz to 2 kHz, over three to twelve of its periods, and
    their values at the knots.

    A signal made from a formula has slightly shifted velocities, so that its displacements are right; the sensors'
    values are those of the formula.
    """
    high = rng.uniform(200.0, 2000.0)
    omega = 2.0 * np.pi * high * np.array([1.0, rng.uniform(0.2, 1.0)])
    size, phase = amplitude * np.array([1.0, rng.uniform(0.0, 1.0)]), rng.uniform(0.0, 2.0 * np.pi, 2)

    def displacement(t: np.ndarray) -> np.ndarray:
        return np.asarray((size * (np.sin(np.multiply.outer(t, omega) + phase) - np.sin(phase))).sum(axis=-1))

    def velocity(t: np.ndarray) -> np.ndarray:
        return np.asarray((size * omega * np.cos(np.multiply.outer(t, omega) + phase)).sum(axis=-1))

    duration = (1.0 - 1e-9) * int(rng.integers(3, 13)) / high  # rounding must not add a knot
    signal = Signal.of(velocity, displacement, duration, high, "tones")
    return signal, {"velocity": velocity(signal.time), "displacement": displacement(signal.time)}


def sampled(seed: int, count: int) -> Iterator[Sampled]:
    """Yield every random motion, computed from samples of its velocity and of its displacement, at all spacings."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        chosen = random_scene(rng)
        signal, values = random_tones(rng, chosen.A0)
        true = drive(chosen, signal)
        forces = np.array([getattr(true, name) for name in MAXIMA])
        for spacing in SPACINGS:
            kept = slice(None, None, spacing)
            for kind, knots in (("velocity", 1), ("displacement", 8)):
                make = getattr(Signal, f"from_{kind}")
                found = drive(chosen, make(signal.time[kept], values[kind][kept]))
                moved = np.abs(found.displacement[::knots] - true.displacement[kept]).max()
                wrong = np.abs([getattr(found, name) for name in MAXIMA] - forces)
                errors = [moved / np.abs(true.displacement).max(), *wrong / np.maximum(forces, 1e-300)]
                yield Sampled(kind, KNOTS / spacing, np.array(errors),
                              np.array([found.displacement_error, *found.force_errors.row]), chosen)


def main() -> None:
    """Print, for every quantity and sampling rate, median displacement errors and the worst of all errors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=12)
    asked = parser.parse_args()
    groups: dict[tuple[str, float], list[Sampled]] = {}
    for one in sampled(asked.seed, asked.count):
        groups.setdefault((one.kind, one.samples), []).append(one)
        if one.worst > 1.0:
            print(f"wrong: {one.kind}, {one.samples:g} a period, true {one.errors}, stated {one.stated}, {one.scene.knobs}")
    for (kind, samples), found in groups.items():
        print(f"{kind:12} {samples:4g} a period: {len(found)} motions, true error "
              f"{np.median([one.errors[0] for one in found]):.1e}, stated {np.median([one.stated[0] for one in found]):.1e}, "
              f"the worst {max(one.worst for one in found):.2f} of what is stated")


if __name__ == "__main__":
    main()
