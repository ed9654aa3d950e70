"""Reduced rank extrapolation: shortening a slow transient without leaving the attractor's basin.

Reduced rank extrapolation (kernels/strobes/extrapolation.py) removes the slowest modes. It is used only where changes
are already small and shrinking. An extrapolation is accepted only if the change after it is smaller and if it goes at
most three times as far as change/(1 − r), the distance before the last change, where r is the contraction factor. This
ensures that the orbit is the one that the chain approaches.
"""

from __future__ import annotations

import numpy as np

from ...kernels.batch.checks import FARTHEST_EXTRAPOLATION
from ...kernels.strobes import extrapolation


def reduced_rank(states: np.ndarray) -> np.ndarray:
    """The limit of the states x_0 … x_k (k + 1, 2, N) by reduced rank extrapolation."""
    k, size = len(states) - 1, states[0].size
    limit = np.zeros_like(states[0])
    extrapolation.reduced_rank(np.ascontiguousarray(states), np.zeros((k, size)), np.zeros((k, k)), limit)
    return limit


def within_reach(state: np.ndarray, limit: np.ndarray, change: float, contraction: float) -> bool:
    """Whether `limit` is at most `FARTHEST_EXTRAPOLATION` times as far from `state` as the contraction predicts."""
    if not np.isfinite(limit).all() or not 0.0 < contraction < 1.0:
        return False
    return float(np.abs(limit - state).max()) <= FARTHEST_EXTRAPOLATION * change / (1.0 - contraction)
