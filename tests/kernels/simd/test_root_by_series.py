"""The root of an overlap in batches, which AVX-512 takes from 14 bits and a series, against the square root."""

from __future__ import annotations

import numpy as np

from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.simd.functions import root_by_series
from granchain_core.kernels.simd.vector import VECTOR_WIDTH, aligned, load, store


@kernel
def roots(values, out):
    """√ of every row of eight."""
    for row in range(values.shape[0]):
        store(out, row, root_by_series(load(values, row)))


def test_the_root_by_series_is_the_square_root() -> None:
    """To the series' next term, 5e³/16 with |e| ≤ 2^{−13}, over all overlaps and far beyond; a NaN stays a NaN."""
    values, found = aligned(1000, VECTOR_WIDTH), aligned(1000, VECTOR_WIDTH)
    values[:] = 10.0 ** np.random.default_rng(1).uniform(-200.0, 10.0, values.shape)
    values[0], values[1, 3] = 10.0 ** np.linspace(-200.0, 10.0, VECTOR_WIDTH), np.nan
    roots(values, found)
    exact = np.sqrt(values)
    np.testing.assert_allclose(found, exact, rtol=5.0 / 16.0 * 2.0**-39 + 1e-15, equal_nan=True)
    print(f"largest relative difference {np.nanmax(np.abs(found / exact - 1.0)):.1e}")
    assert (np.isnan(found) == np.isnan(values)).all()
