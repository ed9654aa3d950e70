"""The coefficients of DOP853 satisfy the sums that make it what it is: order 8, errors of order 5 and 3, dense order 7.
"""

from __future__ import annotations

import numpy as np
import pytest

from granchain_core.kernels.dop853.tableau import ALL_STAGES, DENSE_WEIGHTS, E3, E5, STAGES, A, C

#: The coefficients are given to 16 digits; a sum of 16 terms of order ten then holds to 1e-14.
ROUNDING = 2e-14
B = A[STAGES]


def test_each_stage_is_taken_at_the_time_its_row_sums_to():
    """Σ_j a_ij = c_i for all stages, those of the dense output included."""
    np.testing.assert_allclose(A.sum(axis=1), C, atol=ROUNDING)


def test_method_is_explicit():
    """No stage needs a later one."""
    assert A.shape == (ALL_STAGES, ALL_STAGES)
    assert not np.triu(A).any()


@pytest.mark.parametrize("power", range(8))
def test_step_integrates_powers_of_time_to_order_8(power):
    """Σ b_i c_i^q = 1/(q+1) for q = 0..7, and not for q = 8."""
    assert B @ C**power == pytest.approx(1.0 / (power + 1), abs=ROUNDING)


def test_step_is_not_of_order_9():
    """The quadrature condition of the next order fails, so order 8 is no accident of weak tests."""
    assert abs(B @ C**8 - 1.0 / 9.0) > 1e-7


@pytest.mark.parametrize("power", range(1, 7))
def test_step_satisfies_the_conditions_with_two_levels(power):
    """Σ b_i a_ij c_j^q = 1/((q+1)(q+2)): orders 3 to 8 beyond pure quadrature."""
    assert B @ (A @ C**power) == pytest.approx(1.0 / ((power + 1) * (power + 2)), abs=ROUNDING)


@pytest.mark.parametrize("power", range(1, 6))
def test_step_satisfies_the_conditions_with_three_levels(power):
    """Σ b_i a_ij a_jk c_k^q = 1/((q+1)(q+2)(q+3))."""
    expected = 1.0 / ((power + 1) * (power + 2) * (power + 3))
    assert B @ (A @ (A @ C**power)) == pytest.approx(expected, abs=ROUNDING)


def test_error_estimates_vanish_for_what_their_orders_integrate():
    """Σ e_i c_i^q = 0 for q < 5 (fifth order) and q < 3 (third order), and not for the next power."""
    c = C[: len(E5)]
    for estimate, order in ((E5, 5), (E3, 3)):
        for power in range(order):
            assert estimate @ c**power == pytest.approx(0.0, abs=ROUNDING)
        assert abs(estimate @ c**order) > 1e-6


def dense(x: float, slope) -> float:
    """The dense output at fraction x of a unit step from 0 of y' = slope(t), by the formulas of the kernel."""
    k = np.array([slope(c) for c in C])
    change = B @ k
    rows = [change, k[0] - change, 2 * change - (k[STAGES] + k[0]), *(DENSE_WEIGHTS @ k)]
    value = rows[6] * x
    for i, factor in ((5, 1 - x), (4, x), (3, 1 - x), (2, x), (1, 1 - x)):
        value = (value + rows[i]) * factor
    return (value + rows[0]) * x


@pytest.mark.parametrize("power", range(7))
@pytest.mark.parametrize("x", [0.05, 0.5, 0.9])
def test_dense_output_is_exact_for_polynomials_up_to_degree_7(x, power):
    """y' = t^q gives x^{q+1}/(q+1) everywhere inside the step, q = 0..6."""
    assert dense(x, lambda t: t**power) == pytest.approx(x ** (power + 1) / (power + 1), abs=10 * ROUNDING)
