"""Sums over rows and the largest lane agree with NumPy, for vectors of every width along a chain."""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.simd.sums import largest_of, moved_by_rows, repeat_like
from granchain_core.kernels.simd.vector import aligned, load8, load16, load32, store

LOADS = {8: load8, 16: load16, 32: load32}
WEIGHTS = (0.5, 0.0, -2.0, 3.0)
moved = moved_by_rows(WEIGHTS, 3)
moved_by_latest = moved_by_rows((0.0, 0.0, 7.0), 2)


def rows(count: int, width: int) -> np.ndarray:
    """Return rows of random numbers."""
    found = aligned(count, width)
    found[:] = np.random.default_rng(width).standard_normal((count, width))
    return found


@pytest.mark.parametrize("width", LOADS)
def test_the_largest_lane_is_found_wherever_it_is(width: int) -> None:
    read = LOADS[width]

    @kernel
    def largest(array):  # type: ignore[no-untyped-def]
        return largest_of(read(array, 0))

    values = -1.0 - np.abs(rows(1, width))  # all below zero, so that no lane of zeros can win
    assert largest(values) == values.max()
    for lane in range(width):
        values[0, lane] = 2.0 + lane
        assert largest(values) == 2.0 + lane
        values[0, lane] = -1.0


@pytest.mark.parametrize("width", LOADS)
def test_a_point_is_moved_by_all_rows_the_newest_of_which_is_given(width: int) -> None:
    read = LOADS[width]

    @kernel
    def move(start, array, newest, out):  # type: ignore[no-untyped-def]
        store(out, 0, moved(read(start, 0), read(newest, 0), array))
        store(out, 1, moved_by_latest(read(start, 0), read(newest, 0), array))

    start, array, newest, out = rows(1, width), rows(4, width), rows(1, width) + 1.0, aligned(2, width)
    move(start, array, newest, out)
    # a few roundings of numbers near 1 to 10
    np.testing.assert_allclose(out[0], start[0] + 0.5 * array[0] - 2.0 * array[2] + 3.0 * newest[0], rtol=0, atol=2e-14)
    np.testing.assert_allclose(out[1], start[0] + 7.0 * newest[0], rtol=0, atol=2e-14)


@pytest.mark.parametrize("width", LOADS)
def test_eight_lanes_are_repeated_to_any_width(width: int) -> None:
    read = LOADS[width]

    @kernel
    def repeat(eight, out):  # type: ignore[no-untyped-def]
        store(out, 0, repeat_like(read(out, 0), load8(eight, 0)))

    eight, out = rows(1, 8), aligned(1, width)
    repeat(eight, out)
    assert (out.reshape(-1, 8) == eight).all()
