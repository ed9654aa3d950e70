"""`python -m tools.fit_coverage --draws 100 --seed 1 --kind curve|series`: how many intervals contain the truth.

Every draw has its own true parameters, from the middle of the bounds, and its own noise: 3 % of every force of a curve,
2 % of the largest force of a series. The chain is three beads of `sec2` on springs; A0, D and k are fitted.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from granchain_core import fit, scene
from granchain_core.fitting import CurveTarget, Free, SeriesTarget, virtual_curve, virtual_series

FREE = (Free("A0", 2.5e-7, 1e-6), Free("D", 50.0, 200.0), Free("k", 1e5, 1.6e6))
#: The truth is drawn between these fractions of the way from the lower to the upper bound.
_LOW, _HIGH = 0.25, 0.75
FREQUENCIES = np.linspace(500.0, 1800.0, 14)
#: Drive frequency of the series [Hz].
_F = 1100.0
#: Drive periods of the series.
_PERIODS = 6
#: Samples per drive period of the series.
_SAMPLES = 64
#: Standard deviation of a curve's noise, relative to each force.
CURVE_NOISE = 0.03
#: Standard deviation of a series' noise, relative to its largest force.
SERIES_NOISE = 0.02


def drawn(kind: str, seed: int) -> tuple[np.ndarray, CurveTarget | SeriesTarget]:
    """Draw true parameters and a virtual measurement with them."""
    random = np.random.default_rng(seed)
    truth = np.array([one.value(random.uniform(_LOW, _HIGH)) for one in FREE])
    chain = scene("sec2").evolve(N=3, f=_F, **{one.name: value for one, value in zip(FREE, truth, strict=True)})
    if kind == "curve":
        return truth, CurveTarget(virtual_curve(chain, FREQUENCIES, CURVE_NOISE, random))
    exact = virtual_series(chain, 1, _SAMPLES, 0.0, random)
    assert exact.input_force is not None
    error = SERIES_NOISE * float(exact.input_force.max())
    return truth, SeriesTarget(virtual_series(chain, _PERIODS, _SAMPLES, error, random), error)


def held(kind: str, seed: int) -> tuple[list[bool], str]:
    """Return which intervals contain the truth, and a line about it."""
    truth, target = drawn(kind, seed)
    found = fit(scene("sec2").evolve(N=3, f=_F, k=4e5), target, FREE)
    inside = [p.low <= value <= p.high for p, value in zip(found.profiles, truth, strict=True)]
    told = ", ".join(f"{one.name} {value:.4g} {'in' if good else 'NOT in'} {p.low:.4g} to {p.high:.4g}"
                     for one, value, p, good in zip(FREE, truth, found.profiles, inside, strict=True))
    return inside, f"{told}; {found.verdict}, χ² {found.misfit:.1f} of {found.freedom}; {len(found.landscape[1])}"


def main() -> None:
    """Count the intervals that contain the truth."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=("curve", "series"), default="curve")
    arguments = parser.parse_args()
    began, count = time.perf_counter(), np.zeros(len(FREE), dtype=int)
    for i in range(arguments.draws):
        inside, line = held(arguments.kind, 1000 * arguments.seed + i)
        count += inside
        print(f"{i + 1:4d}  {line}", flush=True)
    print(f"{arguments.kind}: of {arguments.draws} intervals "
          + ", ".join(f"{n} of {one.name}" for n, one in zip(count, FREE, strict=True))
          + f" contain the truth; {time.perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main()
