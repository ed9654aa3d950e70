"""Each intrinsic of `kernels/simd` agrees with NumPy, for vectors of every width."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.simd.functions import inverse_sixteenth_root, root
from granchain_core.kernels.simd.sums import largest_of, only_lane, sum_of
from granchain_core.kernels.simd.vector import (
    BLOCK_WIDTH,
    WIDTHS,
    aligned,
    at,
    blank,
    from_left,
    from_right,
    load_like,
    loader,
    lowest_bit,
    positive_mask,
    splat8,
    store,
    with_first,
)

LOADS = {width: loader(width) for width in WIDTHS}


def random_rows(count: int, width: int) -> np.ndarray:
    """Return rows of random numbers of both signs."""
    rows = aligned(count, width)
    rows[:] = np.random.default_rng(width).standard_normal((count, width))
    return rows


@pytest.fixture(scope="module", params=WIDTHS)
def vectors(request: pytest.FixtureRequest) -> tuple[np.ndarray, Any]:
    """Two rows of a width, and a kernel for that width: (rows, lane, out) stores the vectors and returns the scalars.
    """
    read = LOADS[request.param]

    @kernel
    def compute(rows, lane, out):  # type: ignore[no-untyped-def]
        first, second = read(rows, 0), read(rows, 1)
        store(out, 0, from_left(first, second))
        store(out, 1, from_right(first, second))
        store(out, 2, with_first(first, 7.0))
        store(out, 3, abs(first))
        store(out, 4, only_lane(first, lane))
        store(out, 5, blank(first))
        store(out, 6, root(abs(first)))
        store(out, 7, load_like(first, rows, 1))
        return at(first, lane), sum_of(first), largest_of(first), positive_mask(first)

    return random_rows(2, request.param), compute


def test_lanes_move_and_change_as_in_numpy(vectors: tuple[np.ndarray, Any]) -> None:
    rows, compute = vectors
    width, out = rows.shape[1], aligned(8, rows.shape[1])
    for lane in range(width):
        element, total, largest, mask = compute(rows, lane, out)
        assert element == rows[0, lane]
        assert np.array_equal(out[4], np.eye(width)[lane])
    assert np.array_equal(out[0], np.concatenate([rows[0, -1:], rows[1, :-1]]))
    assert np.array_equal(out[1], np.concatenate([rows[0, 1:], rows[1, :1]]))
    assert np.array_equal(out[2], np.concatenate([[7.0], rows[0, 1:]]))
    assert np.array_equal(out[3], np.abs(rows[0]))
    assert not out[5].any()
    assert np.array_equal(out[6], np.sqrt(np.abs(rows[0])))
    assert np.array_equal(out[7], rows[1])
    # the order of summation is free: one rounding per lane
    assert total == pytest.approx(rows[0].sum(), abs=width * np.finfo(float).eps * np.abs(rows[0]).sum())
    assert largest == rows[0].max()
    assert mask == sum(1 << lane for lane in range(width) if rows[0, lane] > 0.0)


def test_the_mask_has_no_bit_for_zero_and_nan(vectors: tuple[np.ndarray, Any]) -> None:
    rows, compute = vectors
    width = rows.shape[1]
    special, out = aligned(2, width), aligned(8, width)
    for lane in range(width):
        special[0] = np.resize([0.0, -0.0, np.nan, -1.0, -np.inf], width)
        assert compute(special, 0, out)[3] == 0
        special[0, lane] = 5e-324 if lane % 2 else np.inf
        assert compute(special, 0, out)[3] == 1 << lane


def test_the_absolute_value_of_special_numbers(vectors: tuple[np.ndarray, Any]) -> None:
    rows, compute = vectors
    special, out = aligned(2, rows.shape[1]), aligned(8, rows.shape[1])
    special[0] = np.resize([-0.0, -np.inf, -np.nan, -1e-310], rows.shape[1])
    compute(special, 0, out)
    assert np.array_equal(out[3], np.abs(special[0]), equal_nan=True)
    assert not np.signbit(out[3][0])


@kernel
def splat(value, out):
    """Store one number in all lanes."""
    store(out, 0, splat8(value))


@kernel
def first_bit(mask):
    """Return the lowest bit that is set."""
    return lowest_bit(mask)


@kernel
def inverse_roots(values, out):
    """Compute value^{−1/16} for all values."""
    for i in range(values.size):
        out[i] = inverse_sixteenth_root(values[i])


def test_a_number_is_put_into_all_eight_lanes() -> None:
    out = aligned(1, BLOCK_WIDTH)
    splat(-2.5, out)
    assert (out == -2.5).all()


def test_the_lowest_bit_is_that_of_a_mask_of_any_width() -> None:
    for bit in range(max(WIDTHS)):
        assert first_bit(1 << bit) == bit
        assert first_bit((1 << bit) | (1 << max(WIDTHS))) == bit
        assert first_bit(((1 << max(WIDTHS)) - 1) & ~((1 << bit) - 1)) == bit


def test_the_inverse_sixteenth_root_is_right_to_about_four_percent() -> None:
    """This covers all errors that a step may have, and densely sixteen factors of two, after which the error repeats.
    """
    values = np.concatenate([np.logspace(-290, 290, 5000), np.logspace(0, 16, 5000, base=2.0)])
    found = np.empty_like(values)
    inverse_roots(values, found)
    error = np.abs(found * values ** (1.0 / 16.0) - 1.0)
    assert error.max() == pytest.approx(0.0426, abs=1e-4)  # measured; it repeats after a factor of 2^16
