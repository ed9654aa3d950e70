"""Errors of Floquet multipliers, from a derivative computed with a looser tolerance.

Equation   Δμ_i = ℓ_i* ΔM η_i / ℓ_i* η_i to first order, with η_i and ℓ_i the right and left eigenvectors of the map's
           derivative M;   the stated error is the larger of 2 |Δμ_i| and a quarter of
           |ℓ_i|ᵀ |ΔM| |η_i| / |ℓ_i* η_i|
Source     Wilkinson 1965, The Algebraic Eigenvalue Problem, chapter 2
Note       ΔM is measured: M minus the derivative of a map whose steps have ten times the tolerance, at that map's own
           fixed point. Its entries may cancel by chance in ℓ* ΔM η, which is why their moduli count too. The rounding
           of M is added. Beyond a grazing, M varies as the root of the depth, so a shift of the orbit by the tolerance
           changes M by the root of the tolerance: ΔM is large there (docs/orbits.md). Where two multipliers meet, ℓ* η
           goes to zero and the error grows without bound, as does the multipliers' sensitivity to M.
"""

from __future__ import annotations

import numpy as np

from ..execution.stop import Stop
from ..scene import Scene
from ..scene.state import State
from .stroboscopic_map import TOLERANCE, StroboscopicMap

#: Tolerance of the coarser map relative to that of the map.
_COARSER_FACTOR = 10.0
#: Safety factor on the observed change.
_CAUTION_FACTOR = 2.0
#: The stated error is at least this fraction of the bound. In the scenes examined, the bound was 15 to 80 times the
#: change (tests/orbits/test_multiplier_errors.py).
_LEAST_FRACTION = 0.25


def derivative_change(scene: Scene, period: int, state: State, derivative: np.ndarray,
                      observed: np.ndarray | None = None, tolerance: float = TOLERANCE,
                      stop: Stop | None = None) -> np.ndarray:
    """Error ΔM (2N, 2N) of the map's derivative at its fixed point `state`; with `observed`, of the observer's.

    It is infinite where the fixed point is not isolated, as at a fold.
    """
    coarse = StroboscopicMap(scene, period, stop, _COARSER_FACTOR * tolerance)
    x = coarse.inner(coarse.engine.scaled.from_si(state))
    try:
        fixed_point = x + np.linalg.solve(np.eye(len(x)) - derivative, coarse.end(x) - x)
    except np.linalg.LinAlgError:
        return np.full(derivative.shape, np.inf)
    of_coarse = coarse(fixed_point, observer=observed is not None).derivative
    return (derivative if observed is None else observed) - of_coarse


def errors_of(multipliers: np.ndarray, derivative: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Errors (2N,) of the eigenvalues of a derivative with the error ΔM = `change`."""
    from scipy.linalg import eig  # takes a sixth of a second to load, so only here

    values, left, right = eig(derivative, left=True, right=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        first_order = np.abs(np.einsum("ki,kl,li->i", left.conj(), change, right))
        bound = _between(left, change, right)
        rounding = np.finfo(float).eps * _between(left, derivative, right)
        overlap = np.abs((left.conj() * right).sum(axis=0))
        errors = (np.maximum(_CAUTION_FACTOR * first_order, _LEAST_FRACTION * bound) + rounding) / overlap
    errors[np.isnan(errors)] = np.inf
    return np.asarray(errors[np.abs(multipliers[:, None] - values[None, :]).argmin(axis=1)])


def _between(left: np.ndarray, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """|y_i|ᵀ |A| |x_i| of every pair of vectors."""
    return np.asarray(np.einsum("ki,kl,li->i", np.abs(left), np.abs(matrix), np.abs(right)))
