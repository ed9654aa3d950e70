"""Asked for an accuracy, `run` reaches it and its estimate bounds the error, on random mild scenes.

Thirty scenes by default; GRANCHAIN_SCENES=100 runs the hundred of the issue. Figures are printed with -s.
"""

from __future__ import annotations

import functools
import os

import numpy as np
import pytest

from granchain_core import Scene, run, scene

COUNT = int(os.environ.get("GRANCHAIN_SCENES", "30"))
ASKED = (1e-4, 1e-6, 1e-8)


def mild_scene(rng: np.random.Generator) -> Scene:
    """A dissipative chain whose errors do not grow exponentially over the four periods looked at.

    The rig without its foundation is irregular at every frequency and with it above about 120 Hz (PHYSICS trap 8); with
    Kuwabara–Kono damping, which hardly damps small overlaps, it amplifies errors too.
    """
    laws, kappas = ["linear", "tsuji", "kuwabara-kono"], [0.0, 1e-3, 5e-3]
    common = {"N": int(rng.integers(1, 21)), "wall": str(rng.choice(["bead", "same-material", "rigid"]))}
    if rng.random() < 0.6:
        return scene("sec2").evolve(
            f=10.0 ** rng.uniform(2.0, 3.4), A0=10.0 ** rng.uniform(-7.0, -5.7), D=rng.uniform(50.0, 300.0),
            kappa=float(rng.choice(kappas)), dissipation=str(rng.choice(laws)), **common)
    return scene("rig").evolve(
        f=rng.uniform(20.0, 100.0), A0=rng.uniform(6e-6, 13e-6), D=rng.uniform(25.0, 150.0),
        kappa=float(rng.choice(kappas[1:])), dissipation=str(rng.choice(laws[:2])), **common)


@functools.cache
def figures() -> np.ndarray:
    """(scenes, accuracies, 2): true error over what was asked, true error over the estimate."""
    rng = np.random.default_rng(20240611)
    sizes = {"periods": 0, "record": 4, "samples": 16}
    found, refused = [], 0
    while len(found) < COUNT:
        chosen = mild_scene(rng)
        true = run(chosen.evolve(accuracy=1e-11), **sizes)
        if true.error_estimate > 1e-9:  # a tenth of the finest asked: below that it is no yardstick
            refused += 1
            assert refused <= COUNT // 10, "too many of these scenes amplify errors to be called mild"
            continue
        row = []
        for asked in ASKED:
            result = run(chosen.evolve(accuracy=asked), **sizes)
            error = np.abs(result.displacement - true.displacement).max() / np.abs(true.displacement).max()
            row.append((error / asked, error / result.error_estimate))
        found.append(row)
    return np.array(found)


@pytest.mark.parametrize("asked", ASKED)
def test_true_error_is_below_what_was_asked(asked):
    """In at least 95 % of the scenes (the issue's own figure)."""
    ratio = figures()[:, ASKED.index(asked), 0]
    print(f"asked {asked:g}: {np.mean(ratio < 1):.1%} below, median {np.median(ratio):.2g}, worst {ratio.max():.2g}")
    assert np.mean(ratio < 1.0) >= 0.95


@pytest.mark.parametrize("asked", ASKED)
def test_reported_estimate_bounds_the_true_error(asked):
    """In at least 95 % of the scenes the true error is below the reported estimate; elsewhere by a small factor only."""
    ratio = figures()[:, ASKED.index(asked), 1]
    print(f"asked {asked:g}: {np.mean(ratio <= 1):.1%} bounded, median {np.median(ratio):.2g}, worst {ratio.max():.2g}")
    assert np.mean(ratio <= 1.0) >= 0.95
    assert ratio.max() < 5.0  # the order is uneven at events: two computations may agree better than either is right
