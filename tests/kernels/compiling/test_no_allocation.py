"""A kernel that would allocate memory, itself or in a function it calls, is refused at compile time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numba.core.errors import NumbaError

from granchain_core.kernels.compiling.jit import brief_kernel, inline_numba, internal, kernel


def new_array(values):
    """Allocate an array of numbers."""
    return np.empty(values.size)[0]


def copied(values):
    """Allocate a copy."""
    return values.copy()[0]


def temporary(values):
    """Allocate a temporary array between two operations."""
    return (2.0 * values + 1.0)[0]


def new_list(values):
    """Allocate a list."""
    return [values[0]][0]


ALLOCATING = [new_array, copied, temporary, new_list]


@pytest.mark.parametrize("decorator", [kernel, brief_kernel])
@pytest.mark.parametrize("allocating", ALLOCATING)
def test_a_kernel_that_allocates_does_not_compile(allocating: Callable[[Any], Any], decorator: Callable[[Any], Any]) -> None:
    with pytest.raises(NumbaError):
        decorator(allocating)(np.ones(3))


@pytest.mark.parametrize("decorator", [internal, inline_numba])
def test_a_kernel_that_calls_an_allocating_function_does_not_compile(decorator: Callable[[Any], Any]) -> None:
    part = decorator(temporary)

    @kernel
    def outer(values):  # type: ignore[no-untyped-def]
        return part(values)

    with pytest.raises(NumbaError):
        outer(np.ones(3))


def test_a_kernel_without_an_array_of_its_own_compiles() -> None:
    @kernel
    def in_place(values, out):  # type: ignore[no-untyped-def]
        for i in range(values.size):
            out[i] = 2.0 * values[i] + 1.0
        return out[0]

    assert in_place(np.ones(3), np.zeros(3)) == 3.0
