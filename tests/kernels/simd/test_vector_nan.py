"""A NaN passes through the functions that decide whether a contact is closed, in every lane as in scalar code: it never
counts as an open contact.

A sum in which terms cancel loses a NaN.
"""

from __future__ import annotations

import llvmlite.binding
import numpy as np
import pytest

from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.simd.functions import at_least_tiny, gate, positive_part
from granchain_core.kernels.simd.vector import aligned, load8, store

pytestmark = pytest.mark.quick

VALUES = np.array([-1.0, 0.0, 2.0, np.nan, np.inf, -np.inf, 3.0, np.nan])


@kernel
def in_vectors(values, chosen, out):
    """Apply positive_part, at_least_tiny and gate to eight values."""
    overlaps = load8(values, 0)
    store(out, 0, positive_part(overlaps))
    store(out, 1, at_least_tiny(overlaps))
    store(out, 2, gate(overlaps, load8(chosen, 0)))


@kernel
def in_scalars(values, out):
    """Apply positive_part and gate to the values one by one."""
    for i in range(values.size):
        out[0, i] = positive_part(values[i])
        out[1, i] = gate(values[i], 5.0)


def test_nan_overlaps_stay_nan_and_pass_their_damping() -> None:
    row, chosen, out, one_by_one = aligned(1), aligned(1), aligned(3), np.zeros((2, 8))
    row[0], chosen[0] = VALUES, 5.0
    in_vectors(row, chosen, out)
    in_scalars(VALUES, one_by_one)
    positive = np.array([0.0, 0.0, 2.0, np.nan, np.inf, 0.0, 3.0, np.nan])
    gated = np.array([0.0, 0.0, 5.0, 5.0, 5.0, 0.0, 5.0, 5.0])
    np.testing.assert_array_equal(out[0], positive)
    np.testing.assert_array_equal(one_by_one[0], positive)
    np.testing.assert_array_equal(out[2], gated)
    np.testing.assert_array_equal(one_by_one[1], gated)
    assert (np.isnan(out[1]) == np.isnan(VALUES)).all() and (out[1][[0, 1, 5]] > 0.0).all()


@kernel
def there_and_back(x, y, alone, out):
    """Compute (x + y) − y for eight values, in vectors and one by one."""
    rows = load8(y, 0)
    store(out, 0, (load8(x, 0) + rows) - rows)
    for i in range(alone.size):
        alone[i] = (x[0, i] + y[0, i]) - y[0, i]


def test_a_nan_that_cancels_in_a_sum_is_lost() -> None:
    """With `reassoc` and `nsz`, the compiler replaces (x + y) − y by x, which is 1, also where y is NaN or infinite.
    Kernels therefore check states, not sums.
    """
    x, y, out, alone = aligned(1), aligned(1), aligned(1), np.zeros(8)
    x[0], y[0] = 1.0, VALUES
    there_and_back(x, y, alone, out)
    version = f"LLVM {'.'.join(map(str, llvmlite.binding.llvm_version_info))}"
    assert (out[0] == 1.0).all() and (alone == 1.0).all(), f"{version} keeps a NaN that cancels: {out[0]}, {alone}"
