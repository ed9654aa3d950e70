"""Vectors are rows of C-ordered float64 arrays, and other arrays are refused at compile time; negation of a vector."""

from __future__ import annotations

import numpy as np
import pytest
from numba.core.errors import TypingError

from granchain_core import scene
from granchain_core.integrate import Engine, MethodSetting
from granchain_core.kernels.compiling.jit import kernel
from granchain_core.kernels.simd.vector import aligned, load8, store

pytestmark = pytest.mark.quick


@kernel
def first_row(array, out):
    """Copy the first row."""
    store(out, 0, load8(array, 0))


@kernel
def negative(array, out):
    """Compute −x for eight values."""
    store(out, 0, -load8(array, 0))


@pytest.mark.parametrize("array", [
    np.zeros((2, 16))[:, ::2], np.zeros((8, 2)).T, np.zeros((1, 8), dtype=np.float32), np.zeros(8), np.zeros((1, 1, 8)),
], ids=["strided", "transposed", "float32", "one axis", "three axes"])
def test_other_arrays_are_refused(array: np.ndarray) -> None:
    with pytest.raises(TypingError, match="vectors are rows of C-ordered arrays"):
        first_row(array, aligned(1))
    with pytest.raises(TypingError, match="vectors are rows of C-ordered arrays"):
        first_row(aligned(1), array)


def test_negated_rows_are_those_of_numbers() -> None:
    row, out = aligned(1), aligned(1)
    row[0] = 1.5, -2.0, 0.0, np.nan, np.inf, -np.inf, 1e-310, 3.0
    negative(row, out)
    assert np.array_equal(out[0], -row[0], equal_nan=True)


@pytest.mark.parametrize(("beads", "width"), [(11, 16), (100, 8)])
def test_rows_along_a_chain_begin_on_a_cache_line(beads: int, width: int) -> None:
    """A vector across two cache lines costs two accesses, with which a long chain took 8 to 25 % longer."""
    work = Engine(scene("precompressed").evolve(N=beads), MethodSetting("rk4-split"), 1).stepper.work  # type: ignore[attr-defined]
    rows = [value for value in (*work.simd, *work.simd.preload) if getattr(value, "shape", ())[1:] == (width,)]
    assert len(rows) >= 5 and all(row.ctypes.data % 64 == 0 for row in rows)
