"""The square root of an overlap in batches, which x86 computes from an approximate inverse root and a series."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.kernels.batch_size import CHOICES
from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.simd.functions import root_by_series
from granchain_core.kernels.simd.vector import BLOCK_WIDTH, aligned, load8, loader, store

load4 = loader(4)


@kernel
def roots_of_eight(values, out):
    """Compute √ of every row of eight."""
    for row in range(values.shape[0]):
        store(out, row, root_by_series(load8(values, row)))


@kernel
def roots_of_four(values, out):
    """Compute √ of every row of four."""
    for row in range(values.shape[0]):
        store(out, row, root_by_series(load4(values, row)))


#: By vector width: the kernel, the smallest and largest exponents of ten, and the first omitted term of the series.
#: An inverse root of 14 bits leaves |e| ≤ 2^{−13}; one in floats, accurate to 1.5 · 2^{−12}, leaves |e| ≤ 3 · 2^{−12}
#: and its square.
CASES = {
    BLOCK_WIDTH: (roots_of_eight, -200.0, 10.0, 5.0 / 16.0 * 2.0**-39),
    4: (roots_of_four, -30.0, 10.0, 35.0 / 128.0 * (3.0 * 2.0**-12) ** 4),
}


def test_every_size_of_a_batch_has_a_case() -> None:
    assert set(CASES) == set(CHOICES)


@pytest.mark.parametrize("width", CASES)
def test_the_root_by_series_is_the_square_root(width: int) -> None:
    """They agree to the next term of the series, over all overlaps and far beyond; a NaN stays a NaN."""
    roots, low, high, left_out = CASES[width]
    values, found = aligned(1000, width), aligned(1000, width)
    values[:] = 10.0 ** np.random.default_rng(1).uniform(low, high, values.shape)
    values[0], values[1, width - 1] = 10.0 ** np.linspace(low, high, width), np.nan
    roots(values, found)
    exact = np.sqrt(values)
    np.testing.assert_allclose(found, exact, rtol=1.1 * left_out + 1e-15, equal_nan=True)
    assert (np.isnan(found) == np.isnan(values)).all()


@pytest.mark.parametrize("width", CASES)
def test_an_overflow_is_not_hidden(width: int) -> None:
    """Far beyond the range of floats, the root is right or not finite, never a small number."""
    values, found = aligned(4, width), aligned(4, width)
    values[:] = np.array([1e39, 1e200, np.inf, 4.0])[:, np.newaxis]
    CASES[width][0](values, found)
    right = np.isclose(found, np.sqrt(values), rtol=1e-12) & np.isfinite(values)
    assert (right | ~np.isfinite(found)).all()
    assert right[3].all()
