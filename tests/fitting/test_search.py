"""Where the search of a fit begins."""

from __future__ import annotations

import numpy as np
from scipy.stats import qmc

from granchain_core.fitting import search


def test_later_rounds_of_starts_are_spread_as_the_first() -> None:
    """Of twice as many points one lies in each half of the first intervals, in every coordinate."""
    sequence = qmc.Sobol(2, scramble=False)
    first, second = sequence.random_base2(4), sequence.random(16)
    points = np.concatenate([search._inner_points(part, 2.0**-4) for part in (first, second)])
    for coordinate in (points.T - 0.02) / 0.96:
        np.testing.assert_array_equal(np.sort(np.floor(32.0 * coordinate + 1e-9)), np.arange(32))
