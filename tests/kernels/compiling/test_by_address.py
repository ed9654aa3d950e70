"""A kernel called by address gives the same result as a call by name, and is compiled once for all its callers."""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
import pytest

from granchain_core import scene
from granchain_core.execution.stop import Stop
from granchain_core.integrate.batch import Batch
from granchain_core.kernels.batch.checks import begin_or_check_member
from granchain_core.kernels.batch.run import run_batch
from granchain_core.kernels.compiling.by_address import address_of, call_at
from granchain_core.kernels.strobes.periodicity import detect_period
from granchain_core.steady.regime_criteria import find_period


class Numbers(NamedTuple):
    """Arrays in a tuple, the form in which kernels take them."""

    values: np.ndarray
    limits: np.ndarray


@numba.njit
def raise_value(numbers, i):
    """Add the limit to a value and return whether the sum is positive."""
    numbers.values[i] += numbers.limits[i]
    return numbers.values[i] > 0.0


@numba.njit
def positive(numbers, kernel):
    """Call a kernel for every value and count how many are positive."""
    count = 0
    for i in range(numbers.values.size):
        if call_at(kernel, (numbers, i)):
            count += 1
    return count


def test_a_kernel_called_by_address_gets_its_arguments_and_returns_its_result() -> None:
    numbers = Numbers(np.array([-1.0, 2.0, -3.0]), np.array([2.0, 0.5, 1.0]))
    assert positive(numbers, address_of(raise_value, numbers, 0)) == 2
    assert (numbers.values == [1.0, 2.5, -2.0]).all()
    assert address_of(raise_value, numbers, 5) == address_of(raise_value, numbers, 0), "one version for these types"


def test_all_structures_share_the_checks_of_a_batch() -> None:
    """If they were inlined, they would be compiled again for every structure (docs/compiling.md)."""
    for shown in (scene("sec2"), scene("sec2").evolve(k=1e5), scene("sec2").evolve(dissipation="tsuji")):
        batch = Batch(shown, Stop())
        batch.put(0, batch.example, np.zeros(2 * (shown.N + 2)), 1, return_at=1)
        assert batch.run() == (0, True)
    assert len(begin_or_check_member.overloads) == 1 < len(run_batch.overloads)
    find_period(np.zeros((2, 2, 3)))
    assert len(detect_period.overloads) == 1, "a batch and a single chain use one version"


@numba.njit(boundscheck=True)
def reads_beyond(numbers, i):
    """Read past the end of an array, with the bounds checks that NUMBA_BOUNDSCHECK=1 switches on."""
    return numbers.values[i] > 0.0


def test_an_error_of_the_kernel_that_is_called_is_raised() -> None:
    numbers = Numbers(np.ones(2), np.ones(2))
    longer = Numbers(np.ones(2), np.ones(2))
    address = address_of(reads_beyond, numbers, 0)
    assert positive(longer, address) == 2
    with pytest.raises(IndexError):
        past_the_end(numbers, address)


@numba.njit
def past_the_end(numbers, kernel):
    """Call a kernel for an element that does not exist."""
    return call_at(kernel, (numbers, numbers.values.size + 1))
