"""Orbits of long chains: Newton's step by GMRES and leading multipliers by Arnoldi, without the whole derivative.

The derivative of a chain of a thousand beads has four million entries; its product with one direction costs little
more than the motion. Disturbances shrink in almost all directions, so a Krylov space of a few dozen dimensions
suffices. `scipy.sparse.linalg` is imported only when the first long chain needs it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ComputationError
from .stroboscopic_map import StroboscopicMap

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

#: Number of multipliers computed for a long chain.
LEADING = 24
#: Error of these multipliers, relative to the largest.
_EIGENVALUE_ERROR = 1e-9
#: Relative tolerance of GMRES; the error of Newton's step is this times the residual.
_GMRES_TOLERANCE = 1e-6
#: Products with the derivative after which GMRES restarts.
_PRODUCTS_TO_RESTART = 80
#: Maximum number of restarts.
_MOST_RESTARTS = 5


def derivative_at(stroboscopic_map: StroboscopicMap, x: np.ndarray, observer: bool = False) -> LinearOperator:
    """The derivative of the map at x as an operator (2N, 2N)."""
    from scipy.sparse.linalg import LinearOperator

    def product(direction: np.ndarray) -> np.ndarray:
        column = np.asarray(direction, dtype=float).reshape(-1, 1)
        return stroboscopic_map(x, observer, directions=column).derivative[:, 0]

    return LinearOperator((len(x), len(x)), matvec=product, dtype=float)


def newton_step(stroboscopic_map: StroboscopicMap, x: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Solve (M − I) d = x − end for the Newton step d towards a fixed point, by GMRES.

    Raises `ComputationError` where GMRES does not converge: the derivative then has a multiplier close to 1.
    """
    from scipy.sparse.linalg import LinearOperator, gmres

    derivative = derivative_at(stroboscopic_map, x)
    system = LinearOperator(derivative.shape, matvec=lambda d: derivative @ d - d, dtype=float)
    step, status = gmres(system, x - end, rtol=_GMRES_TOLERANCE, restart=_PRODUCTS_TO_RESTART, maxiter=_MOST_RESTARTS)
    if status != 0:
        products = _PRODUCTS_TO_RESTART * _MOST_RESTARTS
        raise ComputationError(f"Newton's step was not found in {products} products with the derivative: a multiplier "
                               "is close to 1; move the knob a little.", "no-convergence")
    return np.asarray(step)


def leading_multipliers(stroboscopic_map: StroboscopicMap, x: np.ndarray, observer: bool = False,
                        count: int = LEADING) -> np.ndarray:
    """Compute the `count` multipliers of largest modulus at the fixed point x, largest first, by Arnoldi iteration.

    Raises `ComputationError` where they do not converge.
    """
    multipliers = arnoldi(stroboscopic_map, x, count, observer)
    return multipliers[np.argsort(-np.abs(multipliers), kind="stable")]


def arnoldi(stroboscopic_map: StroboscopicMap, x: np.ndarray, count: int, observer: bool = False,
            vectors: bool = False) -> Any:
    """Compute the `count` multipliers of largest modulus at the fixed point x, in any order.

    With `vectors`, returns a pair: the multipliers and their eigenvectors (2N, count).

    Raises `ComputationError` where they do not converge.
    """
    from scipy.sparse.linalg import ArpackNoConvergence, eigs

    # a fixed start, so that the same chain always gives the same digits
    start = np.random.default_rng(0).standard_normal(len(x))
    try:
        return eigs(derivative_at(stroboscopic_map, x, observer), k=count, which="LM", v0=start, tol=_EIGENVALUE_ERROR,
                    return_eigenvectors=vectors)
    except ArpackNoConvergence as problem:
        raise ComputationError(f"Only {len(problem.eigenvalues)} of {count} leading multipliers converged; the others "
                               "are too close together.", "no-convergence") from None
