"""The limit of a decaying sequence of states: reduced rank extrapolation.

Near an orbit, the stroboscopic map is linear, x_{k+1} − x* = M (x_k − x*). With the differences d_j = x_{j+1} − x_j,
the weights ξ that minimise |d_0 + Σ ξ_j (d_{j+1} − d_j)| give x* ≈ x_0 + Σ ξ_j d_j: the slowest modes are removed.
Source: Eddy 1979; Sidi, Vector Extrapolation Methods (2017), chapter 2, by modified Gram–Schmidt.
"""

from __future__ import annotations

from math import sqrt

from ..compiling.jit import brief_kernel, internal

#: Number of differences used; k differences remove k − 1 slow modes.
ORBITS = 8
#: A second difference counts as linearly dependent on the earlier ones if its component orthogonal to them is less than
#: this fraction of it.
_DEPENDENT_PART = 1e-9


@internal
def dot(a, b):
    """Scalar product."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@internal
def subtract(a, factor, b):
    """a −= factor·b."""
    for i in range(a.size):
        a[i] -= factor * b[i]


@brief_kernel
def reduced_rank(states, basis, triangle, limit):
    """The limit (2, bodies) of states (k + 1, 2, bodies); basis (k, 2·bodies) and triangle (k, k) are workspaces."""
    count, bodies = states.shape[0] - 2, states.shape[2]
    residual, weights = basis[count], triangle[count]
    for q in range(2):
        for i in range(bodies):
            residual[q * bodies + i] = states[0, q, i] - states[1, q, i]
            for j in range(count):
                basis[j, q * bodies + i] = states[j + 2, q, i] - 2.0 * states[j + 1, q, i] + states[j, q, i]
    for j in range(count):
        size = sqrt(dot(basis[j], basis[j]))
        for k in range(j):
            triangle[k, j] = dot(basis[k], basis[j])
            subtract(basis[j], triangle[k, j], basis[k])
        left = sqrt(dot(basis[j], basis[j]))
        triangle[j, j] = left if left > _DEPENDENT_PART * size else 0.0
        scale = 1.0 / left if left > _DEPENDENT_PART * size else 0.0
        for i in range(2 * bodies):
            basis[j, i] *= scale
        weights[j] = dot(basis[j], residual)
        subtract(residual, weights[j], basis[j])
    for j in range(count - 1, -1, -1):
        for k in range(j + 1, count):
            weights[j] -= triangle[j, k] * weights[k]
        weights[j] = weights[j] / triangle[j, j] if triangle[j, j] > 0.0 else 0.0
    for q in range(2):
        for i in range(bodies):
            value = states[0, q, i]
            for j in range(count):
                value += weights[j] * (states[j + 1, q, i] - states[j, q, i])
            limit[q, i] = value
