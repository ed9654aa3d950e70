"""The coefficients of DOP853 satisfy its order conditions: a step of order 8, error estimates of orders 5 and 3, and a
dense output of order 7.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterator
from types import SimpleNamespace

import numpy as np
import pytest

from granchain_core.kernels.dop853.step import dense_coefficients, interpolant
from granchain_core.kernels.dop853.tableau import ALL_STAGES, E3, E5, STAGES, A, C

#: The coefficients are rounded to 16 digits: 16 terms of about ten, each off by 1.1e-15, add up to within 2e-14.
ROUNDING = 2e-14
B = A[STAGES]


def test_each_stage_is_taken_at_the_time_its_row_sums_to():
    """Σ_j a_ij = c_i for all stages, including those of the dense output."""
    np.testing.assert_allclose(A.sum(axis=1), C, atol=ROUNDING)


def test_the_tableau_is_explicit():
    """No stage depends on itself or a later one."""
    assert A.shape == (ALL_STAGES, ALL_STAGES)
    assert not np.triu(A).any()


#: A rooted tree, given as the subtrees attached to its root.
Tree = tuple["Tree", ...]


@functools.cache
def trees(order: int) -> list[Tree]:
    """Return all rooted trees with this many nodes."""
    return list(_forests(order - 1, order - 1))


def _forests(nodes: int, largest: int) -> Iterator[Tree]:
    """Yield all multisets of trees with this many nodes in total and at most `largest` nodes per tree."""
    if nodes == 0:
        yield ()
    for order in range(min(nodes, largest), 0, -1):
        for count in range(nodes // order, 0, -1):
            for some in itertools.combinations_with_replacement(trees(order), count):
                for others in _forests(nodes - order * count, order - 1):
                    yield (*some, *others)


def size(tree: Tree) -> int:
    """Return the number of nodes."""
    return 1 + sum(map(size, tree))


def density(tree: Tree) -> int:
    """Return γ, the number of nodes times the densities of the subtrees at the root."""
    return size(tree) * math.prod(map(density, tree))


def stage_sums(tree: Tree) -> np.ndarray:
    """Return Φ_i for each stage: the product of Σ_j a_ij Φ_j over the subtrees at the root."""
    found = np.ones(ALL_STAGES)
    for branch in tree:
        found = found * (A @ stage_sums(branch))
    return found


def test_the_number_of_trees_of_each_order_is_the_known_one():
    """The numbers are those of Hairer, Nørsett & Wanner, table II.2.3."""
    assert [len(set(trees(order))) for order in range(1, 10)] == [1, 1, 2, 4, 9, 20, 48, 115, 286]


@pytest.mark.parametrize("order", range(1, 9))
def test_step_satisfies_every_condition_of_order_8(order):
    """Σ b_i Φ_i(t) = 1/γ(t) for the 200 rooted trees t with up to 8 nodes (theorem II.2.13 there)."""
    for tree in trees(order):
        assert B @ stage_sums(tree) == pytest.approx(1.0 / density(tree), abs=ROUNDING), tree


def test_step_is_not_of_order_9():
    """Conditions of order 9 fail, including the one for quadrature, so the tests of order 8 are not too weak."""
    failed = [tree for tree in trees(9) if abs(B @ stage_sums(tree) - 1.0 / density(tree)) > 1e-7]
    assert ((),) * 8 in failed and len(failed) > 50


@pytest.mark.parametrize(("estimate", "order"), [(E5, 5), (E3, 3)])
def test_error_estimates_vanish_for_polynomials_of_their_orders(estimate, order):
    """Σ e_i Φ_i(t) = 0 for all trees with up to 5 nodes (order 5) or 3 (order 3), but not for all trees with one more.
    """
    sums = [[abs(estimate @ stage_sums(tree)[: len(estimate)]) for tree in trees(nodes)] for nodes in range(1, order + 2)]
    assert max(max(row) for row in sums[:-1]) < ROUNDING
    assert max(sums[-1]) > 1e-6


def dense_weights(x: float) -> np.ndarray:
    """Return the stages' weights b_i(θ) in the dense output at fraction θ = x of a step, from the kernel's own code."""
    step = SimpleNamespace(k=np.eye(ALL_STAGES), end=B, dense=np.zeros((7, ALL_STAGES)))
    dense_coefficients.py_func(1.0, np.zeros(ALL_STAGES), step)
    return interpolant.py_func(np.zeros(ALL_STAGES), step.dense, x)


@pytest.mark.parametrize("x", [0.05, 0.5, 0.9])
def test_dense_output_satisfies_every_condition_of_order_7(x):
    """Σ b_i(θ) Φ_i(t) = θ^|t|/γ(t) for all trees with up to 7 nodes, but not for all with 8 (section II.6 there)."""
    def misses(order: int) -> float:
        return max(abs(dense_weights(x) @ stage_sums(tree) - x**order / density(tree)) for tree in trees(order))

    assert max(misses(order) for order in range(1, 8)) < ROUNDING
    assert misses(8) > 1e-9
