"""The root of the overlaps of a short chain, of which every second register of eight takes a series."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.simd.functions import chain_root
from granchain_core.kernels.simd.vector import aligned, load8, load16, load32, store


@kernel
def roots_of_8(values, out):
    """√ of every row of 8."""
    for row in range(values.shape[0]):
        store(out, row, chain_root(load8(values, row)))


@kernel
def roots_of_16(values, out):
    """√ of every row of 16."""
    for row in range(values.shape[0]):
        store(out, row, chain_root(load16(values, row)))


@kernel
def roots_of_32(values, out):
    """√ of every row of 32."""
    for row in range(values.shape[0]):
        store(out, row, chain_root(load32(values, row)))


WIDTHS = {8: roots_of_8, 16: roots_of_16, 32: roots_of_32}
#: The series leaves out 35/128 · 2^{-52} or less, about a quarter of the spacing of numbers at 1; its product, e
#: and the last sum round.
ROUNDING = 2.0 * np.finfo(float).eps


@pytest.mark.parametrize("width", WIDTHS)
def test_the_root_is_exact_to_rounding_in_every_lane(width: int) -> None:
    values, roots = aligned(2000, width), aligned(2000, width)
    values[:] = 10.0 ** np.random.default_rng(2).uniform(-270.0, 300.0, values.shape)
    values[:1000] = np.random.default_rng(3).uniform(0.0, 4.0, (1000, width))
    WIDTHS[width](values, roots)
    np.testing.assert_allclose(roots, np.sqrt(values), rtol=ROUNDING)


@pytest.mark.parametrize("width", WIDTHS)
def test_nothing_that_is_not_finite_is_hidden(width: int) -> None:
    values, roots = aligned(2 * width, width), aligned(2 * width, width)
    values[:] = 1.0
    for lane in range(width):
        values[lane, lane], values[width + lane, lane] = np.nan, np.inf
    WIDTHS[width](values, roots)
    assert (np.isfinite(roots) == np.isfinite(values)).all()


@pytest.mark.parametrize("width", WIDTHS)
def test_an_open_contact_has_no_force(width: int) -> None:
    """The root of 0 is 0 or negligible, and so is that of a subnormal number; times the overlap it is 0."""
    values, roots = aligned(3, width), aligned(3, width)
    values[1], values[2] = 5e-324, 1e-300
    WIDTHS[width](values, roots)
    assert (roots >= 0.0).all() and roots.max() <= 1.01e-140
    assert (values * roots == 0.0).all()
